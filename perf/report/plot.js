// Plots of error over time: in the page of `welkin report`, and in files (scripts/plot-report, by Node.js).
"use strict";

const ERROR_TARGETS = [0.001, 0.005, 0.01, 0.05];

const escaped = (text) =>
  String(text).replace(/[&<>"']/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "'": "&#39;" })[c]);

/** 1.2e-05 -> "1.2e-05", as C prints it. */
const exponent = (text) => text.replace(/e([+-])(\d)$/, "e$10$2");
const digits = (value, count) => exponent(String(Number(value.toPrecision(count))));

/** Two significant digits of a percentage: 0.0123 is "1.2 %"; below 0.001 % scientific. */
function percent(share) {
  if (share === null) return "no number";
  const value = 100 * share;
  if (value === 0) return "0 %";
  if (Math.abs(value) < 1e-3) return `${exponent(value.toExponential(1))} %`;
  return Math.abs(value) < 9.95 ? `${digits(value, 2)} %` : `${value.toFixed(0)} %`;
}

/** Three significant digits in ns, us, ms or s. */
function duration(seconds) {
  if (seconds === null) return "no number";
  if (seconds < 0.9995e-6) return `${digits(1e9 * seconds, 3)} ns`;
  if (seconds < 0.9995e-3) return `${digits(1e6 * seconds, 3)} \u00b5s`;
  if (seconds < 0.9995) return `${digits(1e3 * seconds, 3)} ms`;
  return `${digits(seconds, 3)} s`;
}

const methodOf = (one) => (one.peer === null ? one.method : `${one.peer}, ${one.method}`);
const labelOf = (one) => `${methodOf(one)}, ${one.setting}`;
const isDrawn = (one) => one.seconds !== null && one.error_rms !== null;
/** Another program's error without a time: a line across the plot. */
const isLine = (one) => one.seconds === null && one.error_rms !== null && one.peer !== null;
const clockOf = (machine) => `${machine.clock} of a call, ${machine.threads} ${machine.threads === 1 ? "thread" : "threads"}`;

const WIDTH = 860;
const HEIGHT = 420; // of the frame with its axes, without the legend
const AREA = { left: 70, top: 16, right: WIDTH - 20, bottom: HEIGHT - 52 };
const LEGEND_ROW = 20;
// The palette of Okabe and Ito (2008), which colour-blind readers can distinguish too.
const COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#8c6d00", "#56b4e9", "#000000", "#7a7a7a"];

/**
 * Maps values to positions along an edge of the plot. Values below `floor` are drawn at it. The axis spans at least one
 * and a half decades, so that noise does not fill it.
 */
function logAxis(values, floor, from, to) {
  const [LEAST, MARGIN] = [1.5, 0.12]; // decades
  const logs = values.filter((value) => value !== null && value >= 0).map((value) => Math.log10(Math.max(value, floor)));
  let [low, high] = logs.length === 0 ? [-1, 1] : [Math.min(...logs) - MARGIN, Math.max(...logs) + MARGIN];
  const missing = Math.max(0, LEAST - (high - low));
  low -= missing / 2;
  high += missing / 2;
  const shows = (value) => Math.log10(value) >= low && Math.log10(value) <= high;
  const decades = [];
  const minor = [];
  for (let power = Math.floor(low); power <= high; ++power) {
    if (power >= low) decades.push(10 ** power);
    for (let factor = 2; factor <= 9; ++factor) if (shows(factor * 10 ** power)) minor.push(factor * 10 ** power);
  }
  const place = (value) => from + ((to - from) * (Math.log10(Math.max(value, floor)) - low)) / (high - low);
  return { place, shows, decades, minor };
}

/** Finds places for words near points, none of which lie on each other. */
function labelPlaces() {
  const taken = [];
  const touch = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
  const place = (x, y, text, size) => {
    const [LETTER, GAP] = [0.56, 9]; // a letter's width in its size, on the safe side; from the point's centre
    const width = LETTER * size * text.length;
    const half = 0.35 * size; // from the baseline to the middle of small letters
    for (const anchor of ["start", "end"])
      for (const [dx, dy] of [[GAP, half], [0.7 * GAP, -GAP], [0.7 * GAP, GAP + 2 * half]]) {
        const at = { x: anchor === "start" ? x + dx : x - dx, y: y + dy, anchor };
        const left = anchor === "start" ? at.x : at.x - width;
        const box = { left, top: at.y - 0.8 * size, right: left + width, bottom: at.y + 0.25 * size };
        const isInside = box.left >= AREA.left && box.right <= AREA.right && box.top >= AREA.top && box.bottom <= AREA.bottom;
        if (!isInside || taken.some((other) => touch(box, other))) continue;
        taken.push(box);
        return at;
      }
    return null;
  };
  const keepFree = (left, top, right, bottom) => taken.push({ left, top, right, bottom });
  /** Takes a box unless something lies there. */
  const takes = (left, top, right, bottom) => {
    if (top < AREA.top || taken.some((other) => touch({ left, top, right, bottom }, other))) return false;
    return keepFree(left, top, right, bottom) > 0;
  };
  return { place, keepFree, takes };
}

/** A power of ten in percent; with an exponent where zeros would not fit next to the axis. */
function percentOfPower(value) {
  const power = Math.round(Math.log10(value)) + 2;
  return power < -3 ? `1e${power} %` : `${(100 * value).toFixed(Math.max(0, -power))} %`;
}

const number = (value) => value.toFixed(1);
const line = (x1, y1, x2, y2, style) =>
  `<line x1="${number(x1)}" y1="${number(y1)}" x2="${number(x2)}" y2="${number(y2)}" ${style}/>\n`;
const words = (x, y, text, style) => `<text x="${number(x)}" y="${number(y)}" ${style}>${escaped(text)}</text>\n`;
const ring = (x, y, r, more) =>
  `<circle cx="${number(x)}" cy="${number(y)}" r="${r}" ${more} stroke="#222222" stroke-width="1.4"/>`;
const sign = (one, x, y, paint) =>
  one.peer === null ? `<circle cx="${number(x)}" cy="${number(y)}" r="4.2" fill="${paint}"/>`
                    : `<rect x="${number(x - 4)}" y="${number(y - 4)}" width="8" height="8" fill="#ffffff" stroke="${paint}"` +
                      ` stroke-width="1.8"/>`;

function axesOf(times, errors, machine) {
  const { left, top, right, bottom } = AREA;
  let svg = "";
  const word = (value, fill) => words(times.place(value), bottom + 20, duration(value), `text-anchor="middle" fill="${fill}"`);
  for (const value of times.minor) svg += line(times.place(value), bottom, times.place(value), bottom + 3, 'stroke="#999999"');
  for (const value of errors.minor) svg += line(left - 3, errors.place(value), left, errors.place(value), 'stroke="#999999"');
  for (const value of times.decades)
    svg += line(times.place(value), top, times.place(value), bottom + 6, 'stroke="#e4e4e4"') + word(value, "#333333");
  // With few powers of ten, the values between them are labelled too.
  if (times.decades.length < 3)
    for (const value of times.minor)
      if ([2, 5].includes(Math.round(value / 10 ** Math.floor(Math.log10(value) + 1e-9)))) svg += word(value, "#666666");
  for (const value of errors.decades)
    svg += line(left - 6, errors.place(value), right, errors.place(value), 'stroke="#e4e4e4"') +
           words(left - 9, errors.place(value) + 4, percentOfPower(value), 'text-anchor="end" fill="#333333"');
  const middle = (top + bottom) / 2;
  return svg + `<rect x="${left}" y="${top}" width="${right - left}" height="${bottom - top}" fill="none" stroke="#666666"/>\n` +
         words((left + right) / 2, bottom + 40, clockOf(machine), 'text-anchor="middle" fill="#333333"') +
         words(14, middle, "rms error", `text-anchor="middle" fill="#333333" transform="rotate(-90 14 ${number(middle)})"`);
}

function targetsOf(errors, places) {
  let svg = "";
  for (const target of ERROR_TARGETS.filter(errors.shows)) {
    const at = errors.place(target);
    const base = at - 13 < AREA.top ? at + 11 : at - 3; // of the word: below the line where there is no room
    svg += line(AREA.left, at, AREA.right, at, 'stroke="#bb9955" stroke-dasharray="2 4"') +
           words(AREA.right - 4, base, percent(target), 'text-anchor="end" fill="#997733" font-size="10"');
    places.keepFree(AREA.right - 36, base - 10, AREA.right, base + 3);
  }
  return svg;
}

/** Errors without a time, each with its words where there is room. */
function untimedOf(lines, errors, paint, places) {
  let svg = "";
  for (const one of lines) {
    const at = errors.place(one.error_rms);
    const text = `${methodOf(one)}, ${one.setting}: not timed`;
    const colour = paint(one);
    svg += `<g class="point"><title>${escaped(labelOf(one))}\n${percent(one.error_rms)} rms, ` +
           `${percent(one.error_maximum)} at most</title>` +
           line(AREA.left, at, AREA.right, at, `stroke="${colour}" stroke-width="1.4" stroke-dasharray="9 3"`) + "</g>";
    for (const base of [at - 4, at + 12]) {
      if (!places.takes(AREA.left + 6, base - 9, AREA.left + 6 + 6.2 * text.length, base + 2)) continue;
      svg += words(AREA.left + 6, base, text, `fill="${colour}" font-size="11"`);
      break;
    }
  }
  return svg;
}

/** Returns the signs' meaning and its height. */
function legendOf(series) {
  let svg = "";
  let [x, y] = [AREA.left, HEIGHT + 8];
  const next = (text) => {
    const width = 34 + 6.6 * text.length;
    if (x > AREA.left && x + width > AREA.right) [x, y] = [AREA.left, y + LEGEND_ROW];
    svg += words(x + 11, y + 4, text, 'fill="#222222"');
    x += width;
    return x - width;
  };
  for (const [name, { members, paint }] of series) {
    const place = next(name);
    svg += sign(members[0], place + 2, y, paint);
  }
  const here = next("on the front");
  svg += ring(here + 1, y, 6.5, 'fill="none"') + "\n";
  return [svg, y + LEGEND_ROW - HEIGHT];
}

/** An SVG image of a pass's measurements, as the JSON of a report has them; "" if there is nothing to draw. */
function plotSvg(pass, measurements, machine) {
  const drawn = measurements.filter(isDrawn);
  if (drawn.length === 0) return "";
  const times = logAxis(drawn.map((one) => one.seconds), 1e-9, AREA.left, AREA.right);
  const untimed = measurements.filter(isLine);
  const errors = logAxis([...drawn, ...untimed].map((one) => one.error_rms), 1e-9, AREA.bottom, AREA.top);
  const places = labelPlaces();
  const [x, y] = [(one) => times.place(one.seconds), (one) => errors.place(one.error_rms)];
  const series = new Map(); // methods in the order in which they come; a peer's are its own
  for (const one of measurements) {
    if (!series.has(methodOf(one))) series.set(methodOf(one), { members: [], paint: COLOURS[series.size % COLOURS.length] });
    series.get(methodOf(one)).members.push(one);
  }
  const [legend, legendHeight] = legendOf(new Map([...series].filter(([, { members }]) => members.some(isDrawn))));
  let svg = `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${WIDTH} ${HEIGHT + legendHeight}" width="${WIDTH}" ` +
            `height="${HEIGHT + legendHeight}" role="img" font-family="system-ui, sans-serif" font-size="12">\n` +
            `<title>${escaped(pass.title)}: error over time</title>\n<rect width="100%" height="100%" fill="#ffffff"/>\n` +
            axesOf(times, errors, machine) + targetsOf(errors, places);
  for (const { members, paint } of series.values())
    svg += `<polyline fill="none" stroke="${paint}" stroke-width="1" opacity="0.55"` +
           `${members[0].peer === null ? "" : ' stroke-dasharray="4 3"'} points="` +
           `${members.filter(isDrawn).map((one) => `${number(x(one))},${number(y(one))}`).join(" ")}"/>\n`;
  const front = drawn.filter((one) => one.on_front).sort((a, b) => a.seconds - b.seconds);
  const steps = front.map((one, at) => (at === 0 ? `M${number(x(one))} ${number(y(one))}` : `H${number(x(one))}V${number(y(one))}`));
  svg += `<path fill="none" stroke="#222222" stroke-width="5" opacity="0.13" d="${steps.join("")}"/>\n`;
  for (const { members, paint } of series.values())
    for (const one of members.filter(isDrawn)) {
      svg += `<g class="point"><title>${escaped(labelOf(one))}\n${percent(one.error_rms)} rms, ` +
             `${percent(one.error_maximum)} at most\n${duration(one.seconds)}${one.on_front ? "\non the front" : ""}</title>` +
             `${one.on_front ? ring(x(one), y(one), 7.5, 'fill="#ffffff"') : ""}${sign(one, x(one), y(one), paint)}</g>\n`;
      places.keepFree(x(one) - 6, y(one) - 6, x(one) + 6, y(one) + 6);
    }
  svg += untimedOf(untimed, errors, (one) => series.get(methodOf(one)).paint, places);
  // The front's words first, then those of peers, then of the rest where there is room.
  const rest = drawn.filter((one) => !one.on_front);
  for (const one of [...front, ...rest.filter((one) => one.peer !== null), ...rest.filter((one) => one.peer === null)]) {
    const at = places.place(x(one), y(one), one.setting, 11);
    if (at)
      svg += words(at.x, at.y, one.setting, 'font-size="11" fill="#222222" stroke="#ffffff" stroke-width="3" ' +
                                            `paint-order="stroke" text-anchor="${at.anchor}"`);
  }
  return `${svg}${legend}</svg>\n`;
}

if (typeof module !== "undefined") module.exports = { plotSvg };
