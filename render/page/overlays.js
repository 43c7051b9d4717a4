/**
 * Overlays: what agents see, whom they flock with, how the avoidance pushes, which ground is swept, why one moves as it does.
 */

import { hueOf, pixelOf, reachOf } from "./agents.js";
import { Orbit } from "./camera.js";
import { colour, mixed } from "./shapes.js";

/** @typedef {import("./decode.js").Recording} Recording */

/** @typedef {import("./ground.js").View} View @typedef {import("./shapes.js").Colour} Colour */

/** With more prey than this, links would cover everything. */
const LINKED = 400;

/** Cells along the world's longer side; swept ground shines for about FRESH ticks. */
const FINE = 320,
  FRESH = 8;

/** Colours of terms, told apart by colour-blind people (after Okabe and Ito), for dark and for light grounds. */
export const TERM_HUES = {
  dark: ["#56b4e9", "#e69f00", "#2fc79b", "#f0e442", "#cc79a7", "#ff7f3f", "#b3a2ff", "#c8c8c8"],
  light: ["#0072b2", "#a86f00", "#00795a", "#857900", "#a64f80", "#c04a00", "#5b46c4", "#5f5f5f"],
};

/** The longest of an agent's arrows [units of type]. */
const ARROW = 74;

/** Draw what lies under the agents. @param {View} view @param {Coverage | null} coverage */
export function drawOverlays(view, coverage) {
  const { switches } = view;
  if (coverage && switches.has("coverage")) coverage.draw(view);
  if (switches.has("field")) field(view);
  if (switches.has("perception")) {
    for (let agent = 0; agent < view.recording.count; agent++) sight(view, agent, 0.28);
  }
  if (switches.has("links")) links(view);
}

/** Straight pieces of the edge of a field of view. */
const ARC = 48;

/**
 * Circle what an agent perceives; of one that sees nobody behind it, in a flat world, a sector.
 * @param {View} view @param {number} agent @param {number} alpha
 */
function sight(view, agent, alpha) {
  const { recording, paths, time, lens, below, unit } = view;
  if (!paths.seen(agent, time)) return;
  const [x, y] = pixelOf(view, agent);
  const { perception, view: degrees } = recording.kind(agent);
  const [reach, hue] = [perception * lens.scale * lens.near, hueOf(view, agent)];
  if (degrees >= 360 || recording.dim > 2) {
    below.ring(x, y, reach, 1.1 * unit, hue, alpha);
    return;
  }
  const at = (paths.tick(time) * recording.count + agent) * 2;
  const [across, up] = [recording.velocity[at], recording.velocity[at + 1]];
  const edge = [[x, y]];
  for (let k = 0; k <= ARC; k++) {
    const angle = Math.atan2(-up, across) + (degrees * (k / ARC - 0.5) * Math.PI) / 180;
    edge.push([x + reach * Math.cos(angle), y + reach * Math.sin(angle)]);
  }
  edge.push([x, y]);
  for (let k = 1; k < edge.length; k++) {
    below.capsule(edge[k - 1][0], edge[k - 1][1], edge[k][0], edge[k][1], 0.55 * unit, 0.55 * unit, hue, alpha);
  }
}

/**
 * Give the mates that an agent heeds as neighbours: in view, within perception, among the nearest, in its own sub-swarm.
 * @param {Recording} r @param {number} agent @param {number} tick
 */
export function neighbours(r, agent, tick) {
  const { dim } = r;
  const row = tick * r.count;
  const [first, last] = agent < r.prey ? [0, r.prey] : [r.prey, r.count];
  const { perception: reach, view: degrees, nearest } = r.kind(agent);
  const motion = r.velocity.subarray((row + agent) * dim, (row + agent + 1) * dim);
  const least = Math.cos((degrees * Math.PI) / 360) * Math.hypot(...motion);
  /** @type {{other: number, distance2: number}[]} */
  const found = [];
  for (let other = first; other < last; other++) {
    if (other === agent || !r.there(other, tick) || r.group[row + other] !== r.group[row + agent]) continue;
    let [distance2, ahead] = [0, 0];
    for (let axis = 0; axis < dim; axis++) {
      const [a, b] = [(row + agent) * dim + axis, (row + other) * dim + axis];
      const way = r.shortest(r.position[b] - r.position[a], axis);
      distance2 += way ** 2;
      ahead += way * motion[axis];
    }
    const inView = degrees >= 360 || ahead >= least * Math.sqrt(distance2);
    if (inView && distance2 < reach ** 2) found.push({ other, distance2 });
  }
  if (nearest !== null && nearest < found.length) {
    const last = found.map((each) => each.distance2).sort((a, b) => a - b)[nearest - 1];
    return found.filter((each) => each.distance2 <= last).map((each) => each.other);
  }
  return found.map((each) => each.other);
}

