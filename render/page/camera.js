/**
 * Cameras: maps from metres to pixels. `place` and `turn` leave what they find in the camera itself, since they are asked for
 * every agent of every frame.
 *
 * @typedef {{x: number, y: number, width: number, height: number}} Rect pixels, from the top left corner
 * @typedef {{low: number[], high: number[]}} Extent metres, [dim] each
 */

/** Free rim around what is shown, as a share of the window's shorter edge. */
const RIM = 0.035;

/** Orbits: pitch and turn at the start [rad], distance [half diagonals]. */
const PITCH = 0.42,
  TURN = 0.35,
  DISTANCE = 2.6;

const CLOSEST = 60,
  FARTHEST = 0.4;

/** A flat map from metres, y upwards, to pixels, y downwards. */
export class Flat {
  /** @param {Extent} extent what to show */
  constructor(extent) {
    this.extent = extent;
    this.deep = false;
    this.x = this.y = this.hx = this.hy = 0;
    this.near = 1;
    this.scale = 1;
    this.zoom = 1;
    this.centre = [0, 0];
    this.middle = [0, 0];
    /** @type {Rect} */
    this.rect = { x: 0, y: 0, width: 1, height: 1 };
    this.home();
  }

  /** Show all. */
  home() {
    const { low, high } = this.extent;
    this.zoom = 1;
    this.centre = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2];
  }

  /** Take a window on the screen. @param {Rect} rect */
  fit(rect) {
    const { low, high } = this.extent;
    const room = 2 * RIM * Math.min(rect.width, rect.height);
    this.rect = rect;
    this.middle = [rect.x + rect.width / 2, rect.y + rect.height / 2];
    this.scale =
      Math.max(Math.min((rect.width - room) / (high[0] - low[0]), (rect.height - room) / (high[1] - low[1])), 1e-9) * this.zoom;
  }

  /** Find a point's pixel. @param {number} x @param {number} y @param {number} [_z] */
  place(x, y, _z = 0) {
    this.x = this.middle[0] + (x - this.centre[0]) * this.scale;
    this.y = this.middle[1] - (y - this.centre[1]) * this.scale;
  }

  /**
   * Find a direction on the screen, a unit vector; no direction at all points right.
   * @param {number} _x @param {number} _y @param {number} _z @param {number} vx @param {number} vy @param {number} [_vz]
   */
  turn(_x, _y, _z, vx, vy, _vz = 0) {
    const long = Math.hypot(vx, vy);
    this.hx = long > 1e-12 ? vx / long : 1;
    this.hy = long > 1e-12 ? -vy / long : 0;
  }

  /** Zoom about a pixel. @param {number} factor @param {number} px @param {number} py */
  closer(factor, px, py) {
    const zoom = Math.min(Math.max(this.zoom * factor, FARTHEST), CLOSEST);
    const [dx, dy] = [(px - this.middle[0]) / this.scale, (this.middle[1] - py) / this.scale];
    const kept = 1 - this.zoom / zoom;
    this.centre = [this.centre[0] + dx * kept, this.centre[1] + dy * kept];
    this.zoom = zoom;
    this.fit(this.rect);
  }

  /** Drag by pixels. @param {number} dx @param {number} dy */
  drag(dx, dy) {
    this.centre = [this.centre[0] - dx / this.scale, this.centre[1] + dy / this.scale];
  }

  /** Keep a point in the middle. @param {number[] | Float32Array} point */
  follow(point) {
    this.centre = [point[0], point[1]];
  }
}

/** A perspective view of a 3-D world, from an orbit around it. */
export class Orbit extends Flat {
  /** @param {Extent} extent */
  constructor(extent) {
    super(extent);
    this.deep = true;
    this.home();
    this.spread = this._spread();
    this.home();
  }

