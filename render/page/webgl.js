/** WebGL: a painter that draws shapes as the films do: signed distances, blended in linear light. */

import { linked } from "./shaders.js";
import { RIBBON, STRIDE } from "./shapes.js";

/** Shapes in a row of the texture that they are handed over in. Instances would do, but drawn in software they are slow. */
const SHAPES = 256;

const SHAPE_VERTEX = `#version 300 es
#define SHAPES ${SHAPES}
uniform highp sampler2D rows;
uniform vec2 size, shift;
flat out vec4 vHow, vEnds; flat out vec2 vSizes, vAlphas; flat out vec3 vPaint; out vec2 at;
void main() {
  int shape = gl_VertexID / 6, n = gl_VertexID % 6;
  ivec2 first = ivec2(shape % SHAPES * 4, shape / SHAPES);
  vec4 how = texelFetch(rows, first, 0);                   // kind, soft, stroke, tweak
  vec4 ends = texelFetch(rows, first + ivec2(1, 0), 0);    // a, b
  vec4 both = texelFetch(rows, first + ivec2(2, 0), 0), rest = texelFetch(rows, first + ivec2(3, 0), 0);
  vec2 sizes = both.xy, a = ends.xy, b = ends.zw;
  vHow = how; vEnds = ends; vSizes = sizes; vAlphas = rest.yz; vPaint = vec3(both.zw, rest.x);
  vec2 corner = vec2(n == 1 || n == 3 || n == 4, n == 2 || n == 4 || n == 5) * 2.0 - 1.0;
  float pad = how.y * 0.5 + how.z + 1.5;
  if (how.x < 0.5) {
    vec2 e = b - a; float far = length(e);
    vec2 u = far > 1e-6 ? e / far : vec2(1, 0);
    float reach = max(sizes.x, sizes.y) + pad;
    at = (a + b) * 0.5 + u * corner.x * (far * 0.5 + reach) + vec2(-u.y, u.x) * corner.y * reach;
  } else if (how.x < 1.5) {
    at = a + corner * (length(sizes) + pad);
  } else if (how.x < 2.5) {
    at = a + corner * (sizes + pad);
  } else {
    vec2 d = how.wz;  // no quadrilateral has a stroke or a tweak
    vec2 low = min(min(a, b), min(sizes, d)), high = max(max(a, b), max(sizes, d));
    at = mix(low, high, corner * 0.5 + 0.5) + corner * 1.5;
  }
  vec2 place = (at + shift) / size * 2.0 - 1.0;
  gl_Position = vec4(place.x, -place.y, 0, 1);
}`;

const SHAPE_FRAGMENT = `#version 300 es
precision highp float;
flat in vec4 vHow, vEnds; flat in vec2 vSizes, vAlphas; flat in vec3 vPaint; in vec2 at;
out vec4 light;
float edge2(vec2 p, vec2 a, vec2 b) {
  vec2 e = b - a, d = p - a - clamp(dot(p - a, e) / max(dot(e, e), 1e-12), 0.0, 1.0) * e;
  return dot(d, d);
}
float beyond(vec2 p, vec2 a, vec2 b) {
  vec2 e = b - a;
  return ((p.x - a.x) * e.y - (p.y - a.y) * e.x) / sqrt(max(dot(e, e), 1e-12));
}
void main() {
  vec2 a = vEnds.xy, b = vEnds.zw; float d, along = 0.0, most = 1.0, stroke = vHow.z;
  if (vHow.x < 0.5) {
    vec2 e = b - a;
    along = clamp(dot(at - a, e) / max(dot(e, e), 1e-12), 0.0, 1.0);
    float radius = mix(vSizes.x, vSizes.y, along);
    d = length(at - a - along * e) - radius;
    most = stroke > 0.0 ? 1.0 : min(2.0 * radius, 1.0);
  } else if (vHow.x < 1.5) {
    float u = dot(at - a, b), v = abs((at.y - a.y) * b.x - (at.x - a.x) * b.y), l = vSizes.x, w = vSizes.y, n = vHow.w;
    vec2 p = vec2(u, v);
    d = sqrt(min(edge2(p, vec2(l, 0), vec2(-l, w)), edge2(p, vec2(-l, w), vec2(n - l, 0))));
    if (min((l - u) * w - v * 2.0 * l, (u + l) * w - (w - v) * n) > 0.0) d = -d;
  } else if (vHow.x < 2.5) {
    vec2 o = abs(at - a) - vSizes + vHow.w;
    d = length(max(o, 0.0)) + min(max(o.x, o.y), 0.0) - vHow.w;
    along = clamp((at.y - a.y + vSizes.y) / max(2.0 * vSizes.y, 1e-6), 0.0, 1.0);
  } else {
    vec2 c = vSizes, e = vHow.wz;
    d = max(max(beyond(at, a, b), beyond(at, b, c)), max(beyond(at, c, e), beyond(at, e, a)));
    stroke = 0.0;
  }
  if (stroke > 0.0) { d = abs(d) - stroke; most = min(2.0 * stroke, most); }
  light = vec4(vPaint, min(clamp(0.5 - d / vHow.y, 0.0, 1.0), most) * mix(vAlphas.x, vAlphas.y, along));
}`;

