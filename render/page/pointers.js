/** Pointers: one drags the stage, two zoom it, a short touch chooses an agent. */

/** @typedef {import("./stage.js").Stage} Stage */

/** A pointer that has moved less than this has not dragged [CSS px]. */
const STILL = 6;

/** Listens to pointers on a stage. */
export class Pointers {
  /** @param {Stage} stage */
  constructor(stage) {
    this.stage = stage;
    /** @type {Map<number, {x: number, y: number}>} */
    this.down = new Map();
    this.moved = 0;
    /** Whether the pointer holds something of the world's. */
    this.grasped = false;
    const { canvas } = stage;
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.grasped = !this.down.size && Boolean(stage.hand?.grasp(event));
      if (!this.down.size) this.moved = 0;
      this.down.set(event.pointerId, { x: event.clientX, y: event.clientY });
    });
    canvas.addEventListener("pointermove", (event) => this._move(event));
    canvas.addEventListener("pointerup", (event) => {
      if (!this.down.delete(event.pointerId) || this.down.size) return;
      if (this.grasped) stage.hand?.release(event);
      else if (this.moved < STILL && !stage.hand?.tap(event)) stage.tap(event);
    });
    canvas.addEventListener("pointercancel", (event) => {
      this.down.delete(event.pointerId);
      if (this.grasped) stage.hand?.release(event);
    });
    canvas.addEventListener("pointerleave", () => {
      stage.hovered = { scene: 0, agent: -1 };
      stage.stale = true;
    });
  }

  /** @param {PointerEvent} event */
  _move(event) {
    const held = this.down.get(event.pointerId);
    if (!held) {
      this.stage.hover(event);
      return;
    }
    const ratio = window.devicePixelRatio || 1;
    const [dx, dy] = [event.clientX - held.x, event.clientY - held.y];
    this.moved += Math.hypot(dx, dy);
    const others = [...this.down].filter(([id]) => id !== event.pointerId).map(([, each]) => each);
    this.down.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (this.grasped) {
      this.stage.hand?.move(event);
      return;
    }
    if (others.length) {
      const [other] = others;
      const before = Math.hypot(held.x - other.x, held.y - other.y);
      const factor = Math.hypot(event.clientX - other.x, event.clientY - other.y) / before;
      if (Number.isFinite(factor) && factor > 0) this.stage.zoom(factor, ...this.stage.spot(event));
      this.stage.drag((dx / 2) * ratio, (dy / 2) * ratio);
    } else if (this.moved >= STILL) this.stage.drag(dx * ratio, dy * ratio);
  }
}
