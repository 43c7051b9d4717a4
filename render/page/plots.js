/** Plots: what was measured, tick by tick, under the same clock. */

import { tally } from "./agents.js";
import { FATES } from "./decode.js";

/** @typedef {import("./decode.js").Recording} Recording */

/**
 * @typedef {{name: string, unit: string, digits: number,
 *   lines: {rows: Float32Array, hue: string, dash: number[], name: string}[],
 *   top: number, bottom: number, canvas: HTMLCanvasElement, said: HTMLElement}} Plot
 */

/** Names and units of measures. @type {Record<string, [string, string, number]>} */
const MEASURES = {
  polarisation: ["Polarisation", "", 2],
  nearest: ["Nearest neighbour", "m", 2],
  kinetic: ["Kinetic energy", "m²/s²", 2],
  potential: ["Potential energy", "m²/s²", 1],
  coverage: ["Coverage", "%", 1],
};

const DASHES = [[], [6, 4], [2, 3], [9, 3, 2, 3]];

/** @param {Recording} recording @returns {Float32Array[]} how many prey had each fate at each tick */
function counts(recording) {
  const rows = FATES.map(() => new Float32Array(recording.ticks + 1));
  for (let tick = 0; tick <= recording.ticks; tick++) {
    tally(recording, tick).forEach((count, fate) => (rows[fate][tick] = count));
  }
  return rows;
}

export class Plots {
  /**
   * @param {HTMLElement} place @param {Recording[]} recordings @param {number} last
   * @param {(tick: number) => void} seek called with the tick that is pointed at
   */
  constructor(place, recordings, last, seek) {
    this.place = place;
    this.last = Math.max(last, 1);
    this.seek = seek;
    /** @type {Plot[]} */
    this.plots = [];
    if (!recordings.length) return;
    const fates = recordings.map(counts);
    const hues = ["prey", "arrived", "captured", "crashed"];
    this._plot(
      "Prey",
      "alive",
      0,
      FATES.flatMap((name, fate) =>
        fates
          .filter((rows) => fate === 0 || rows[fate].some((count) => count > 0))
          .map((rows) => ({ rows: rows[fate], hue: hues[fate], dash: DASHES[fates.indexOf(rows)], name })),
      ),
    );
    for (const [key, [name, unit, digits]] of Object.entries(MEASURES)) {
      const lines = recordings.flatMap((recording, n) => {
        const rows = recording.measures.get(key);
        if (!rows) return [];
        const shown = key === "coverage" ? rows.map((share) => 100 * share) : rows;
        return [{ rows: shown, hue: "ink", dash: DASHES[n], name: recording.header.label }];
      });
      if (lines.some(({ rows }) => rows.some(Number.isFinite))) this._plot(name, unit, digits, lines);
    }
  }

  /** @param {string} name @param {string} unit @param {number} digits @param {Plot["lines"]} lines */
  _plot(name, unit, digits, lines) {
    const box = document.createElement("figure");
    const head = document.createElement("figcaption");
    const title = document.createElement("span");
    const said = document.createElement("output");
    const canvas = document.createElement("canvas");
    title.textContent = name;
    canvas.setAttribute("role", "img");
    head.append(title, said);
    box.append(head, canvas);
    this.place.append(box);
    let [bottom, top] = [Infinity, -Infinity];
    for (const { rows } of lines) {
      for (const value of rows) {
        if (!Number.isFinite(value)) continue;
        bottom = Math.min(bottom, value);
        top = Math.max(top, value);
      }
    }
    if (bottom >= 0) bottom = 0;
    if (name === "Polarisation") top = 1;
    const plot = { name, unit, digits, lines, top: top > bottom ? top : bottom + 1, bottom, canvas, said };
    this.plots.push(plot);
    const point = (/** @type {PointerEvent} */ event) => {
      const box = canvas.getBoundingClientRect();
      this.seek(Math.round(((event.clientX - box.left) / box.width) * this.last));
    };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      point(event);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (event.buttons) point(event);
    });
  }

  /** Draw all plots. @param {number} time @param {import("./shapes.js").Palette} theme */
  draw(time, theme) {
    for (const plot of this.plots) this._draw(plot, Math.min(time, this.last), theme);
  }

  /** @param {Plot} plot @param {number} time @param {import("./shapes.js").Palette} theme */
  _draw({ name, unit, digits, lines, top, bottom, canvas, said }, time, theme) {
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
    if (!width || !height) return;
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    const pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
    pen.clearRect(0, 0, width, height);
    const pad = 3 * ratio;
    const x = (/** @type {number} */ tick) => (tick / this.last) * width;
    const y = (/** @type {number} */ value) => height - pad - ((value - bottom) / (top - bottom)) * (height - 2 * pad);
    pen.strokeStyle = theme.line;
    pen.globalAlpha = 0.25;
    pen.lineWidth = ratio;
    pen.beginPath();
    for (const level of [bottom, top]) {
      pen.moveTo(0, y(level));
      pen.lineTo(width, y(level));
    }
    pen.stroke();
    pen.globalAlpha = 1;
    for (const { rows, hue, dash } of lines) {
      pen.strokeStyle = hue === "prey" ? theme.prey[0] : theme[hue];
      pen.setLineDash(dash.map((each) => each * ratio));
      pen.lineWidth = 1.6 * ratio;
      pen.beginPath();
      let open = false;
      for (let tick = 0; tick < rows.length; tick++) {
        if (!Number.isFinite(rows[tick])) {
          open = false;
          continue;
        }
        if (open) pen.lineTo(x(tick), y(rows[tick]));
        else pen.moveTo(x(tick), y(rows[tick]));
        open = true;
      }
      pen.stroke();
    }
    pen.setLineDash([]);
    pen.strokeStyle = theme.ink;
    pen.lineWidth = 1.2 * ratio;
    pen.beginPath();
    pen.moveTo(x(time), 0);
    pen.lineTo(x(time), height);
    pen.stroke();
    const tick = Math.floor(time);
    const values = lines.map(({ rows }) => rows[Math.min(tick, rows.length - 1)]);
    const here = name === "Prey" ? values.slice(0, lines.filter((line) => line.name === FATES[0]).length) : values;
    const words = here.map((each) => number(each, digits)).join(" | ");
    said.textContent = unit && /\d/.test(words) ? `${words} ${unit}` : words;
    canvas.setAttribute("aria-label", `${name} at tick ${tick}: ${said.textContent}`);
  }
}

/** Write a number, a dash for none. @param {number} value @param {number} digits */
export function number(value, digits) {
  if (!Number.isFinite(value)) return "–";
  return value.toFixed(digits).replace(/^-/, "−");
}
