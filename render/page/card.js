/** Card: what is known of one agent at one tick, and what each term adds to its velocity. */

import { FATES } from "./decode.js";
import { neighbours, termsOf } from "./overlays.js";
import { number } from "./plots.js";

/** @typedef {import("./decode.js").Recording} Recording */

/** @param {ArrayLike<number>} way @param {number} digits */
function vector(way, digits) {
  return Array.from(way, (each) => number(each, digits)).join(", ");
}

/** @param {HTMLTableElement} table @param {string[]} words @param {string} [hue] */
function row(table, words, hue) {
  const line = table.insertRow();
  words.forEach((word, n) => {
    const cell = document.createElement(n === 0 ? "th" : "td");
    if (n === 0) cell.scope = "row";
    if (n === 0 && hue) {
      const swatch = document.createElement("i");
      swatch.style.background = hue;
      cell.append(swatch);
    }
    cell.append(word);
    line.append(cell);
  });
  return line;
}

/**
 * Fill a card for an agent at a tick.
 * @param {HTMLElement} card @param {Recording} r @param {number} agent @param {number} tick @param {string[]} hues of terms
 */
export function fillCard(card, r, agent, tick, hues) {
  const title = document.createElement("h3");
  title.textContent = r.name(agent);
  const state = document.createElement("span");
  const gone = !r.there(agent, tick);
  const group = r.group[tick * r.count + agent];
  const called = gone ? `${FATES[r.fate[agent]]} at tick ${r.end[agent]}` : r.states[r.state[tick * r.count + agent]];
  state.textContent = group >= 0 && !gone ? `${called}, ${agent < r.prey ? "sub-swarm" : "chases cluster"} ${group}` : called;
  title.append(state);
  const facts = document.createElement("table");
  card.replaceChildren(title, facts);
  if (gone) return;
  const at = (tick * r.count + agent) * r.dim;
  const [place, way] = [r.position.subarray(at, at + r.dim), r.velocity.subarray(at, at + r.dim)];
  row(facts, ["position", `${vector(place, 2)} m`]);
  row(facts, ["velocity", `${vector(way, 3)} m/s`]);
  row(facts, ["speed", `${number(Math.hypot(...way), 3)} m/s`]);
  row(facts, ["neighbours", String(neighbours(r, agent, tick).length)]);
  const terms = termsOf(r, agent, tick);
  if (terms) {
    fillTerms(card, terms, hues);
  } else if (!r.kind(agent).terms.length && r.there(agent, tick + 1) && tick < r.ticks) {
    const next = r.velocity.subarray(at + r.count * r.dim, at + r.count * r.dim + r.dim);
    row(facts, ["next change", `${vector(next.map((each, n) => each - way[n]), 3)} m/s`]);
  }
}

/** @param {HTMLElement} card @param {NonNullable<ReturnType<typeof termsOf>>} terms @param {string[]} hues */
function fillTerms(card, { parts, sum }, hues) {
  const table = document.createElement("table");
  table.className = "terms";
  const caption = table.createCaption();
  caption.textContent = "adds to its velocity in this tick [m/s]";
  parts.forEach(({ name, way }, n) => {
    if (Math.hypot(...way) > 5e-6) row(table, [name, vector(way, 4), number(Math.hypot(...way), 4)], hues[n % hues.length]);
  });
  row(table, ["sum", vector(sum, 4), number(Math.hypot(...sum), 4)]).className = "sum";
  card.append(table);
}
