/** Flat: a painter for browsers without WebGL 2, and for small posters: the same shapes by the canvas's own means. */

import { BOX, CAPSULE, DART, RIBBON, STRIDE } from "./shapes.js";

/** @param {number} light linear, 0 to 1 */
function shown(light) {
  return Math.round(255 * (light <= 0.0031308 ? light * 12.92 : 1.055 * light ** (1 / 2.4) - 0.055));
}

/** @param {ArrayLike<number>} rows @param {number} at @param {number} alpha */
function css(rows, at, alpha) {
  return `rgb(${shown(rows[at])} ${shown(rows[at + 1])} ${shown(rows[at + 2])} / ${Math.max(alpha, 0).toFixed(4)})`;
}

/** Paints scenes on a canvas. */
export class FlatPainter {
  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this.name = "canvas";
    this.canvas = canvas;
    this.pen = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d", { alpha: false }));
  }

  /**
   * Draw scenes, whose layers are filled.
   * @param {import("./scene.js").Scene[]} scenes @param {number[]} backdrop linear light
   */
  paint(scenes, backdrop) {
    const { pen } = this;
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.fillStyle = css(backdrop, 0, 1);
    pen.fillRect(0, 0, this.canvas.width, this.canvas.height);
    for (const { clip, images, below, ribbons, above, cloud } of scenes) {
      pen.save();
      pen.beginPath();
      pen.rect(clip.x, clip.y, clip.width, clip.height);
      pen.clip();
      for (const [x, y] of images) {
        pen.setTransform(1, 0, 0, 1, x, y);
        this._shapes(below);
        cloud?.draw(pen);
        this._ribbons(ribbons);
        this._shapes(above);
      }
      pen.restore();
    }
  }

  /** @param {import("./shapes.js").Shapes} shapes */
  _shapes({ rows, count }) {
    for (let at = 0; at < count * STRIDE; at += STRIDE) this._shape(rows, at);
  }

  /** @param {Float32Array} rows @param {number} at */
  _shape(rows, at) {
    const { pen } = this;
    const [kind, soft, stroke] = [rows[at], rows[at + 1], rows[at + 2]];
    const [alpha, other] = [rows[at + 13], rows[at + 14]];
    pen.beginPath();
    if (kind === CAPSULE) this._capsule(rows, at);
    else if (kind === DART) this._dart(rows, at);
    else if (kind === BOX) this._box(rows, at);
    else {
      for (const n of [4, 6, 8]) pen.lineTo(rows[at + n], rows[at + n + 1]);
      pen.lineTo(rows[at + 3], rows[at + 2]);
    }
    /** @type {string | CanvasGradient} */
    let ink = css(rows, at + 10, (alpha + other) / 2);
    if (kind === BOX && alpha !== other) {
      ink = pen.createLinearGradient(0, rows[at + 5] - rows[at + 9], 0, rows[at + 5] + rows[at + 9]);
      ink.addColorStop(0, css(rows, at + 10, alpha));
      ink.addColorStop(1, css(rows, at + 10, other));
    } else if (kind === CAPSULE && soft > 1.5) {
      const [x, y, radius] = [rows[at + 4], rows[at + 5], rows[at + 8]];
      ink = pen.createRadialGradient(x, y, Math.max(radius - soft / 2, 0), x, y, radius + soft / 2);
      ink.addColorStop(0, css(rows, at + 10, alpha * Math.min(0.5 + radius / soft, 1)));
      ink.addColorStop(1, css(rows, at + 10, 0));
    }
    if (stroke > 0 && kind <= BOX) {
      pen.lineWidth = 2 * stroke;
      pen.strokeStyle = ink;
      pen.stroke();
    } else {
      pen.fillStyle = ink;
      pen.fill();
    }
  }

  /** @param {Float32Array} rows @param {number} at */
  _capsule(rows, at) {
    const [ax, ay, bx, by, p, q] = rows.subarray(at + 4, at + 10);
    const soft = rows[at + 1] > 1.5 ? rows[at + 1] / 2 : 0;
    if (ax === bx && ay === by) {
      this.pen.arc(ax, ay, p + soft, 0, 2 * Math.PI);
      return;
    }
    const angle = Math.atan2(by - ay, bx - ax);
    const lean = Math.acos(Math.min(Math.max((p - q) / Math.hypot(bx - ax, by - ay), -1), 1));
    this.pen.arc(ax, ay, p, angle + lean, angle - lean + 2 * Math.PI);
    this.pen.arc(bx, by, q, angle - lean, angle + lean);
    this.pen.closePath();
  }

  /** @param {Float32Array} rows @param {number} at */
  _dart(rows, at) {
    const [x, y, hx, hy, long, wide] = rows.subarray(at + 4, at + 10);
    const notch = rows[at + 3] - long;
    for (const [u, v] of [[long, 0], [-long, wide], [notch, 0], [-long, -wide]]) {
      this.pen.lineTo(x + u * hx - v * hy, y + u * hy + v * hx);
    }
    this.pen.closePath();
  }

  /** @param {Float32Array} rows @param {number} at */
  _box(rows, at) {
    const [x, y, p, q] = [rows[at + 4], rows[at + 5], rows[at + 8], rows[at + 9]];
    this.pen.roundRect(x - p, y - q, 2 * p, 2 * q, Math.max(rows[at + 3], 0));
  }

  /** @param {import("./shapes.js").Ribbons} ribbons */
  _ribbons({ rows, count }) {
    const { pen } = this;
    pen.lineCap = "butt";
    // Points lie in pairs, left and right; where a ribbon ends and the next begins, right comes before left.
    for (let n = 1; n + 3 < count; n += 2) {
      const [a, b] = [n * RIBBON, (n + 2) * RIBBON];
      if (rows[a + 2] < 0 || rows[b + 2] < 0) continue;
      const alpha = (rows[a + 7] + rows[b + 7]) / 2;
      pen.beginPath();
      pen.lineWidth = 2 * rows[a + 3];
      pen.strokeStyle = css(rows, a + 4, alpha);
      pen.moveTo((rows[a] + rows[a + RIBBON]) / 2, (rows[a + 1] + rows[a + RIBBON + 1]) / 2);
      pen.lineTo((rows[b] + rows[b + RIBBON]) / 2, (rows[b + 1] + rows[b + RIBBON + 1]) / 2);
      pen.stroke();
    }
  }
}