/** Join prey that are neighbours. @param {View} view */
function links(view) {
  const { recording: r, paths, time, lens, below, theme, unit } = view;
  if (r.prey > LINKED) return;
  const hue = mixed(colour(theme.prey[0]), colour(theme.ink), 0.3);
  const sight = r.header.prey.perception;
  for (let a = 0; a < r.prey; a++) {
    if (!paths.seen(a, time)) continue;
    for (const b of neighbours(r, a, paths.tick(time))) {
      const gap = (/** @type {number} */ n) => paths.spot[b * r.dim + n] - paths.spot[a * r.dim + n];
      const step = Array.from({ length: r.dim }, (_, n) => r.shortest(gap(n), n));
      // Each of the two draws its own half of the way: across an edge of a periodic world it is seen on both sides.
      const half = step.map((way, n) => paths.spot[a * r.dim + n] + way / 2);
      const [x, y] = pixelOf(view, a);
      lens.place(half[0], half[1], half[2]);
      const alpha = 0.08 + 0.5 * Math.max(1 - Math.hypot(...step) / sight, 0);
      below.capsule(x, y, lens.x, lens.y, 0.7 * unit, 0.7 * unit, hue, alpha);
    }
  }
}

/** Draw the avoidance's field: the longest arrow is as long as points are apart. @param {View} view */
function field({ recording, lens, below, theme, unit }) {
  const rows = recording.field;
  const count = rows.length / 4;
  let [strongest, apart] = [0, Infinity];
  for (let n = 0; n < count; n++) strongest = Math.max(strongest, Math.hypot(rows[n * 4 + 2], rows[n * 4 + 3]));
  for (let n = 1; n < count; n++) {
    const gap = Math.hypot(rows[n * 4] - rows[0], rows[n * 4 + 1] - rows[1]);
    if (gap > 0) apart = Math.min(apart, gap);
  }
  const hue = mixed(colour(theme.quiet), colour(theme.ink), 0.4);
  for (let n = 0; n < count; n++) {
    const [x, y, ax, ay] = rows.subarray(n * 4, n * 4 + 4);
    const share = Math.sqrt(Math.hypot(ax, ay) / strongest);
    if (!(share > 0.1)) continue;
    lens.place(x, y);
    lens.turn(x, y, 0, ax, ay);
    const reach = (0.85 * apart * lens.scale * share) / 2;
    const [dx, dy] = [lens.hx * reach, lens.hy * reach];
    arrow(below, lens.x - dx, lens.y - dy, lens.x + dx, lens.y + dy, 0.7 * unit, hue, 0.25 + 0.6 * share);
  }
}

/**
 * @param {import("./shapes.js").Shapes} shapes @param {number} ax @param {number} ay @param {number} bx @param {number} by
 * @param {number} half @param {Colour} hue @param {number} [alpha]
 */
function arrow(shapes, ax, ay, bx, by, half, hue, alpha = 1) {
  const long = Math.hypot(bx - ax, by - ay);
  if (long < 0.5) return;
  const [hx, hy] = [(bx - ax) / long, (by - ay) / long];
  const barb = Math.min(0.3 * long, 9 * half);
  shapes.capsule(ax, ay, bx, by, half, half, hue, alpha);
  for (const side of [1, -1]) {
    const [cx, cy] = [bx - barb * (hx - side * 0.6 * hy), by - barb * (hy + side * 0.6 * hx)];
    shapes.capsule(cx, cy, bx, by, half, half, hue, alpha);
  }
}

/** What an agent's terms were in the move out of a tick: [name, vector], and their sum; null where none were recorded.
 * @param {Recording} r @param {number} agent @param {number} tick */
export function termsOf(r, agent, tick) {
  if (!r.kind(agent).terms.length || !(tick + 1 < Math.min(r.end[agent], r.ticks + 1))) return null;
  const at = (tick * r.count + agent) * r.dim;
  const way = (/** @type {string} */ name) => Array.from(r.terms.get(name)?.subarray(at, at + r.dim) ?? []);
  const parts = r.kind(agent).terms.map((name) => ({ name, way: way(name) }));
  const sum = Array.from({ length: r.dim }, (_, axis) => parts.reduce((total, { way }) => total + way[axis], 0));
  return { parts, sum };
}

/**
 * Show what is looked at: rings, perception, and arrows of terms, tip to tail.
 * @param {View} view @param {number} agent @param {string[]} hues
 */
