/** Hand: what a pointer does in a world that runs: it drags the target, and drops obstacles and predators. */

import { part } from "./controls.js";

/** @typedef {import("./stage.js").Stage} Stage */

/** How near to the target a pointer takes hold of it [CSS px]. */
const HOLD_NEAR = 22;

/** Things that can be dropped, and the ids of their buttons. */
const DROPS = /** @type {const} */ (["obstacle", "predator"]);

export class WorldHand {
  /** @param {Stage} stage @param {(message: Record<string, unknown>) => void} send */
  constructor(stage, send) {
    this.stage = stage;
    this.send = send;
    /** What the next tap drops. @type {"obstacle" | "predator" | null} */
    this.tool = null;
    /** Where the target is dragged to. @type {number[] | null} */
    this.wanted = null;
    /** Whether the target is held. */
    this.busy = false;
    for (const kind of DROPS) {
      part(`drop-${kind}`, HTMLButtonElement).addEventListener("click", () => this.take(this.tool === kind ? null : kind));
    }
    part("drop-here", HTMLButtonElement).addEventListener("click", () => {
      const { rect } = stage.scenes[0];
      this._drop(this._metres(rect.x + rect.width / 2, rect.y + rect.height / 2));
    });
  }

  /** Take something to drop, or nothing. @param {"obstacle" | "predator" | null} kind */
  take(kind) {
    this.tool = kind;
    for (const each of DROPS) part(`drop-${each}`, HTMLButtonElement).setAttribute("aria-pressed", String(each === kind));
    part("drop-here", HTMLButtonElement).hidden = !kind;
    part("drop-hint", HTMLElement).hidden = !kind;
  }

  /** Give a pixel's place in a flat world, null in a deep one. @param {number} x @param {number} y */
  _metres(x, y) {
    const { lens } = this.stage.scenes[0];
    if (lens.deep) return null;
    return [lens.centre[0] + (x - lens.middle[0]) / lens.scale, lens.centre[1] - (y - lens.middle[1]) / lens.scale];
  }

  /** @param {number[] | null} place */
  _drop(place) {
    if (place && this.tool) this.send({ act: "drop", kind: this.tool, place });
  }

  /** @param {PointerEvent} event */
  grasp(event) {
    const { lens, recording } = this.stage.scenes[0];
    const { target } = recording.header;
    if (!target || lens.deep || this.tool) return false;
    const [x, y] = this.stage.spot(event);
    lens.place(target.position[0], target.position[1]);
    const within = Math.max(HOLD_NEAR * (window.devicePixelRatio || 1), target.radius * lens.scale);
    this.busy = Math.hypot(lens.x - x, lens.y - y) < within;
    return this.busy;
  }

  /** @param {PointerEvent} event */
  move(event) {
    const [x, y] = this.stage.spot(event);
    const { target } = this.stage.scenes[0].recording.header;
    const place = this._metres(x, y);
    if (!target || !place) return;
    if (!this.wanted) requestAnimationFrame(() => this._put());
    this.wanted = place;
    [target.position[0], target.position[1]] = place;
    this.stage.touched();
  }

  _put() {
    if (!this.wanted) return;
    const [x, y] = this.wanted.map((each) => Number(each.toFixed(3)));
    this.send({ act: "set", path: "target.position.0", value: x });
    this.send({ act: "set", path: "target.position.1", value: y });
    this.wanted = null;
  }

  /** @param {PointerEvent} event */
  release(event) {
    if (this.wanted) this.move(event);
    this.busy = false;
  }

  /** @param {PointerEvent} event */
  tap(event) {
    if (!this.tool) return false;
    const [x, y] = this.stage.spot(event);
    this._drop(this._metres(x, y));
    return true;
  }
}