const RIBBON_VERTEX = `#version 300 es
layout(location=0) in vec4 spot;   // place, distance from the middle, half the width
layout(location=1) in vec4 paint;
uniform vec2 size, shift;
out vec4 vPaint; out vec2 off;
void main() {
  vPaint = paint; off = spot.zw;
  vec2 place = (spot.xy + shift) / size * 2.0 - 1.0;
  gl_Position = vec4(place.x, -place.y, 0, 1);
}`;

const RIBBON_FRAGMENT = `#version 300 es
precision highp float;
in vec4 vPaint; in vec2 off;
out vec4 light;
void main() { light = vec4(vPaint.rgb, vPaint.a * min(clamp(0.5 + off.y - abs(off.x), 0.0, 1.0), 2.0 * off.y)); }`;

const SCREEN_VERTEX = `#version 300 es
out vec2 at;
void main() { at = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0; gl_Position = vec4(at * 2.0 - 1.0, 0, 1); }`;

const SCREEN_FRAGMENT = `#version 300 es
precision highp float;
uniform sampler2D picture; in vec2 at; out vec4 shown;
void main() {
  vec3 x = texture(picture, at).rgb;
  shown = vec4(mix(12.92 * x, 1.055 * pow(max(x, 1e-9), vec3(1.0 / 2.4)) - 0.055, step(0.0031308, x)), 1);
}`;

/** Paints scenes on a canvas. */
export class WebGlPainter {
  /** Give a painter, or null where the browser has no WebGL 2. @param {HTMLCanvasElement} canvas */
  static on(canvas) {
    const gl = canvas.getContext("webgl2", { alpha: false, antialias: false, powerPreference: "high-performance" });
    return gl && new WebGlPainter(canvas, gl);
  }

  /** @param {HTMLCanvasElement} canvas @param {WebGL2RenderingContext} gl */
  constructor(canvas, gl) {
    this.name = "WebGL";
    this.canvas = canvas;
    this.gl = gl;
    this.shapes = this._program(SHAPE_VERTEX, SHAPE_FRAGMENT);
    this.ribbons = this._program(RIBBON_VERTEX, RIBBON_FRAGMENT);
    this.screen = this._program(SCREEN_VERTEX, SCREEN_FRAGMENT);
    this.ribbonRows = this._rows([4, 4], RIBBON);
    this.nothing = gl.createVertexArray();
    this.shapeRows = [this._texture(), this._texture()];
    this.picture = gl.createTexture();
    this.frame = gl.createFramebuffer();
    this.width = 0;
    this.height = 0;
  }

  /** @param {string} vertex @param {string} fragment */
  _program(vertex, fragment) {
    const { gl } = this;
    const program = linked(gl, vertex, fragment);
    return { program, size: gl.getUniformLocation(program, "size"), shift: gl.getUniformLocation(program, "shift") };
  }

  /** Make room for shapes. */
  _texture() {
    return { texture: this.gl.createTexture(), height: 0 };
  }

