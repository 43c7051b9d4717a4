/** Window: the last ticks of a simulation that runs, as a recording that grows at its end and is forgotten at its start. */

import { Recording } from "./decode.js";
import { Paths } from "./paths.js";

/** @typedef {import("./decode.js").Header & {scene: number, states: string[], cloud: Box | null}} LiveHeader */

/** @typedef {{low: number[], high: number[], count: number}} Box what a cloud's numbers are shares of; how many agents */

/**
 * @typedef {{scene: number, tick: number, heard: number, ended: boolean, counts: number[], position: Float32Array,
 *   velocity: Float32Array, group: Int16Array, state: Uint8Array, fate: Uint8Array, cloud: Uint16Array}} Frame
 */

const FRAME_FORMAT = 1;

/** Whole numbers at the head of a frame. */
const FRAME_HEAD = 12;

/** Ticks that are kept: as long as trails are, and a little more to look back. */
const KEPT = 60;

/** Read a frame as `render/live/frame.py` writes it. @param {ArrayBuffer} bytes @returns {Frame} */
export function readFrame(bytes) {
  const [format, scene, tick, heard, ended, a, b, c, d, lone, cloud, dim] = new Uint32Array(bytes, 0, FRAME_HEAD);
  if (format !== FRAME_FORMAT) throw new Error(`this page reads frames of format ${FRAME_FORMAT}, not ${format}`);
  let at = FRAME_HEAD * 4;
  /** @template T @param {(at: number, length: number) => T} made @param {number} length @param {number} width @returns {T} */
  const next = (made, length, width) => {
    const found = made(at, length);
    at += length * width;
    return found;
  };
  const real = (/** @type {number} */ from, /** @type {number} */ length) => new Float32Array(bytes, from, length);
  const small = (/** @type {number} */ from, /** @type {number} */ length) => new Uint8Array(bytes, from, length);
  return {
    ...{ scene, tick, heard, ended: ended > 0, counts: [a, b, c, d] },
    position: next(real, lone * dim, 4),
    velocity: next(real, lone * dim, 4),
    group: next((from, length) => new Int16Array(bytes, from, length), lone, 2),
    cloud: next((from, length) => new Uint16Array(bytes, from, length), cloud * dim, 2),
    state: next(small, lone, 1),
    fate: next(small, lone, 1),
  };
}

/** The last ticks: row `ticks` is the newest. Whoever is gone has the place where it went in all rows behind its end. */
export class Window extends Recording {
  /** @param {LiveHeader} header */
  constructor(header) {
    const nothing = { states: [], terms: [], fate: [], end: [] };
    const told = { prey: { ...header.prey, ...nothing }, predators: { ...header.predators, ...nothing } };
    super({ ...header, ...told, ticks: KEPT, sections: {}, measures: [] }, new Uint8Array(0));
    this.live = header;
    this.states = header.states;
    this.end = new Float64Array(this.count).fill(Infinity);
    this.fate = new Uint8Array(this.count);
    this.counts = [header.prey.count, 0, 0, 0];
    this.ticks = -1;
    /** Ticks of the simulation between the last two rows. */
    this.gap = 1;
    /** The simulation's tick of each row. */
    this.when = new Int32Array(KEPT + 1);
  }

  _read() {
    // nothing is there yet
  }

  /**
   * Add a frame; a second one of the same tick takes the first one's place.
   * @param {Frame} frame @returns {number} rows forgotten
   */
  push(frame) {
    const { count, dim } = this;
    const again = this.ticks >= 0 && this.when[this.ticks] === frame.tick;
    const full = !again && this.ticks === KEPT;
    if (full) this._forget();
    else if (!again) this.ticks += 1;
    const row = this.ticks;
    this.gap = row > 0 ? Math.max(frame.tick - this.when[row - 1], 1) : 1;
    this.dt = this.header.dt * this.gap;
    this.when[row] = frame.tick;
    this.counts = frame.counts;
    const at = row * count;
    this.position.set(frame.position, at * dim);
    this.velocity.set(frame.velocity, at * dim);
    this.group.set(frame.group, at);
    this.state.set(frame.state, at);
    for (let agent = 0; agent < count; agent++) this._end(agent, frame.fate[agent], row);
    return full ? 1 : 0;
  }

  /** Note what became of an agent by now. @param {number} agent @param {number} fate @param {number} row */
  _end(agent, fate, row) {
    if (fate === 0 && this.end[agent] === Infinity) return;
    const fresh = this.end[agent] === Infinity;
    if (fresh) {
      this.end[agent] = row;
      this.fate[agent] = fate;
    }
    const { count, dim } = this;
    const [here, before] = [(row * count + agent) * dim, (Math.max(row - 1, 0) * count + agent) * dim];
    for (let axis = 0; axis < dim; axis++) {
      this.position[here + axis] = this.position[before + axis] + (fresh ? this.velocity[before + axis] * this.dt : 0);
      this.velocity[here + axis] = fresh ? this.velocity[before + axis] : 0;
    }
  }

  /** Forget the first row. */
  _forget() {
    const { count, dim } = this;
    this.position.copyWithin(0, count * dim);
    this.velocity.copyWithin(0, count * dim);
    this.group.copyWithin(0, count);
    this.state.copyWithin(0, count);
    this.when.copyWithin(0, 1);
    for (let agent = 0; agent < count; agent++) if (this.end[agent] > 0) this.end[agent] -= 1;
  }

  /** Give the simulation's tick at a time, with its fraction. @param {number} time rows */
  tickAt(time) {
    const row = Math.min(Math.max(Math.floor(time), 0), this.ticks);
    return this.when[row] + (row < this.ticks ? (time - row) * (this.when[row + 1] - this.when[row]) : 0);
  }
}

/** Paths through a window. */
export class WindowPaths extends Paths {
  /** Take in what was added to the window. */
  extend() {
    const { recording } = this;
    for (let agent = 0; agent < recording.count; agent++) {
      const ended = recording.end[agent] <= recording.ticks;
      const fresh = ended && recording.end[agent] === recording.ticks;
      this._from[agent] = ended ? recording.end[agent] : recording.ticks;
      if (fresh && recording.end[agent] > 0) this._letGo(agent);
    }
    for (let agent = 0; agent < recording.prey; agent++) if (recording.end[agent] === recording.ticks) this._meet(agent);
    this.time = NaN;
  }
}
