/** Paths: where agents are between ticks, on the cubic Hermite curves that the films draw. */

import { CAPTURED } from "./decode.js";

/** @typedef {import("./decode.js").Recording} Recording */

/** The paths of all agents of a recording, continuous in time. Times are ticks since the start, lengths metres. */
export class Paths {
  /** @param {Recording} recording */
  constructor(recording) {
    this.recording = recording;
    const { count, dim, ticks } = recording;
    /** Where each agent is at the loaded time, and how it moves [m/tick]; those who are gone stay where they went. */
    this.spot = new Float32Array(count * dim);
    this.slope = new Float32Array(count * dim);
    /** When and where each comes to rest. */
    this._from = Float64Array.from(recording.end, (end) => Math.min(end, ticks));
    this._ahead = new Float32Array(count * dim);
    this._coming = new Float32Array(count * dim);
    this.time = NaN;
    for (let agent = 0; agent < count; agent++) if (recording.end[agent] <= ticks) this._letGo(agent);
    for (let agent = 0; agent < recording.prey; agent++) this._meet(agent);
  }

  /** Whoever dies or arrives goes to where that was judged; where that is not known, on as it moved. @param {number} agent */
  _letGo(agent) {
    const { recording: r } = this;
    const before = Math.max(r.end[agent] - 1, 0);
    for (let axis = 0; axis < r.dim; axis++) {
      const row = (before * r.count + agent) * r.dim + axis;
      const known = r.judged[agent];
      const step = known ? r.shortest(known[axis] - r.position[row], axis) : r.velocity[row] * r.dt;
      this._ahead[agent * r.dim + axis] = r.position[row] + step;
      this._coming[agent * r.dim + axis] = step;
    }
  }

  /** Let captor and captive of one tick, if near enough to have touched, end at the point between them. @param {number} prey */
  _meet(prey) {
    const { recording: r, _ahead: ahead } = this;
    if (r.judged[prey] || r.fate[prey] !== CAPTURED || !(r.end[prey] <= r.ticks)) return;
    let nearest = r.header.prey.radius + r.header.predators.radius + this._length(prey);
    let captor = -1;
    for (let other = r.prey; other < r.count; other++) {
      if (r.fate[other] !== CAPTURED || r.end[other] !== r.end[prey]) continue;
      const gap = Math.hypot(...this._between(prey, other)) - this._length(other);
      if (gap < nearest) [nearest, captor] = [gap, other];
    }
    if (captor < 0) return;
    const half = this._between(prey, captor).map((way) => way / 2);
    const before = Math.max(r.end[prey] - 1, 0);
    half.forEach((way, axis) => {
      ahead[prey * r.dim + axis] += way;
      ahead[captor * r.dim + axis] -= way;
      for (const agent of [prey, captor]) {
        const n = agent * r.dim + axis;
        this._coming[n] = ahead[n] - r.position[before * r.count * r.dim + n];
      }
    });
  }

  /** @param {number} a @param {number} b @returns {number[]} */
  _between(a, b) {
    const { dim } = this.recording;
    return Array.from({ length: dim }, (_, axis) =>
      this.recording.shortest(this._ahead[b * dim + axis] - this._ahead[a * dim + axis], axis),
    );
  }

  /** @param {number} agent */
  _length(agent) {
    const { dim } = this.recording;
    return Math.hypot(...this._coming.subarray(agent * dim, (agent + 1) * dim));
  }

  /** Load a time: fill `spot` and `slope`. @param {number} time */
  load(time) {
    if (time === this.time) return;
    this.time = time;
    const { count } = this.recording;
    for (let agent = 0; agent < count; agent++) this.at(agent, time, this.spot, this.slope, agent);
  }

  /**
   * Give one agent's place, and how it moves [m/tick], at a time.
   * @param {number} agent @param {number} time
   * @param {Float32Array} spot @param {Float32Array | null} slope @param {number} row where in them
   */
  at(agent, time, spot, slope, row) {
    const { recording: r } = this;
    const { dim, count } = r;
    const now = Math.min(Math.max(time, 0), this._from[agent]);
    const ends = r.end[agent] <= r.ticks;
    const tick = Math.min(Math.floor(now), Math.max(this._from[agent] - 1, 0));
    const f = now - tick;
    const a = (tick * count + agent) * dim;
    const last = ends && tick + 1 >= r.end[agent];
    const still = r.ticks === 0 || this._from[agent] === 0;
    for (let axis = 0; axis < dim; axis++) {
      const here = r.position[a + axis];
      const leaving = r.velocity[a + axis] * r.dt;
      if (still) {
        spot[row * dim + axis] = here;
        if (slope) slope[row * dim + axis] = leaving;
        continue;
      }
      const b = a + count * dim + axis;
      const ahead = last ? this._ahead[agent * dim + axis] : r.position[b];
      const coming = last ? this._coming[agent * dim + axis] : r.velocity[b] * r.dt;
      const chord = r.shortest(ahead - here, axis);
      const bend = 3 * chord - 2 * leaving - coming;
      const twist = leaving + coming - 2 * chord;
      spot[row * dim + axis] = this._within(here + f * (leaving + f * (bend + f * twist)), axis);
      if (slope) slope[row * dim + axis] = leaving + f * (2 * bend + 3 * f * twist);
    }
  }

  /** Bring a place back into a periodic world. @param {number} place @param {number} axis */
  _within(place, axis) {
    if (this.recording.header.boundary !== "periodic") return place;
    const size = this.recording.header.size[axis];
    return place - size * Math.floor(place / size);
  }

  /** Tell whether an agent can be seen at a time. @param {number} agent @param {number} time */
  seen(agent, time) {
    return time < this.recording.end[agent];
  }

  /** Give the tick whose state holds at a time. @param {number} time */
  tick(time) {
    return Math.min(Math.max(Math.floor(time), 0), this.recording.ticks);
  }
}
