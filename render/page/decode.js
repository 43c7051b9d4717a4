/**
 * Decode: recordings as the page holds them, read from a header and compressed numbers. docs/page.md describes the format.
 *
 * @typedef {{at: number, bits: number, shape: number[], order: number, kind: string, low?: number[], step?: number[]}} Section
 * @typedef {{count: number, strategy: string, avoidance: string, radius: number, perception: number, view: number,
 *   nearest: number | null, states: string[], terms: string[], fate: number[], end: (number | null)[],
 *   judged?: (number[] | null)[]}} Agents
 * @typedef {{format: number, label: string, title: string, source: string, preset: string, seed: number, trial: number,
 *   ticks: number, dim: number, dt: number, size: number[], heights: number[], boundary: string, sky: boolean,
 *   areas: {label: string, low: number[], high: number[]}[], target: {position: number[], radius: number} | null,
 *   obstacles: number[][], swept: {cell: number, tool: number} | null, prey: Agents, predators: Agents, measures: string[],
 *   sections: Record<string, Section>}} Header
 */

export const FORMAT = 1;

export const FATES = ["alive", "arrived", "captured", "crashed"];

export const ARRIVED = 1,
  CAPTURED = 2,
  CRASHED = 3;

/** A recording: all agents, prey first, as flat arrays [tick, agent, dim]. */
export class Recording {
  /** @param {Header} header @param {Uint8Array} bytes */
  constructor(header, bytes) {
    if (header.format !== FORMAT) throw new Error(`this page reads recordings of format ${FORMAT}, not ${header.format}`);
    const { prey, predators } = header;
    this.header = header;
    this.ticks = header.ticks;
    this.dim = header.dim;
    /** Seconds from one row of numbers to the next. */
    this.dt = header.dt;
    /** How many prey have each fate, where that is told; else it is counted. @type {number[] | null} */
    this.counts = null;
    this.prey = prey.count;
    this.count = prey.count + predators.count;
    const cells = (this.ticks + 1) * this.count;
    this.position = new Float32Array(cells * this.dim);
    this.velocity = new Float32Array(cells * this.dim);
    this.state = new Uint8Array(cells);
    this.group = new Int16Array(cells).fill(-1);
    /** @type {string[]} */
    this.states = [...new Set(["calm", ...prey.states, ...predators.states])];
    /** Where each was judged to be gone [m], if that is known. @type {(number[] | null | undefined)[]} */
    this.judged = new Array(this.count).fill(null);
    [prey, predators].forEach((each, n) => each.judged?.forEach((place, k) => (this.judged[n * prey.count + k] = place)));
    /** The tick at which each agent is gone, Infinity for those who stay. */
    this.end = Float64Array.from([...prey.end, ...predators.end], (end) => end ?? Infinity);
    this.fate = Uint8Array.from([...prey.fate, ...predators.fate]);
    /** What each term added to the velocity in the move out of a tick's state. @type {Map<string, Float32Array>} */
    this.terms = new Map();
    /** @type {Map<string, Float32Array>} */
    this.measures = new Map();
    /** Points and arrows of the avoidance's field, four numbers each. */
    this.field = header.sections.field ? values(bytes, header.sections.field) : new Float32Array(0);
    this._read(bytes);
  }

  /** @param {Uint8Array} bytes */
  _read(bytes) {
    const { sections } = this.header;
    for (const [kind, first] of /** @type {["prey" | "predators", number][]} */ ([["prey", 0], ["predators", this.prey]])) {
      const agents = this.header[kind];
      if (!agents.count) continue;
      this._place(this.position, values(bytes, sections[`${kind}.position`]), agents.count, first, this.dim);
      this._place(this.velocity, values(bytes, sections[`${kind}.velocity`]), agents.count, first, this.dim);
      const codes = agents.states.map((name) => this.states.indexOf(name));
      const state = values(bytes, sections[`${kind}.state`]).map((code) => codes[code]);
      this._place(this.state, state, agents.count, first, 1);
      this._place(this.group, values(bytes, sections[`${kind}.group`]), agents.count, first, 1);
      for (const name of agents.terms) {
        const term = this.terms.get(name) ?? new Float32Array(this.position.length);
        this._place(term, values(bytes, sections[`${kind}.terms.${name}`]), agents.count, first, this.dim);
        this.terms.set(name, term);
      }
    }
    for (const name of this.header.measures) this.measures.set(name, values(bytes, sections[`measure.${name}`]));
  }

  /**
   * Put the numbers of one kind of agents among those of all.
   * @param {Float32Array | Uint8Array | Int16Array} all @param {Float32Array} own
   * @param {number} count @param {number} first @param {number} width
   */
  _place(all, own, count, first, width) {
    for (let tick = 0; tick <= this.ticks; tick++) {
      const rows = own.subarray(tick * count * width, (tick + 1) * count * width);
      all.set(rows, (tick * this.count + first) * width);
    }
  }

  /** Tell whether an agent is there at a tick. @param {number} agent @param {number} tick */
  there(agent, tick) {
    return tick < this.end[agent];
  }

  /** Give the agents of which an agent is one. @param {number} agent */
  kind(agent) {
    return agent < this.prey ? this.header.prey : this.header.predators;
  }

  /** Name an agent as people count: prey 1, predator 1. @param {number} agent */
  name(agent) {
    return agent < this.prey ? `prey ${agent + 1}` : `predator ${agent - this.prey + 1}`;
  }

  /**
   * Give a way across the edge of a periodic world where that is shorter.
   * @param {number} step metres along an axis @param {number} axis
   */
  shortest(step, axis) {
    if (this.header.boundary !== "periodic") return step;
    const size = this.header.size[axis];
    return step - size * Math.floor(step / size + 0.5);
  }
}

/** Undo what `pack.py` did to a section. @param {Uint8Array} bytes @param {Section} section @returns {Float32Array} */
function values(bytes, section) {
  const whole = integers(bytes, section);
  if (section.kind === "float") return new Float32Array(whole.buffer);
  const out = new Float32Array(whole.length);
  if (section.kind === "codes") {
    for (let n = 0; n < out.length; n++) out[n] = whole[n] - 1;
    return out;
  }
  const { low = [0], step = [1] } = section;
  for (let n = 0; n < out.length; n++) out[n] = low[n % low.length] + step[n % low.length] * whole[n];
  return out;
}

/** @param {Uint8Array} bytes @param {Section} section @returns {Uint16Array | Uint32Array} */
function integers(bytes, { at, bits, shape, order }) {
  const count = shape.reduce((product, size) => product * size, 1);
  const row = count / shape[0];
  const out = bits === 16 ? new Uint16Array(count) : new Uint32Array(count);
  for (let plane = 0; plane < bits / 8; plane++) {
    const from = at + plane * count;
    for (let n = 0; n < count; n++) out[n] |= bytes[from + n] << (8 * plane);
  }
  for (let n = 0; n < count; n++) out[n] = (out[n] >>> 1) ^ -(out[n] & 1);
  for (let pass = 0; pass < order; pass++) {
    for (let n = row; n < count; n++) out[n] += out[n - row];
  }
  return out;
}

/** Read a recording. @param {Header} header @param {string} text base64 of deflated numbers @returns {Promise<Recording>} */
export async function decoded(header, text) {
  if (typeof DecompressionStream === "undefined") throw new Error("this browser is too old to unpack recordings; update it");
  const letters = atob(text);
  const packed = new Uint8Array(letters.length);
  for (let n = 0; n < packed.length; n++) packed[n] = letters.charCodeAt(n);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Recording(header, new Uint8Array(await new Response(stream).arrayBuffer()));
}
