/**
 * Shapes: rows of numbers that say what to draw, the same that the films are made of, and ribbons for trails.
 * Lengths are pixels, x to the right and y down; colours are linear light.
 *
 * @typedef {[number, number, number]} Colour
 * @typedef {Record<string, any>} Palette
 */

export const CAPSULE = 0,
  DART = 1,
  BOX = 2,
  QUAD = 3;

/** Numbers a shape: kind, soft, stroke, tweak, a, b, sizes, colour, two opacities, and one that fills four texels. */
export const STRIDE = 16;

/** Numbers a point of a ribbon: place, distance from the middle, half the width, colour, opacity. */
export const RIBBON = 8;

/** @param {number} value sRGB, 0 to 1 */
function linear(value) {
  return value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
}

/** @type {Map<string, Colour>} */
const known = new Map();

/** Read "#rrggbb" as linear light. @param {string} code @returns {Colour} */
export function colour(code) {
  let found = known.get(code);
  if (!found) {
    const part = (/** @type {number} */ n) => linear(parseInt(code.slice(n, n + 2), 16) / 255);
    found = [part(1), part(3), part(5)];
    known.set(code, found);
  }
  return found;
}

/** Blend two colours: `share` of b. @param {Colour} a @param {Colour} b @param {number} share @returns {Colour} */
export function mixed(a, b, share) {
  return [a[0] + (b[0] - a[0]) * share, a[1] + (b[1] - a[1]) * share, a[2] + (b[2] - a[2]) * share];
}

/** Numbers that grow in number and are written anew for every frame. */
class Numbers {
  /** @param {number} stride */
  constructor(stride) {
    this.stride = stride;
    this.rows = new Float32Array(stride * 1024);
    this.count = 0;
  }

  clear() {
    this.count = 0;
  }

  /** Make room for a row and give where it begins. */
  _next() {
    const at = this.count++ * this.stride;
    if (at + this.stride > this.rows.length) {
      const more = new Float32Array(this.rows.length * 2);
      more.set(this.rows);
      this.rows = more;
    }
    return at;
  }
}

/** Shapes of one layer, drawn in their order. */
export class Shapes extends Numbers {
  constructor() {
    super(STRIDE);
  }

  /**
   * @param {number} kind @param {number} soft @param {number} stroke @param {number} tweak
   * @param {number} ax @param {number} ay @param {number} bx @param {number} by @param {number} p @param {number} q
   * @param {Colour} paint @param {number} alpha @param {number} alphaB
   */
  _row(kind, soft, stroke, tweak, ax, ay, bx, by, p, q, paint, alpha, alphaB) {
    const at = this._next();
    const rows = this.rows;
    rows[at] = kind;
    rows[at + 1] = soft;
    rows[at + 2] = stroke;
    rows[at + 3] = tweak;
    rows[at + 4] = ax;
    rows[at + 5] = ay;
    rows[at + 6] = bx;
    rows[at + 7] = by;
    rows[at + 8] = p;
    rows[at + 9] = q;
    rows[at + 10] = paint[0];
    rows[at + 11] = paint[1];
    rows[at + 12] = paint[2];
    rows[at + 13] = alpha;
    rows[at + 14] = alphaB;
  }

  /**
   * Draw a tapered capsule from a to b.
   * @param {number} ax @param {number} ay @param {number} bx @param {number} by @param {number} ra @param {number} rb
   * @param {Colour} paint @param {number} [alpha] @param {number} [alphaB]
   */
  capsule(ax, ay, bx, by, ra, rb, paint, alpha = 1, alphaB = alpha) {
    this._row(CAPSULE, 1, 0, 0, ax, ay, bx, by, ra, rb, paint, alpha, alphaB);
  }

  /**
   * Draw a disc; a ramp of `soft` pixels adds area, which the radius gives back.
   * @param {number} x @param {number} y @param {number} radius
   * @param {Colour} paint @param {number} [alpha] @param {number} [soft]
   */
  disc(x, y, radius, paint, alpha = 1, soft = 1) {
    const own = Math.sqrt(Math.max(radius * radius - (soft * soft) / 12, 0));
    this._row(CAPSULE, soft, 0, 0, x, y, x, y, own, own, paint, alpha, alpha);
  }

