"use strict";
// What the panel's events tell is shown as it comes; what is typed is judged before it can be sent.

const SHOWN_S = 30;
const OVERLAID = 6;
const CHECK_AFTER_MS = 250;

const at = (id) => document.getElementById(id);
let token = "";
let state = null;
let keys = [];
let contacts = [];
let lasting = [];
let rows = []; // of the plot: [t, N of each module, ...]
let forces = []; // of each module, the newest
let check = { id: 0, values: "", refused: "", pending: false };
let source = null;
let plots = null;

function element(name, text = "", className = "") {
  const made = document.createElement(name);
  made.textContent = text;
  if (className) made.className = className;
  return made;
}

function show(id, text, className = "") {
  const shown = at(id);
  if (shown.textContent !== text) shown.textContent = text;
  if (shown.className !== className) shown.className = className;
}

/** Four digits, as short as they are; null: there is none. */
function numberText(value, digits = 4) {
  if (value === null || value === undefined) return "none";
  const short = Number(value.toPrecision(digits));
  return Math.abs(short) >= 1e6 ? short.toExponential() : String(short);
}

const fixed = (value, digits) => (typeof value === "number" ? value.toFixed(digits) : "-");

const sentence = (text) => `${text.charAt(0).toUpperCase()}${text.slice(1)}.`;

/** Errors name the place of a setting that nobody has written here. */
const withoutPlace = (error) => error.replace(/^--set \S+?:\d+:\d+: /, "");

// The panel's server.

