"use strict";
// Where the tool is, and where it shall go.

function taskText(task) {
  const where = task.p_BaseTool_m.map((value) => value.toFixed(3)).join(", ");
  const words = { given_up: "has given up, was blocked", late: "the stream was late" };
  let text = `${words[task.state] || task.state}, at ${where} m`;
  if (task.waiting) text += `, ${task.waiting} waypoints left`;
  if (task.contact) text += `; contact of ${task.contact.force_N.toFixed(2)} N on ${task.contact.module}`;
  if (task.posture && !task.posture.is_there)
    text += `; ${task.posture.joint} is ${task.posture.away.toPrecision(2)} ${task.posture.unit} from the posture`;
  return task.posture && task.posture.is_there ? `${text}; in the posture` : text;
}

let held = 0; // number of the last hold of this page

function hold() {
  act({ do: "hold" }, "hold-message", (answer) => {
    held = answer.task.number;
    return "Holding.";
  });
}

/** Where nobody knows of a task, the daemon itself says whether it holds. */
function showHold() {
  const task = state && state.task;
  const isTrajectory = Boolean(state && state.gains && !task);
  at("hold").hidden = !token && !task;
  at("hold").disabled = !token || isTrajectory;
  if (task && task.number > held && at("hold-message").className === "good") show("hold-message", "");
}

function showTask() {
  const task = state.task;
  const isTold = Boolean(task);
  showHold();
  at("move-form").hidden = !isTold;
  at("to-posture").hidden = !isTold || !task.posture;
  for (const button of ["move", "to-posture"]) at(button).disabled = !token || !isTold || !task.is_running;
  show("task-state", isTold ? taskText(task) : state.gains ? "The task is a trajectory: nobody tells the tool where to go." : "", "note");
  at("task-state").dataset.state = isTold ? task.state : "";
}

function tellMove(request) {
  const speed = at("speed").value.trim();
  if (!Number.isFinite(Number(speed))) return show("move-message", "expected numbers", "bad");
  if (speed) request.speed_m_per_s = Number(speed);
  act(request, "move-message", (answer) => answer.task.duration_s === undefined
    ? "On its way." : `On its way, ${answer.task.duration_s.toFixed(1)} s without contacts.`);
}

function move(event) {
  event.preventDefault();
  const texts = ["x", "y", "z"].map((axis) => at(axis).value.trim());
  const to_m = texts.map((text) => (text === "" ? null : Number(text)));
  const isNumber = (value) => value === null || Number.isFinite(value);  // no other is left in JSON
  if (!to_m.every(isNumber))
    return show("move-message", "expected numbers", "bad");
  if (to_m.every((value) => value === null))
    return show("move-message", "no target, expected one of x, y and z", "bad");
  const request = { do: "move", to_m };
  if (at("relative").checked) {
    request.relative = true;
    request.to_m = to_m.map((value) => value || 0);
  }
  tellMove(request);
}

function goToPosture() {
  tellMove({ do: "move", to_posture: true });
}