export function drawLooked(view, agent, hues) {
  const { recording: r, paths, time, lens, above, theme, unit } = view;
  const [x, y] = pixelOf(view, agent);
  const size = reachOf(view, agent) * (lens instanceof Orbit ? lens.near : 1);
  above.ring(x, y, size * 2.3 + 3 * unit, 1.6 * unit, colour(theme.ink), 0.95);
  if (!paths.seen(agent, time)) return;
  sight(view, agent, 0.6);
  for (const mate of neighbours(r, agent, paths.tick(time)).slice(0, 200)) {
    const [mx, my] = pixelOf(view, mate);
    above.ring(mx, my, size * 1.9, 1 * unit, colour(theme.ink), 0.45);
  }
  const terms = termsOf(r, agent, paths.tick(time));
  if (!terms) return;
  const longest = Math.max(...terms.parts.map(({ way }) => Math.hypot(...way)), Math.hypot(...terms.sum));
  if (!(longest > 0)) return;
  const scale = Math.max(ARROW * unit, 4 * size) / longest;
  const screen = (/** @type {number[]} */ way) => (lens instanceof Orbit ? tilted(lens, way) : [way[0], -way[1]]);
  let [tx, ty] = [x, y];
  terms.parts.forEach(({ name, way }, n) => {
    const [dx, dy] = screen(way).map((each) => each * scale);
    if (name === "cap") {
      // The cap takes back what others gave: beside their arrows, it does not hide them.
      const aside = (5 * unit) / Math.max(Math.hypot(dx, dy), 1e-9);
      [tx, ty] = [tx - dy * aside, ty + dx * aside];
    }
    arrow(above, tx, ty, tx + dx, ty + dy, 2.9 * unit, colour(theme.outline), 0.75);
    arrow(above, tx, ty, tx + dx, ty + dy, 1.7 * unit, colour(hues[n % hues.length]));
    [tx, ty] = [tx + dx, ty + dy];
  });
  const [dx, dy] = screen(terms.sum).map((each) => each * scale);
  arrow(above, x, y, x + dx, y + dy, 1.1 * unit, colour(theme.ink), 0.95);
}

/** @param {Orbit} lens @param {number[]} way */
function tilted(lens, [x, y, z]) {
  const a = lens.axes ?? [];
  return [a[0] * x + a[1] * y + a[2] * z, -(a[3] * x + a[4] * y + a[5] * z)];
}

/** Ground that prey have been to, brightest where they have just been. */
export class Coverage {
  /** @param {Recording} recording */
  constructor(recording) {
    const { size, swept, prey } = recording.header;
    this.edge = Math.max(size[0], size[1]) / FINE;
    this.across = Math.ceil(size[0] / this.edge);
    this.up = Math.ceil(size[1] / this.edge);
    this.first = new Float32Array(this.across * this.up).fill(Infinity);
    const reach = Math.max(swept ? swept.tool : prey.radius, 0.71 * this.edge);
    for (let agent = 0; agent < recording.prey; agent++) this._sweep(recording, agent, reach);
  }

  /** @param {Recording} r @param {number} agent @param {number} reach */
  _sweep(r, agent, reach) {
    const last = Math.min(r.end[agent] - 1, r.ticks);
    let [px, py] = [0, 0];
    for (let tick = 0; tick <= last; tick++) {
      const at = (tick * r.count + agent) * r.dim;
      const [x, y] = [r.position[at], r.position[at + 1]];
      if (tick === 0) [px, py] = [x, y];
      const [dx, dy] = [r.shortest(x - px, 0), r.shortest(y - py, 1)];
      const steps = Math.max(Math.ceil(Math.max(Math.abs(dx), Math.abs(dy)) / this.edge), 1);
      for (let n = 1; n <= steps; n++) {
        const left = 1 - n / steps;
        this._disc(x - dx * left, y - dy * left, reach, tick === 0 ? 0 : tick - left);
      }
      [px, py] = [x, y];
    }
  }

  /** @param {number} x @param {number} y @param {number} reach @param {number} when */
  _disc(x, y, reach, when) {
    const { edge } = this;
    const first = (/** @type {number} */ place) => Math.max(Math.floor((place - reach) / edge), 0);
    const last = (/** @type {number} */ place, /** @type {number} */ count) =>
      Math.min(Math.floor((place + reach) / edge), count - 1);
    const [low, high, left, right] = [first(y), last(y, this.up), first(x), last(x, this.across)];
    for (let row = low; row <= high; row++) {
      for (let column = left; column <= right; column++) {
        const cell = row * this.across + column;
        const away = Math.hypot((column + 0.5) * edge - x, (row + 0.5) * edge - y);
        if (away <= reach && when < this.first[cell]) this.first[cell] = when;
      }
    }
  }

  /** Draw the swept cells; those that shine no more in whole rows. @param {View} view */
  draw({ lens, below, theme, time }) {
    if (lens.deep) return;
    const hue = colour(theme.arrived);
    /** @type {(column: number, row: number, run: number, alpha: number) => void} */
    const cell = (column, row, run, alpha) => {
      lens.place(column * this.edge, (row + 1) * this.edge);
      const [x0, y0] = [Math.round(lens.x), Math.round(lens.y)];
      lens.place((column + run) * this.edge, row * this.edge);
      below.box(x0, y0, Math.round(lens.x), Math.round(lens.y), hue, { alpha });
    };
    for (let row = 0; row < this.up; row++) {
      let run = 0;
      for (let column = 0; column <= this.across; column++) {
        const age = column < this.across ? time - this.first[row * this.across + column] : -1;
        if (age >= 4 * FRESH) {
          run += 1;
          continue;
        }
        if (run) cell(column - run, row, run, theme.cleaned_alpha);
        run = 0;
        if (age >= 0) cell(column, row, 1, theme.cleaned_alpha + 0.3 * Math.exp(-age / FRESH));
      }
    }
  }
}