function takeToken() {
  const found = location.hash.match(/^#token=([0-9a-f]+)$/);
  if (found) sessionStorage.setItem("token", found[1]);
  if (location.hash) history.replaceState(null, "", "/");
  token = sessionStorage.getItem("token") || "";
}

async function post(path, request) {
  const headers = { "Content-Type": "application/json" };
  if (token) headers["X-Tactus-Token"] = token;
  try {
    const body = JSON.stringify(request);
    const answer = await fetch(path, { method: "POST", headers, body });
    return await answer.json();
  } catch {
    return { done: false, error: "the panel does not answer" };
  }
}

function listen() {
  source = new EventSource("/api/events");
  source.onmessage = (message) => take(JSON.parse(message.data));
  source.onerror = () => {
    showBanner();
    if (source.readyState !== EventSource.CLOSED) return;
    setTimeout(listen, 2000);
  };
  source.onopen = showBanner;
}

function take(event) {
  if (event.begins) {
    contacts = [];
    lasting = [];
    rows = [];
    forces = [];
  }
  if (event.state) state = event.state;
  if (event.force) takeForce(event.force);
  if (event.contacts) contacts = contacts.concat(event.contacts).slice(-50);
  if (event.lasting) lasting = event.lasting;
  if (event.state || event.begins) showState();
  if (event.begins || event.force) drawForce();
  if (event.begins || event.contacts || event.lasting) showContacts();
}

// Mode, fault, and whether there is a daemon.

function showBanner() {
  const parts = [];
  const isDeaf = !source || source.readyState !== EventSource.OPEN;
  const isGone = state && !state.is_there;
  if (isDeaf) parts.push("The panel does not answer; this page tries again.");
  else if (state && state.problem) parts.push(sentence(state.problem));
  if (isGone && !isDeaf) parts.push("This page goes on when there is one again.");
  if (!isDeaf && !isGone && state && state.control_problem)
    parts.push(`No gains and no task: ${state.control_problem}.`);
  if (!token) parts.push("Read only: changes need the whole address that tactus panel has printed.");
  at("banner").hidden = parts.length === 0;
  show("banner", parts.join(" "), isDeaf || isGone ? "bad" : "");
  document.querySelector("main").className = isDeaf || isGone ? "stale" : "";
}

function showMode() {
  const status = state.status || {};
  const mode = state.is_there ? status.mode || "unknown" : "no daemon";
  const kind = { running: "running", fault: "bad", off: "bad", "no daemon": "bad" }[mode] || "waiting";
  show("mode", mode, `pill ${kind}`);
  const hasFault = Boolean(status.fault && status.fault !== "none");
  at("fault").hidden = !hasFault;
  show("fault", hasFault ? `fault: ${status.fault}` : "", "pill bad");
  const isMore = status.description && status.description !== mode;
  const lost = (status.modules_lost || []).map((link) => `${link} lost: goes on slowly without`);
  show("description", [isMore ? status.description : "", ...lost].filter(Boolean).join("; "));
  show("scene", status.scene ? `${status.scene} (${status.variant})` : "");
  document.title = `${mode} - Tactus`;
}

function showState() {
  showBanner();
  showMode();
  showGains();
  showTask();
  const note = state.is_reading ? "Reading the log of the run so far ..." : state.log_problem;
  at("log-note").hidden = !note;
  show("log-note", note ? sentence(note.replace(/[. ]*$/, "")) : "", "note");
}

// Plots.

function colours() {
  const style = getComputedStyle(document.documentElement);
  const of = (name) => style.getPropertyValue(name).trim();
  const series = of("--series").split(",").map((colour) => colour.trim());
  return { line: of("--line"), faint: of("--faint"), warn: of("--warn"), series };
}

/** Smallest and largest force of a bin, in the order in which they most likely came. */
function extremes(low, high, i) {
  const falls = i > 0 && low[i] + high[i] < low[i - 1] + high[i - 1];
  return falls ? [high[i], low[i]] : [low[i], high[i]];
}

/** Two rows a bin, [t, N of each module, ...], so that the smallest and the largest force are both drawn. */
function rowsOf(force) {
  const made = [];
  force.t.forEach((t, i) => {
    const half = ((i + 1 < force.t.length ? force.t[i + 1] : t + 0.01) - t) / 2;
    const both = force.low.map((low, module) => extremes(low, force.high[module], i));
    made.push([t, ...both.map((pair) => pair[0])], [t + half, ...both.map((pair) => pair[1])]);
  });
  return made;
}

function takeForce(force) {
  if (force.low.length && force.t.length) forces = force.high.map((high) => high[high.length - 1]);
  rows = rows.concat(rowsOf(force));
  const last = rows.length ? rows[rows.length - 1][0] : 0;
  rows = rows.filter((row) => row[0] >= last - SHOWN_S);
}

/** F_th and F_act + F_th, at which contacts begin and rest. */
function drawLimits(canvas, area, plot) {
  const gains = state && state.gains && state.gains.ordered;
  if (!gains) return;
  const threshold = gains["controller.contact_threshold_N"];
  const active = gains["controller.activation_force_N"];
  const names = [["F_th", threshold]];
  if (active !== null) names.push(["F_act + F_th", active + threshold]);
  const colour = colours();
  canvas.save();
  canvas.font = "11px sans-serif";
  canvas.strokeStyle = canvas.fillStyle = colour.warn;
  canvas.setLineDash([4, 4]);
  for (const [name, force] of names) {
    const y = plot.toDomYCoord(force);
    if (!(y > area.y && y < area.y + area.h)) continue;
    canvas.beginPath();
    canvas.moveTo(area.x, y);
    canvas.lineTo(area.x + area.w, y);
    canvas.stroke();
    canvas.fillText(name, area.x + 4, y - 3);
  }
  canvas.restore();
}

function makePlot(id) {
  const options = {
    labels: ["t", "-"],
    interactionModel: {},
    highlightCircleSize: 0,
    legend: "never",
    connectSeparatedPoints: true,
    strokeWidth: 1.5,
    includeZero: true,
    axisLabelFontSize: 12,
    xRangePad: 0,
    underlayCallback: drawLimits,
    axes: { x: { valueFormatter: String, axisLabelFormatter: (t) => (t < 0 ? "" : numberText(t)), ticker: Dygraph.numericLinearTicks } },
  };
  return new Dygraph(at(id), [[0, null]], options);
}

function paint(plot, options) {
  const colour = colours();
  plot.updateOptions({ axisLineColor: colour.faint, gridLineColor: colour.line, ...options });
}

/** At least so much of the axis, so that noise is not blown up. */
function forceRange(data) {
  let least = 0;
  let most = 6;
  for (const row of data)
    for (let i = 1; i < row.length; ++i) {
      if (row[i] === null) continue;
      least = Math.min(least, row[i]);
      most = Math.max(most, row[i]);
    }
  return [1.08 * least, 1.08 * most];
}

function drawForce() {
  const links = state ? state.links : [];
  const series = colours().series;
  const legend = at("forces");
  legend.replaceChildren(...links.map((link, i) => {
    const item = element("span");
    const swatch = element("span", "", "swatch");
    swatch.style.background = series[i % series.length];
    item.append(swatch, `${link} `, element("b", `${fixed(forces[i], 2)} N`));
    return item;
  }));
  const width = links.length + 1;
  const data = rows.filter((row) => row.length === width);
  if (!plots || !links.length) return;
  const last = data.length ? data[data.length - 1][0] : SHOWN_S;
  paint(plots.force, {
    file: data.length ? data : [[0, ...links.map(() => null)]],
    labels: ["t", ...links],
    colors: links.map((_, i) => series[i % series.length]),
    dateWindow: [Math.max(0, last - SHOWN_S), Math.max(last, 1)],
    valueRange: forceRange(data),
  });
}

// Contacts.

/** The newest first, with those that last before all. */
function shownContacts() {
  const over = contacts.map((contact) => ({ ...contact, lasts: false }));
  return over.concat(lasting.map((contact) => ({ ...contact, lasts: true }))).reverse();
}

function drawOverlay(traced) {
  if (!plots) return;
  const series = colours().series;
  const data = [];
  traced.forEach((contact, i) => {
    for (const [t, force] of rowsOf(contact.trace)) {
      const row = [t, ...traced.map(() => null)];
      row[i + 1] = force;
      data.push(row);
    }
  });
  data.sort((one, other) => one[0] - other[0]);
  paint(plots.overlay, {
    file: data.length ? data : [[0, null]],
    labels: ["t", ...(data.length ? traced.map((_, i) => `contact ${i + 1}`) : ["-"])],
    colors: traced.length ? traced.map((_, i) => series[i % series.length]) : [series[0]],
    dateWindow: [-0.2, Math.max(1, ...data.map((row) => row[0]))],
    valueRange: forceRange(data),
  });
}

function contactRow(contact, colour) {
  const row = element("tr", "", contact.lasts ? "lasts" : "");
  const swatch = element("td");
  if (colour) {
    const square = element("span", "", "swatch");
    square.style.background = colour;
    swatch.append(square);
  }
  row.append(swatch, element("td", fixed(contact.start_s, 2)), element("td", contact.tactile_module),
    element("td", fixed(1e3 * contact.position_m, 0), "wide"),
    element("td", fixed(contact.peak_force_N, 2)), element("td", fixed(contact.rest_force_N, 2)),
    element("td", contact.lasts ? "lasts" : fixed(contact.settling_s, 2)),
    element("td", fixed(contact.swing_N, 2), "wide"),
    element("td", fixed(contact.stiffness_N_per_m, 0), "wide"),
    element("td", fixed(1e3 * contact.tcp_error_max_m, 1), "wide"),
    element("td", numberText(contact.time_constant_s, 3), "wide"),
    element("td", numberText(contact.damping, 3), "wide"));
  return row;
}

function showContacts() {
  const all = shownContacts();
  const traced = all.filter((contact) => contact.trace && contact.trace.t.length).slice(0, OVERLAID);
  const series = colours().series;
  const colourOf = (contact) => {
    const index = traced.indexOf(contact);
    return index < 0 ? "" : series[index % series.length];
  };
  const body = document.querySelector("#contacts tbody");
  body.replaceChildren(...all.map((contact) => contactRow(contact, colourOf(contact))));
  at("no-contact").hidden = all.length > 0;
  drawOverlay(traced);
}

// Gains.

/** What is changed most comes first. */
function rank(key) {
  return ["controller", "stiffness", "task"].findIndex((section) => key.key.startsWith(section)) >>> 0;
}

function makeGains() {
  keys.sort((one, other) => rank(one) - rank(other));
  const body = document.querySelector("#gains tbody");
  let group = "";
  for (const key of keys) {
    const dot = key.key.lastIndexOf(".");
    if (key.key.slice(0, dot) !== group) {
      group = key.key.slice(0, dot);
      const title = element("tr", "", "group");
      const name = element("th", group);
      name.colSpan = 3;
      title.append(name);
      body.append(title);
    }
    body.append(gainRow(key, key.key.slice(dot + 1)));
  }
}

function gainRow(key, name) {
  const row = element("tr");
  row.dataset.key = key.key;
  const label = element("label");
  label.htmlFor = `gain-${key.key}`;
  if (key.symbol) label.append(element("span", key.symbol, "symbol"));
  const small = element("small");
  for (const word of name.split(/(?<=_)/)) small.append(word, element("wbr"));
  label.append(small);
  const what = element("td");
  what.title = `${key.meaning}. ${key.facts}`;
  what.append(label);
  const input = element("input");
  input.id = label.htmlFor;
  input.inputMode = "decimal";
  input.addEventListener("input", typed);
  input.addEventListener("keydown", (event) => {
    if (event.key !== "Escape") return;
    input.value = "";
    typed();
  });
  const entry = element("td");
  entry.append(input);
  row.append(what, element("td", "-"), entry);
  return row;
}

function typedValues() {
  const values = {};
  for (const row of document.querySelectorAll("#gains tr[data-key]")) {
    const text = row.querySelector("input").value.trim();
    if (text) values[row.dataset.key] = text;
  }
  return values;
}

function gainStateText(gains) {
  if (gains.trouble) return `Change ${gains.number} went back: ${gains.trouble}.`;
  const words = {
    waiting: "waits for a moment without contact",
    ramping: "is on its way",
    on_trial: "is there, and is watched in contact",
    going_back: "goes back",
    kept: "is kept",
  };
  return gains.number ? `Change ${gains.number} ${words[gains.state] || gains.state}.` : "Nothing was changed since the start.";
}

function showGains() {
  const gains = state.gains;
  document.querySelectorAll("#gains-form input, #undo, #save").forEach((part) => {
    part.disabled = !gains || !token;
  });
  allowSet();
  if (!gains) {
    check.ordered = "";  // judged anew once there are some
    return show("gain-state", "", "note");
  }
  show("gain-state", gainStateText(gains), gains.trouble ? "bad" : "note");
  at("gain-state").dataset.state = gains.state;
  for (const row of document.querySelectorAll("#gains tr[data-key]")) {
    const key = keys.find((one) => one.key === row.dataset.key);
    const ordered = gains.ordered[key.key];
    const isMoving = key.key in state.now;
    const text = isMoving ? `${numberText(state.now[key.key])} → ${numberText(ordered)}` : numberText(ordered);
    const cell = row.children[1];
    const unit = key.unit && ordered !== null ? ` ${key.unit}` : "";
    if (cell.textContent !== text + unit) cell.replaceChildren(text, element("small", unit));
    row.className = ordered !== gains.kept[key.key] || isMoving ? "differs" : "";
  }
  const now = JSON.stringify(gains.ordered);
  if (now !== check.ordered) {
    check.ordered = now;
    judge();
  }
}

function allowSet() {
  const isJudged = check.values === JSON.stringify(typedValues()) && !check.pending;
  const hasValues = check.values !== "{}" && check.values !== "";
  at("set").disabled = !(token && state && state.gains && isJudged && hasValues && !check.refused);
}

let checkTimer = 0;
function typed() {
  allowSet();
  clearTimeout(checkTimer);
  checkTimer = setTimeout(judge, CHECK_AFTER_MS);
}

async function judge() {
  const values = typedValues();
  const id = ++check.id;
  check.pending = true;
  allowSet();
  const answer = await post("/api/check", { values });
  if (id !== check.id) return;
  check.pending = false;
  check.values = JSON.stringify(values);
  check.refused = answer.done ? answer.refused : answer.error;
  showCheck(answer, Object.keys(values).length > 0);
  allowSet();
}

const degrees = (margin) => (margin === null ? "none to be computed" : `${margin.toFixed(1)}°`);

function showCheck(answer, hasValues) {
  if (!answer.done) {
    show("margin", "");
    show("verdict", withoutPlace(answer.error), "bad");
    at("check").className = "";
    return;
  }
  const least = answer.least_deg === null ? "" : `, at least ${degrees(answer.least_deg)}`;
  const running = degrees(answer.running_deg);
  show("margin", hasValues
    ? `Phase margin ${running} → ${degrees(answer.margin_deg)}${least}`
    : `Phase margin ${running}${least}`);
  let verdict = hasValues ? "Would be taken." : "";
  if (hasValues && answer.waits_for_free) verdict += " Begins at the next moment without contact.";
  if (!answer.refused) verdict = [verdict, ...answer.warnings.map((text) => `Warning: ${text}.`)].join(" ");
  else verdict = `Refused: ${withoutPlace(answer.refused)}`;
  show("verdict", verdict.trim(), answer.refused ? "bad" : "good");
  const kind = answer.refused ? "bad-check" : "good-check";
  at("check").className = hasValues ? kind : "";
}

async function act(request, messageId, doneText) {
  show(messageId, "...");
  const answer = await post("/api/do", request);
  show(messageId, answer.done ? doneText(answer) : withoutPlace(answer.error), answer.done ? "good" : "bad");
  return answer.done;
}

async function set(event) {
  event.preventDefault();
  if (at("set").disabled) return;
  const request = { do: "set", values: typedValues() };
  const back = at("for").value.trim();
  if (back) request.for_s = Number(back);
  if (back && !(request.for_s > 0)) return show("message", "go back after: expected seconds", "bad");
  if (!await act(request, "message", (answer) => `Change ${answer.number} sent.`)) return;
  for (const input of document.querySelectorAll("#gains input")) input.value = "";
  typed();
}

// The tool.

function taskText(task) {
  const where = task.p_BaseTool_m.map((value) => value.toFixed(3)).join(", ");
  const words = { given_up: "has given up, was blocked", late: "the stream was late" };
  let text = `${words[task.state] || task.state}, at ${where} m`;
  if (task.waiting) text += `, ${task.waiting} waypoints left`;
  if (task.contact) text += `; contact of ${task.contact.force_N.toFixed(2)} N on ${task.contact.module}`;
  return text;
}

function showTask() {
  const task = state.task;
  const isTold = Boolean(task);
  at("hold").hidden = !isTold;
  at("move-form").hidden = !isTold;
  at("hold").disabled = at("move").disabled = !token || !isTold || !task.is_running;
  show("task-state", isTold ? taskText(task) : state.gains ? "The task is a trajectory: nobody tells the tool where to go." : "", "note");
  at("task-state").dataset.state = isTold ? task.state : "";
}

function move(event) {
  event.preventDefault();
  const texts = ["x", "y", "z"].map((axis) => at(axis).value.trim());
  const to_m = texts.map((text) => (text === "" ? null : Number(text)));
  const speed = at("speed").value.trim();
  if (to_m.some(Number.isNaN) || Number.isNaN(Number(speed)))
    return show("move-message", "expected numbers", "bad");
  if (to_m.every((value) => value === null))
    return show("move-message", "no target, expected one of x, y and z", "bad");
  const request = { do: "move", to_m };
  if (at("relative").checked) {
    request.relative = true;
    request.to_m = to_m.map((value) => value || 0);
  }
  if (speed) request.speed_m_per_s = Number(speed);
  act(request, "move-message", (answer) => answer.task.duration_s === undefined
    ? "On its way." : `On its way, ${answer.task.duration_s.toFixed(1)} s without contacts.`);
}

async function begin() {
  takeToken();
  addEventListener("hashchange", () => {
    takeToken();
    if (state) showState();
  });
  at("gains-form").addEventListener("submit", set);
  at("move-form").addEventListener("submit", move);
  at("undo").addEventListener("click", () => act({ do: "undo" }, "message", (answer) => `Change ${answer.number} sent, back to what was kept before.`));
  at("save").addEventListener("click", () => act({ do: "save" }, "message", (answer) =>
    answer.written ? `${answer.scene} written, as it was is ${answer.scene}~.` : `${answer.scene} has all that runs.`));
  at("hold").addEventListener("click", () => act({ do: "hold" }, "move-message", () => "Holding."));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    drawForce();
    showContacts();
  });
  // It writes styles into its elements, which the page's policy forbids.
  Dygraph.PLUGINS = Dygraph.PLUGINS.filter((plugin) => plugin !== Dygraph.Plugins.Legend);
  plots = { force: makePlot("force-plot"), overlay: makePlot("overlay-plot") };
  while (!keys.length) {
    try {
      keys = await (await fetch("/api/keys")).json();
    } catch {
      await new Promise((done) => setTimeout(done, 1000));
    }
  }
  makeGains();
  showContacts();
  listen();
}

begin();