  /**
   * Draw a circle of a line width.
   * @param {number} x @param {number} y @param {number} radius @param {number} width
   * @param {Colour} paint @param {number} [alpha]
   */
  ring(x, y, radius, width, paint, alpha = 1) {
    if (width > 0) this._row(CAPSULE, 1, width / 2, 0, x, y, x, y, radius, radius, paint, alpha, alpha);
  }

  /**
   * Draw a swept dart. length, width: half the extent along and across the heading; notch: how deep the tail is cut.
   * @param {number} x @param {number} y @param {number} hx @param {number} hy @param {number} length @param {number} width
   * @param {number} notch @param {Colour} paint @param {number} [alpha]
   */
  dart(x, y, hx, hy, length, width, notch, paint, alpha = 1) {
    this._row(DART, 1, 0, notch, x, y, hx, hy, length, width, paint, alpha, alpha);
  }

  /**
   * Draw a box between corners, rounded, and fading from top to bottom.
   * @param {number} x0 @param {number} y0 @param {number} x1 @param {number} y1 @param {Colour} paint
   * @param {{alpha?: number, below?: number, corner?: number, soft?: number, stroke?: number}} [look]
   */
  box(x0, y0, x1, y1, paint, { alpha = 1, below = alpha, corner = 0, soft = 1, stroke = 0 } = {}) {
    const p = (x1 - x0) / 2;
    const q = (y1 - y0) / 2;
    this._row(BOX, soft, stroke, Math.min(corner, p, q), (x0 + x1) / 2, (y0 + y1) / 2, 0, 0, p, q, paint, alpha, below);
  }

  /**
   * Draw a convex quadrilateral, corners clockwise on the screen.
   * @param {number[]} xy @param {Colour} paint @param {number} alpha
   */
  quad(xy, paint, alpha = 1) {
    this._row(QUAD, 1, xy[7], xy[6], xy[0], xy[1], xy[2], xy[3], xy[4], xy[5], paint, alpha, alpha);
  }
}

/** Ribbons: lines of changing width and opacity without beads where their pieces meet, as one strip of triangles. */
export class Ribbons extends Numbers {
  constructor() {
    super(RIBBON);
  }

  /**
   * @param {number} x @param {number} y @param {number} off @param {number} half @param {Colour} paint @param {number} alpha
   */
  _vertex(x, y, off, half, paint, alpha) {
    const at = this._next();
    const rows = this.rows;
    rows[at] = x;
    rows[at + 1] = y;
    rows[at + 2] = off;
    rows[at + 3] = half;
    rows[at + 4] = paint[0];
    rows[at + 5] = paint[1];
    rows[at + 6] = paint[2];
    rows[at + 7] = alpha;
  }

  /**
   * Add a line through points.
   * @param {Float32Array} points x, y, half the width and opacity of each @param {number} count @param {Colour} paint
   */
  line(points, count, paint) {
    for (let n = 0; n < count; n++) {
      const before = Math.max(n - 1, 0) * 4;
      const after = Math.min(n + 1, count - 1) * 4;
      const ex = points[after] - points[before];
      const ey = points[after + 1] - points[before + 1];
      const long = Math.hypot(ex, ey) || 1;
      const [x, y] = [points[n * 4], points[n * 4 + 1]];
      const [half, alpha] = [points[n * 4 + 2], points[n * 4 + 3]];
      const wide = half + 1;
      const [ox, oy] = [(-ey / long) * wide, (ex / long) * wide];
      if (n === 0) this._vertex(x + ox, y + oy, wide, half, paint, 0);
      this._vertex(x + ox, y + oy, wide, half, paint, alpha);
      this._vertex(x - ox, y - oy, -wide, half, paint, alpha);
      if (n === count - 1) this._vertex(x - ox, y - oy, -wide, half, paint, 0);
    }
  }
}