  /**
   * Find how far from the middle a room's corners come, from whichever side it is looked at [m].
   * @returns {[number, number]}
   */
  _spread() {
    const { low, high } = this.extent;
    let [across, up] = [1e-9, 1e-9];
    for (let n = 0; n < 8 * 24; n++) {
      this.yaw = (Math.floor(n / 8) * Math.PI) / 12;
      this._axes();
      const [x, y, z] = low.map((each, axis) => (n & (1 << axis) ? high[axis] : each));
      this.place(x, y, z);
      across = Math.max(across, Math.abs(this.x));
      up = Math.max(up, Math.abs(this.y));
    }
    return [across, up];
  }

  home() {
    const { low, high } = this.extent;
    this.zoom = 1;
    this.yaw = TURN;
    this.pitch = PITCH;
    this.pivot = low.map((each, axis) => (each + (high[axis] ?? 0)) / 2);
    this.away = (DISTANCE * Math.hypot(...low.map((each, axis) => high[axis] - each))) / 2 || 1;
    this._axes();
  }

  _axes() {
    const [c, s] = [Math.cos(this.yaw ?? 0), Math.sin(this.yaw ?? 0)];
    const [cp, sp] = [Math.cos(this.pitch ?? 0), Math.sin(this.pitch ?? 0)];
    this.axes = [c, s, 0, -s * sp, c * sp, cp, -s * cp, c * cp, -sp];
  }

  /** Take a window: the same scale from wherever the eye looks, so that turning does not pump. @param {Rect} rect */
  fit(rect) {
    const [across, up] = this.spread ?? [1, 1];
    const room = 0.5 - RIM;
    this.rect = rect;
    this.scale = Math.min((rect.width * room) / across, (rect.height * room) / up) * this.zoom;
    this.middle = [rect.x + rect.width / 2, rect.y + rect.height / 2];
  }

  /** @param {number} x @param {number} y @param {number} [z] */
  place(x, y, z = 0) {
    const [a, pivot] = [this.axes ?? [], this.pivot ?? [0, 0, 0]];
    const [dx, dy, dz] = [x - pivot[0], y - pivot[1], z - pivot[2]];
    const ahead = a[6] * dx + a[7] * dy + a[8] * dz;
    const away = this.away ?? 1;
    this.near = away / Math.max(away + ahead, 0.05 * away);
    this.x = this.middle[0] + (a[0] * dx + a[1] * dy + a[2] * dz) * this.scale * this.near;
    this.y = this.middle[1] - (a[3] * dx + a[4] * dy + a[5] * dz) * this.scale * this.near;
  }

  /** @param {number} x @param {number} y @param {number} z @param {number} vx @param {number} vy @param {number} [vz] */
  turn(x, y, z, vx, vy, vz = 0) {
    const { x: sx, y: sy, near } = this;
    const step = ((this.away ?? 1) * 1e-3) / Math.max(Math.hypot(vx, vy, vz), 1e-12);
    this.place(x, y, z);
    const [px, py] = [this.x, this.y];
    this.place(x + vx * step, y + vy * step, z + vz * step);
    const long = Math.hypot(this.x - px, this.y - py);
    this.hx = long > 1e-9 ? (this.x - px) / long : 1;
    this.hy = long > 1e-9 ? (this.y - py) / long : 0;
    [this.x, this.y, this.near] = [sx, sy, near];
  }

  /** How much of what is behind shows through things, the farther the more. */
  haze() {
    return Math.min(Math.max(0.22 + 1.5 * (1 - this.near), 0), 0.75);
  }

  /** @param {number} factor */
  closer(factor) {
    this.zoom = Math.min(Math.max(this.zoom * factor, FARTHEST), CLOSEST);
    this.fit(this.rect);
  }

  /** Turn around the world. @param {number} dx @param {number} dy */
  drag(dx, dy) {
    const turn = 3 / Math.max(Math.min(this.rect.width, this.rect.height), 1);
    this.yaw = (this.yaw ?? 0) - dx * turn;
    this.pitch = Math.min(Math.max((this.pitch ?? 0) + dy * turn, -0.2), 1.5);
    this._axes();
  }

  /** @param {number[] | Float32Array} point */
  follow(point) {
    this.pivot = [point[0], point[1], point[2] ?? 0];
  }
}
