/** Outcomes: how a thousand trials with the numbers of now come out, beside those of before and those that were watched. */

import { part } from "./controls.js";
import { number } from "./plots.js";

/** @typedef {[number | null, number | null, number | null]} Interval mean, lower and upper end */

/** @typedef {{trials?: number, rows?: Record<string, Interval>, seconds?: number, refused?: string}} Estimate */

/** Measures in words, with their unit and how many times 1 that is. @type {Record<string, [string, string, number]>} */
const NAMES = {
  success: ["arrived", "%", 100],
  captured: ["captured", "", 1],
  crashed: ["crashed", "", 1],
  time: ["time", "s", 1],
};

/** Write a mean, and half its interval. @param {Interval | undefined} told @param {number} times @returns {string[]} */
function estimate(told, times) {
  if (!told || told[0] === null) return ["–"];
  const [mean, low, high] = told.map((each) => (each === null ? NaN : each * times));
  const half = (high - low) / 2;
  const digits = half > 0 ? Math.min(Math.max(1 - Math.floor(Math.log10(half)), 0), 3) : 2;
  return half > 0 ? [number(mean, digits), `± ${number(half, digits)}`] : [number(mean, digits)];
}

/** Tell whether two intervals have nothing in common. @param {Interval | undefined} a @param {Interval | undefined} b */
function apart(a, b) {
  if (!a || !b || [...a, ...b].includes(null)) return false;
  const [low, high, other, top] = /** @type {number[]} */ ([a[1], a[2], b[1], b[2]]);
  return low > top || other > high;
}

/**
 * Add a cell, with a second line in small type.
 * @param {HTMLTableRowElement} row @param {string[]} lines @param {boolean} [head] @param {string} [kind]
 */
function cell(row, [words, below], head = false, kind = "") {
  const made = document.createElement(head ? "th" : "td");
  if (head) made.scope = row.parentElement?.tagName === "THEAD" ? "col" : "row";
  made.textContent = words;
  made.className = kind;
  if (kind === "apart") made.title = "The intervals of now and before have nothing in common.";
  if (below) {
    const small = document.createElement("small");
    small.textContent = below;
    made.append(" ", small);
  }
  row.append(made);
}

/** Fill the table. @param {{now: Estimate, before: Estimate, watched: Estimate}} told */
export function showOutcomes({ now, before, watched }) {
  const table = part("outcomes", HTMLTableElement);
  const state = part("outcomes-state", HTMLElement);
  const [head, body] = [document.createElement("thead"), document.createElement("tbody")];
  const top = head.insertRow();
  const count = (/** @type {Estimate} */ each) => (each.trials ?? 0).toLocaleString("en");
  cell(top, ["mean", "± 95 %"], true);
  cell(top, now.trials ? ["now", count(now)] : ["now"], true);
  cell(top, before.trials ? ["before", count(before)] : ["before"], true);
  cell(top, ["watched", count(watched)], true);
  const names = Object.keys({ ...now.rows, ...(now.rows ? {} : before.rows) });
  for (const name of names) {
    const [words, unit, times] = NAMES[name] ?? [name, "", 1];
    const row = body.insertRow();
    cell(row, [unit ? `${words} [${unit}]` : words], true);
    cell(row, estimate(now.rows?.[name], times), false, apart(now.rows?.[name], before.rows?.[name]) ? "apart" : "");
    cell(row, estimate(before.rows?.[name], times));
    cell(row, estimate(watched.rows?.[name], times));
  }
  table.replaceChildren(head, body);
  table.hidden = !names.length;
  const seconds = number(now.seconds ?? 0, 2);
  if (now.refused) state.textContent = `No trials in the background: ${now.refused}`;
  else if (now.trials) state.textContent = `${count(now)} trials with these numbers in ${seconds} s`;
  else state.textContent = "Trials with these numbers are running…";
}
