/** Cloud: agents too many to be drawn one by one, denser and brighter where they crowd, as in films. */

import { Orbit } from "./camera.js";
import { linked } from "./shaders.js";
import { colour } from "./shapes.js";

/** @typedef {import("./ground.js").View} View */

/** Each agent is spread over the cells around its own, by about one and a half of them. */
const SPREAD_OUT = [1, 8, 28, 56, 70, 56, 28, 8, 1].map((each) => each / 256);

/** Edge of a cell [mean distances between agents], and cells along the longer side, at least and at most. */
const FINE_AS = 0.85,
  COARSEST = 56,
  FINEST = 512;

/** The scale of colours ends where agents are so many times as crowded as on average; in space they add up. */
const BRIGHTEST = 8,
  DEEP = 2.5;

/** How fast a cloud becomes opaque, and how opaque it becomes. */
const THIN = 1.2,
  OPAQUE = 0.96;

const CLOUD_VERTEX = `#version 300 es
uniform vec4 box; uniform vec2 size; out vec2 at;
void main() {
  at = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  vec2 place = mix(box.xy, box.zw, at) / size * 2.0 - 1.0;
  gl_Position = vec4(place.x, -place.y, 0, 1);
}`;

const CLOUD_FRAGMENT = `#version 300 es
precision highp float;
uniform sampler2D levels; uniform vec3 heat[3]; in vec2 at; out vec4 light;
void main() {
  float level = texture(levels, at).r;
  vec3 paint = level < 0.5 ? mix(heat[0], heat[1], level * 2.0) : mix(heat[1], heat[2], level * 2.0 - 1.0);
  light = vec4(paint, ${OPAQUE} * (1.0 - exp(-${THIN} * (exp(level * log(${BRIGHTEST + 1}.0)) - 1.0))));
}`;

/** @typedef {{program: WebGLProgram, texture: WebGLTexture | null, places: (WebGLUniformLocation | null)[]}} Brush */

export class Cloud {
  /** @param {import("./window.js").Box} box @param {number} dim @param {boolean} wraps */
  constructor(box, dim, wraps) {
    this.box = box;
    this.dim = dim;
    this.wraps = wraps;
    /** Places of two ticks, 65 536 steps over the box. */
    this.now = /** @type {Uint16Array} */ (new Uint16Array(0));
    this.before = this.now;
    this.columns = this.rows = 1;
    /** Agents in a cell, were they spread evenly. */
    this.average = 1;
    this.counts = new Float32Array(1);
    this.spread = new Float32Array(1);
    this.levels = new Uint8Array(1);
    /** Where it is on the screen: left, top, right, bottom [px]. */
    this.edges = [0, 0, 0, 0];
    /** @type {number[][]} */
    this.heat = [];
    /** @type {WeakMap<WebGL2RenderingContext, Brush>} */
    this.brushes = new WeakMap();
    this.easel = document.createElement("canvas");
  }

  /** Take the places of another tick. @param {Uint16Array} places */
  push(places) {
    this.before = places.length === this.now.length ? this.now : places; // whoever is gone has left a gap: nobody is who it was
    this.now = places;
  }

  /** Count agents in cells, at a time between the last two ticks. @param {View} view */
  load(view) {
    const { lens, recording, time, theme } = view;
    const share = recording.ticks > 0 ? Math.min(Math.max(time - recording.ticks + 1, 0), 1) : 1;
    this.heat = theme.heat.map(colour);
    if (lens instanceof Orbit) this._deep(lens, share);
    else this._flat(view, share);
    this._spread();
  }

  /** @param {number} width @param {number} height @param {number} whole area that the average counts in [same unit, squared] */
  _divide(width, height, whole) {
    const longer = Math.max(width, height);
    const edge = Math.min(Math.max(FINE_AS * Math.sqrt(whole / this.box.count), longer / FINEST), longer / COARSEST);
    this.columns = Math.max(Math.round(width / edge), 1);
    this.rows = Math.max(Math.round(height / edge), 1);
    const cells = this.columns * this.rows;
    if (this.counts.length !== cells) {
      this.counts = new Float32Array(cells);
      this.spread = new Float32Array(cells);
      this.levels = new Uint8Array(cells);
    } else this.counts.fill(0);
  }