  /** Describe rows of numbers. @param {number[]} widths @param {number} stride */
  _rows(widths, stride) {
    const { gl } = this;
    const [array, buffer] = [gl.createVertexArray(), gl.createBuffer()];
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    let offset = 0;
    widths.forEach((width, place) => {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, width, gl.FLOAT, false, stride * 4, offset * 4);
      offset += width;
    });
    return { array, buffer };
  }

  /** Give the picture the canvas's size. */
  _resize() {
    const { gl, canvas } = this;
    if (canvas.width === this.width && canvas.height === this.height) return;
    this.width = canvas.width;
    this.height = canvas.height;
    gl.bindTexture(gl.TEXTURE_2D, this.picture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.SRGB8_ALPHA8, this.width, this.height, 0, gl.RGBA, gl.UNSIGNED_BYTE, null);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, this.picture, 0);
  }

  /**
   * Draw scenes, whose layers are filled.
   * @param {import("./scene.js").Scene[]} scenes @param {number[]} backdrop linear light
   */
  paint(scenes, backdrop) {
    const { gl } = this;
    this._resize();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
    gl.viewport(0, 0, this.width, this.height);
    gl.disable(gl.SCISSOR_TEST);
    gl.clearColor(backdrop[0], backdrop[1], backdrop[2], 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE);
    gl.enable(gl.SCISSOR_TEST);
    for (const scene of scenes) this._scene(scene);
    gl.disable(gl.SCISSOR_TEST);
    gl.disable(gl.BLEND);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.useProgram(this.screen.program);
    gl.bindVertexArray(this.nothing);
    gl.bindTexture(gl.TEXTURE_2D, this.picture);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  }

  /** @param {import("./scene.js").Scene} scene */
  _scene({ clip, images, below, ribbons, above, cloud }) {
    const { gl } = this;
    const bottom = Math.round(this.height - clip.y - clip.height);
    gl.scissor(Math.round(clip.x), bottom, Math.max(Math.round(clip.width), 0), Math.max(Math.round(clip.height), 0));
    this._shapes(below, this.shapeRows[0], images);
    cloud?.paint(gl, this.nothing, this.width, this.height);
    if (ribbons.count) {
      gl.bindVertexArray(this.ribbonRows.array);
      gl.bindBuffer(gl.ARRAY_BUFFER, this.ribbonRows.buffer);
      gl.bufferData(gl.ARRAY_BUFFER, ribbons.rows.subarray(0, ribbons.count * RIBBON), gl.STREAM_DRAW);
      this._images(this.ribbons, images, () => gl.drawArrays(gl.TRIANGLE_STRIP, 0, ribbons.count));
    }
    this._shapes(above, this.shapeRows[1], images);
  }

  /**
   * @param {import("./shapes.js").Shapes} shapes @param {{texture: WebGLTexture | null, height: number}} target
   * @param {number[][]} images
   */
  _shapes({ rows, count }, target, images) {
    if (!count) return;
    const { gl } = this;
    const [width, height] = [(SHAPES * STRIDE) / 4, Math.ceil(count / SHAPES)];
    gl.bindVertexArray(this.nothing);
    gl.bindTexture(gl.TEXTURE_2D, target.texture);
    if (height > target.height) {
      target.height = 2 * height;
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, width, target.height, 0, gl.RGBA, gl.FLOAT, null);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    }
    const told = rows.subarray(0, height * SHAPES * STRIDE);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, width, height, gl.RGBA, gl.FLOAT, told);
    this._images(this.shapes, images, () => gl.drawArrays(gl.TRIANGLES, 0, 6 * count));
  }

  /**
   * Draw what is bound, once for each image of a periodic world.
   * @param {{program: WebGLProgram, size: WebGLUniformLocation | null, shift: WebGLUniformLocation | null}} program
   * @param {number[][]} images @param {() => void} draw
   */
  _images(program, images, draw) {
    const { gl } = this;
    gl.useProgram(program.program);
    gl.uniform2f(program.size, this.width, this.height);
    for (const [x, y] of images) {
      gl.uniform2f(program.shift, x, y);
      draw();
    }
  }
}
