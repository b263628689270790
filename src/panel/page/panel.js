"use strict";
// Events come from the panel and are handed to the parts of the page.

const SILENT_MS = 5000;  // the panel says something every two seconds

let source = null;
let heard_ms = 0;
let refusal = ""; // why there are no events

function listen() {
  if (source || document.hidden) return;
  source = new EventSource("/api/events");
  heard_ms = performance.now();
  source.onmessage = (message) => {
    heard_ms = performance.now();
    take(JSON.parse(message.data));
  };
  source.onerror = () => {
    if (source.readyState !== EventSource.CLOSED) refusal = "";
    showBanner();
    if (source.readyState !== EventSource.CLOSED) return;
    source = null;
    askForRefusal();
    setTimeout(listen, 2000);
  };
  source.onopen = () => {
    refusal = "";
    showBanner();
    checkToken();
  };
}

/** Events that are refused do not say why. */
async function askForRefusal() {
  const asking = new AbortController();
  setTimeout(() => asking.abort(), SILENT_MS);
  try {
    const answer = await fetch("/api/events", { signal: asking.signal });
    refusal = answer.ok ? "" : (await answer.json()).error;
  } catch {
    refusal = "";
  }
  asking.abort();  // they are told by now
  showBanner();
}

/** Pages that are seen may take all six connections of a browser: what waits for one comes before the events. */
function makeRoom() {
  if (!source) return;
  source.close();
  source = null;
  listen();
}

/** Before Hold is needed: a panel that began anew has another one. */
async function checkToken() {
  if (!token) return;
  const headers = { "X-Tactus-Token": token };
  try {
    const answer = await fetch("/api/do", { headers, signal: AbortSignal.timeout(PATIENCE_MS) });
    if (answer.status === 401) forgetToken(headers["X-Tactus-Token"]);
  } catch {
    // the events tell that nobody answers
  }
}

function forgetToken(refused) {
  if (token !== refused) return;
  token = "";
  sessionStorage.removeItem("token");
  showAnew();
}

function showAnew() {
  if (state) return showState();
  showBanner();
  showHold();
}

/** Behind a tunnel whose other end is gone a connection stays as it was. */
function lookForLife() {
  if (!source || performance.now() - heard_ms < SILENT_MS) return;
  source.close();
  source = null;
  listen();
  showBanner();
}

/** Of six connections to a server, which are all that a browser has, a page that nobody sees takes none. */
function listenWhileSeen() {
  if (!document.hidden) return listen();
  if (source) source.close();
  source = null;
  document.title = "Tactus";
  showBanner();
}

function take(event) {
  clock = { said_s: event.now_s, heard_ms: performance.now() };
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
  if (event.begins || event.force || event.state) drawForce();
  if (event.begins || event.contacts || event.lasting) showContacts();
}

function showBanner() {
  const parts = [];
  const isDeaf = !source || source.readyState !== EventSource.OPEN;
  const isGone = state && !state.is_there;
  if (isDeaf && refusal) parts.push(sentence(refusal), "This page tries again.");
  else if (isDeaf) parts.push("The panel does not answer; this page tries again.");
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
  const waits = status.waits_for ? `waits for ${status.waits_for}` : "";
  const remedy = status.remedy ? `do: ${status.remedy}` : "";
  show("description", [isMore ? status.description : "", waits, remedy, ...lost].filter(Boolean).join("; "));
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

async function begin() {
  takeToken();
  showHold();
  addEventListener("hashchange", () => {
    takeToken();
    showAnew();
  });
  at("gains-form").addEventListener("submit", set);
  at("move-form").addEventListener("submit", move);
  at("undo").addEventListener("click", () => act({ do: "undo" }, "message", (answer) => `Change ${answer.number} sent, back to what was kept before.`));
  at("save").addEventListener("click", () => act({ do: "save" }, "message", (answer) =>
    answer.written ? `${answer.scene} written, as it was is ${answer.scene}~.` : `${answer.scene} has all that runs.`));
  at("hold").addEventListener("click", hold);
  at("to-posture").addEventListener("click", goToPosture);
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
  document.addEventListener("visibilitychange", listenWhileSeen);
  setInterval(lookForLife, 1000);
  listen();
}

begin();