  /** Cells of the ground, whatever the camera does: the cloud does not crawl. @param {View} view @param {number} share */
  _flat({ lens, recording }, share) {
    const { low, high } = this.box;
    const [width, height] = [high[0] - low[0], high[1] - low[1]];
    const [across, up] = recording.header.size;
    this._divide(width, height, across * up);
    const { columns, rows, counts, now, before } = this;
    for (let n = 0; n < now.length; n += 2) {
      // The shorter way, as edges that wrap have it.
      const x = (before[n] + (((now[n] - before[n]) << 16) >> 16) * share) & 65_535;
      const y = (before[n + 1] + (((now[n + 1] - before[n + 1]) << 16) >> 16) * share) & 65_535;
      counts[(rows - 1 - ((y * rows) >> 16)) * columns + ((x * columns) >> 16)] += 1;
    }
    this.average = (this.box.count * width * height) / (across * up) / counts.length;
    lens.place(low[0], high[1]);
    const [left, top] = [lens.x, lens.y];
    lens.place(high[0], low[1]);
    this.edges = [left, top, lens.x, lens.y];
  }

  /** Cells of the part of the screen that the agents fill. @param {Orbit} lens @param {number} share */
  _deep(lens, share) {
    const { low, high } = this.box;
    const { now, before } = this;
    const steps = low.map((each, axis) => (high[axis] - each) / 65_536);
    const seen = new Float32Array(now.length);
    const place = (/** @type {number} */ n, /** @type {number} */ axis) => {
      const way = ((now[n] - before[n]) << 16) >> 16;
      return low[axis] + steps[axis] * ((before[n] + way * share) & 65_535);
    };
    let [left, top, right, bottom] = [Infinity, Infinity, -Infinity, -Infinity];
    for (let n = 0; n < now.length; n += 3) {
      lens.place(place(n, 0), place(n + 1, 1), place(n + 2, 2));
      seen[n] = lens.x;
      seen[n + 1] = lens.y;
      seen[n + 2] = lens.near ** 3;
      left = Math.min(left, lens.x);
      right = Math.max(right, lens.x);
      top = Math.min(top, lens.y);
      bottom = Math.max(bottom, lens.y);
    }
    const { rect } = lens;
    const rim = 0.02 * Math.max(right - left, bottom - top, 0) + 4; // room for what is spread
    this.edges = [Math.max(left - rim, rect.x), Math.max(top - rim, rect.y)];
    this.edges.push(Math.max(Math.min(right + rim, rect.x + rect.width), this.edges[0] + 1));
    this.edges.push(Math.max(Math.min(bottom + rim, rect.y + rect.height), this.edges[1] + 1));
    const [width, height] = [this.edges[2] - this.edges[0], this.edges[3] - this.edges[1]];
    this._divide(width, height, width * height);
    const { columns, rows, counts } = this;
    for (let n = 0; n < seen.length; n += 3) {
      const column = Math.floor(((seen[n] - this.edges[0]) / width) * columns);
      const row = Math.floor(((seen[n + 1] - this.edges[1]) / height) * rows);
      if (column >= 0 && column < columns && row >= 0 && row < rows) counts[row * columns + column] += seen[n + 2];
    }
    this.average = (DEEP * this.box.count) / counts.length;
  }

  /** Spread counts over neighbouring cells, and turn them into places on the scale of colours. */
  _spread() {
    const { columns, rows, counts, spread, levels } = this;
    const wraps = this.wraps && this.dim === 2;
    blur(counts, spread, columns, rows, 1, columns, wraps);
    blur(spread, counts, rows, columns, columns, 1, wraps);
    const [unit, scale] = [1 / (this.average || 1), 255 / Math.log1p(BRIGHTEST)];
    for (let n = 0; n < counts.length; n++) levels[n] = Math.min(Math.log1p(counts[n] * unit) * scale + 0.5, 255);
  }

