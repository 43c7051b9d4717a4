/** Scene: one recording, ready to be drawn at any time. */

import { CROWDED, drawAgents, pixelOf } from "./agents.js";
import { Flat, Orbit } from "./camera.js";
import { drawFlashes, drawMarks } from "./events.js";
import { drawGround } from "./ground.js";
import { Coverage, drawLooked, drawOverlays } from "./overlays.js";
import { Paths } from "./paths.js";
import { Ribbons, Shapes } from "./shapes.js";
import { drawTrails } from "./trails.js";

/** @typedef {import("./decode.js").Recording} Recording */

/** @typedef {import("./ground.js").View} View @typedef {import("./camera.js").Rect} Rect */

/** How far from the world agents may stray and still be fitted [share of its size]: less where space is shared. */
const STRAY = 0.5,
  STRAY_TOGETHER = 0.08;

/** Past the last tick flashes go on for so many ticks: a second of a film. */
export const HOLD = 10;

/** @param {Recording} recording @param {number} stray @returns {import("./camera.js").Extent} all that moves, and the world */
function extentOf(recording, stray) {
  const { size, heights, boundary, prey, predators } = recording.header;
  const { dim, position, end, count } = recording;
  const [low, high] = [[0, 0], [size[0], size[1]]];
  if (boundary !== "periodic") {
    const radius = Math.max(prey.radius, predators.radius);
    for (let row = 0; row < position.length / dim; row++) {
      if (end[row % count] <= Math.floor(row / count)) continue;
      for (let axis = 0; axis < 2; axis++) {
        const place = position[row * dim + axis];
        low[axis] = Math.max(Math.min(low[axis], place - radius), -stray * size[axis]);
        high[axis] = Math.min(Math.max(high[axis], place + radius), (1 + stray) * size[axis]);
      }
    }
  }
  return dim > 2 ? { low: [...low, heights[0]], high: [...high, heights[1]] } : { low, high };
}

/** Share of a recording that the prey's centre may be outside an open world before the camera goes with it, as in films. */
const LEFT = 0.2;

/**
 * Give the mean place of the prey that are there, the one before where none is.
 * @param {Float32Array} spots [agent, dim] @param {number} dim @param {(agent: number) => boolean} there
 * @param {number} count @param {number[]} before
 */
function centreOf(spots, dim, there, count, before) {
  const sum = new Array(dim).fill(0);
  let found = 0;
  for (let agent = 0; agent < count; agent++) {
    if (!there(agent)) continue;
    found += 1;
    for (let axis = 0; axis < dim; axis++) sum[axis] += spots[agent * dim + axis];
  }
  return found ? sum.map((each) => each / found) : before;
}

/** Tell whether prey wander off for good through an open world in which nothing keeps them. @param {Recording} r */
function wandersOff(r) {
  const { sky, boundary, size } = r.header;
  if (!sky || boundary !== "open" || r.dim > 2) return false;
  let away = 0;
  for (let tick = 0; tick <= r.ticks; tick++) {
    const spots = r.position.subarray(tick * r.count * r.dim);
    const [x, y] = centreOf(spots, r.dim, (agent) => r.there(agent, tick), r.prey, [0, 0]);
    if (x < 0 || y < 0 || x > size[0] || y > size[1]) away += 1;
  }
  return away / (r.ticks + 1) > LEFT;
}

