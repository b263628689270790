"use strict";
// The force as it comes, and the last contacts laid over each other and in a table.

const SHOWN_S = 30;
const OVERLAID = 6;

let plots = null;
let rows = []; // of the force: [t, N of each module, ...]
let forces = []; // of each module, the newest
let contacts = [];
let lasting = [];

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

/** F_th and F_act + F_th, at which contacts begin and rest; of a law without F_act the first alone. */
function forceLimits(gains, variant) {
  const threshold = gains["controller.contact_threshold_N"];
  const active = gains["controller.activation_force_N"];
  const hasActive = ["null_task", "null_joint", "null_limit"].includes(variant) && active !== null;
  return [["F_th", threshold], ...(hasActive ? [["F_act + F_th", active + threshold]] : [])];
}

function drawLimits(canvas, area, plot) {
  const gains = state && state.gains && state.gains.ordered;
  if (!gains) return;
  const colour = colours();
  canvas.save();
  canvas.font = "11px sans-serif";
  canvas.strokeStyle = canvas.fillStyle = colour.warn;
  canvas.setLineDash([4, 4]);
  for (const [name, force] of forceLimits(gains, (state.status || {}).variant)) {
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
    const force = state.log_problem ? undefined : forces[i];  // else it would be taken for what is felt now
    item.append(swatch, `${link} `, element("b", `${fixed(force, 2)} N`));
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