  /**
   * Paint it by WebGL.
   * @param {WebGL2RenderingContext} gl @param {WebGLVertexArrayObject | null} nothing
   * @param {number} width @param {number} height
   */
  paint(gl, nothing, width, height) {
    const brush = this.brushes.get(gl) ?? made(gl);
    this.brushes.set(gl, brush);
    gl.useProgram(brush.program);
    gl.bindVertexArray(nothing);
    gl.bindTexture(gl.TEXTURE_2D, brush.texture);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.R8, this.columns, this.rows, 0, gl.RED, gl.UNSIGNED_BYTE, this.levels);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
    const [left, top, right, bottom] = this.edges;
    gl.uniform4f(brush.places[0], left, top, right, bottom);
    gl.uniform2f(brush.places[1], width, height);
    gl.uniform3fv(brush.places[2], this.heat.flat());
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }

  /** Paint it on a canvas. @param {CanvasRenderingContext2D} pen */
  draw(pen) {
    const { easel, columns, rows, levels, edges } = this;
    if (easel.width !== columns || easel.height !== rows) [easel.width, easel.height] = [columns, rows];
    const own = easel.getContext("2d");
    if (!own) return;
    const scale = Array.from({ length: 256 }, (_, n) => this._shade(n / 255));
    const image = own.createImageData(columns, rows);
    for (let n = 0; n < levels.length; n++) image.data.set(scale[levels[n]], n * 4);
    own.putImageData(image, 0, 0);
    pen.drawImage(easel, edges[0], edges[1], edges[2] - edges[0], edges[3] - edges[1]);
  }

  /** Give a place on the scale as a canvas has colours. @param {number} level @returns {number[]} */
  _shade(level) {
    const [from, to, f] = level < 0.5 ? [0, 1, level * 2] : [1, 2, level * 2 - 1];
    const light = [0, 1, 2].map((n) => this.heat[from][n] + (this.heat[to][n] - this.heat[from][n]) * f);
    const alpha = OPAQUE * (1 - Math.exp(-THIN * Math.expm1(level * Math.log1p(BRIGHTEST))));
    return [...light.map((each) => 255 * Math.max(each, 0) ** (1 / 2.2)), 255 * alpha];
  }
}

/**
 * Spread numbers along one axis.
 * @param {Float32Array} from @param {Float32Array} to @param {number} length along the axis @param {number} lines across it
 * @param {number} step from one number to the next along the axis @param {number} stride from line to line
 * @param {boolean} wraps
 */
function blur(from, to, length, lines, step, stride, wraps) {
  const half = SPREAD_OUT.length >> 1;
  const places = Int32Array.from({ length: length + 2 * half }, (_, n) => {
    const place = n - half;
    return step * (wraps ? ((place % length) + length) % length : Math.min(Math.max(place, 0), length - 1));
  });
  for (let line = 0; line < lines; line++) {
    const first = line * stride;
    for (let n = 0; n < length; n++) {
      let sum = 0;
      for (let tap = 0; tap < SPREAD_OUT.length; tap++) sum += SPREAD_OUT[tap] * from[first + places[n + tap]];
      to[first + n * step] = sum;
    }
  }
}

/** Make what a cloud is painted with. @param {WebGL2RenderingContext} gl @returns {Brush} */
function made(gl) {
  const program = linked(gl, CLOUD_VERTEX, CLOUD_FRAGMENT);
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  for (const way of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, way, gl.CLAMP_TO_EDGE);
  for (const way of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, way, gl.LINEAR);
  return { program, texture, places: ["box", "size", "heat"].map((name) => gl.getUniformLocation(program, name)) };
}