/** A recording with its camera. */
export class Scene {
  /**
   * @param {Recording} recording @param {Recording[]} [together] all that are shown side by side, at one scale
   * @param {Paths} [paths]
   */
  constructor(recording, together = [recording], paths = new Paths(recording)) {
    this.recording = recording;
    this.paths = paths;
    /** Agents too many to be drawn one by one. @type {import("./cloud.js").Cloud | null} */
    this.cloud = null;
    /** Whether the camera goes with the prey, until somebody drags it elsewhere. */
    this.roams = wandersOff(recording);
    this.held = false;
    const stray = (/** @type {Recording} */ each) => (wandersOff(each) ? 0 : together.length > 1 ? STRAY_TOGETHER : STRAY);
    const extents = together.map((each) => extentOf(each, stray(each)));
    const extent = {
      low: extents[0].low.map((_, axis) => Math.min(...extents.map(({ low }) => low[axis]))),
      high: extents[0].high.map((_, axis) => Math.max(...extents.map(({ high }) => high[axis]))),
    };
    this.lens = recording.dim > 2 ? new Orbit(extent) : new Flat(extent);
    this.below = new Shapes();
    this.above = new Shapes();
    this.ribbons = new Ribbons();
    /** @type {Coverage | null} */
    this.coverage = null;
    /** The window on the screen. @type {Rect} */
    this.rect = { x: 0, y: 0, width: 1, height: 1 };
    /** Where shapes are seen again, in a periodic world: shifts [px]. @type {number[][]} */
    this.images = [[0, 0]];
    /** What may be drawn on: the world alone where it is periodic. @type {Rect} */
    this.clip = this.rect;
    /** @type {View | null} */
    this.view = null;
  }

  /**
   * Fill the layers for a time.
   * @param {number} time
   * @param {{theme: import("./shapes.js").Palette, unit: number, switches: Set<string>, looked: number, hues: string[]}} look
   */
  frame(time, { theme, unit, switches, looked, hues }) {
    const { recording, paths, lens, below, above, ribbons } = this;
    for (const layer of [below, above, ribbons]) layer.clear();
    paths.load(time);
    if (this.roams && !this.held) {
      const { dim, prey } = recording;
      lens.follow(centreOf(paths.spot, dim, (agent) => paths.seen(agent, time), prey, lens.centre));
    }
    lens.fit(this.rect);
    /** @type {View} */
    const view = { recording, paths, lens, unit, time, theme, below, ribbons, above, switches, roams: this.roams };
    this.view = view;
    this._wrap();
    drawGround(view);
    this.cloud?.load(view);
    if (switches.has("coverage")) this.coverage ??= new Coverage(recording);
    drawOverlays(view, this.coverage);
    drawMarks(view);
    if (switches.has("trails")) drawTrails(view);
    drawAgents(view);
    drawFlashes(view);
    if (looked >= 0 && looked < recording.count) drawLooked(view, looked, hues);
  }

  /** Find where the images of a periodic world are seen. */
  _wrap() {
    const { lens, recording, rect } = this;
    this.images = [[0, 0]];
    this.clip = rect;
    if (lens.deep || recording.header.boundary !== "periodic") return;
    const [width, height] = recording.header.size;
    lens.place(0, height);
    const [x0, y0] = [Math.max(lens.x, rect.x), Math.max(lens.y, rect.y)];
    lens.place(width, 0);
    const [x1, y1] = [Math.min(lens.x, rect.x + rect.width), Math.min(lens.y, rect.y + rect.height)];
    this.clip = { x: x0, y: y0, width: Math.max(x1 - x0, 0), height: Math.max(y1 - y0, 0) };
    if (recording.count > CROWDED) return;
    for (const x of [-1, 0, 1]) {
      for (const y of [-1, 0, 1]) if (x || y) this.images.push([x * width * lens.scale, y * height * lens.scale]);
    }
  }

  /**
   * Find the agent at a pixel, -1 for none.
   * @param {number} x @param {number} y @param {number} within pixels @param {number} time
   */
  pick(x, y, within, time) {
    let [found, nearest] = [-1, within];
    if (!this.view) return found;
    for (let agent = 0; agent < this.recording.count; agent++) {
      if (!this.paths.seen(agent, time)) continue;
      const [px, py] = pixelOf(this.view, agent);
      const away = Math.hypot(px - x, py - y);
      if (away < nearest) [found, nearest] = [agent, away];
    }
    return found;
  }
}
