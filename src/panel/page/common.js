"use strict";
// What all parts of the page share. The scripts are read in the order in which index.html names them.

const PATIENCE_MS = 20000;  // the panel itself waits 10 s for the daemon
const ROOM_AFTER_MS = 1000;

const at = (id) => document.getElementById(id);
let token = "";
let state = null; // the newest of the panel's events
let clock = { said_s: NaN, heard_ms: 0 }; // the panel's, as the newest event has told it

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

function takeToken() {
  const found = location.hash.match(/^#token=([0-9a-f]+)$/);
  if (found) sessionStorage.setItem("token", found[1]);
  if (location.hash) history.replaceState(null, "", "/");
  token = sessionStorage.getItem("token") || "";
}

/** The panel's clock, behind it by what an event takes to come: what is asked looks older, never newer. */
const now_s = () => clock.said_s + (performance.now() - clock.heard_ms) / 1000;

async function post(path, request) {
  const headers = { "Content-Type": "application/json" };
  const sent = token;
  if (token) headers["X-Tactus-Token"] = token;
  const room = setTimeout(makeRoom, request.do === "hold" ? 0 : ROOM_AFTER_MS);
  try {
    const body = JSON.stringify(request);
    const signal = AbortSignal.timeout(PATIENCE_MS);
    const answer = await fetch(path, { method: "POST", headers, body, signal });
    if (answer.status === 401) forgetToken(sent);
    return await answer.json();
  } catch {
    return { done: false, error: "the panel does not answer" };
  } finally {
    clearTimeout(room);
  }
}
