"use strict";
// The table of gains: what is typed is judged before it can be sent.

const CHECK_AFTER_MS = 250;

let keys = [];
let check = { id: 0, values: "", refused: "", pending: false };

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
  const answer = await post("/api/do", { ...request, asked_s: now_s() });
  show(messageId, answer.done ? doneText(answer) : withoutPlace(answer.error), answer.done ? "good" : "bad");
  return answer.done;
}

async function set(event) {
  event.preventDefault();
  if (at("set").disabled) return;
  const request = { do: "set", values: typedValues() };
  const back = at("for").value.trim();
  if (back) request.for_s = Number(back);  // what is no number arrives as null, and the daemon knows its limits
  if (!await act(request, "message", (answer) => `Change ${answer.number} sent.`)) return;
  for (const input of document.querySelectorAll("#gains input")) input.value = "";
  typed();
}
