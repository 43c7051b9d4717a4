/** Pulse: the connection to the simulation, its clock, and how both are told what their reader does. */

import { Clock, PACE } from "./clock.js";
import { readFrame } from "./window.js";

/** @typedef {import("./window.js").Window} Window */

/** Milliseconds until a lost connection is tried again. */
const AGAIN = 1500;

/** Ticks that the picture may lag behind the newest: one is being walked through, half a one makes up for uneven arrivals. */
const LAG = 1.5;

/** A connection that comes back. */
export class Wire {
  /**
   * @param {(message: {kind: string} & Record<string, any>) => void} told
   * @param {(frame: import("./window.js").Frame) => void} shown
   * @param {(open: boolean) => void} changed
   */
  constructor(told, shown, changed) {
    this.told = told;
    this.shown = shown;
    this.changed = changed;
    /** @type {WebSocket | null} */
    this.socket = null;
    this._open();
  }

  _open() {
    const socket = new WebSocket(new URL("socket", location.href.replace(/^http/, "ws")));
    this.socket = socket;
    socket.binaryType = "arraybuffer";
    socket.addEventListener("open", () => this.changed(true));
    socket.addEventListener("message", ({ data }) => {
      if (typeof data === "string") this.told(JSON.parse(data));
      else {
        this.send({ act: "seen" });
        this.shown(readFrame(data));
      }
    });
    socket.addEventListener("close", () => {
      this.changed(false);
      setTimeout(() => this._open(), AGAIN);
    });
  }

  /** Tell the simulation something. @param {Record<string, unknown>} message */
  send(message) {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }
}

/** The clock of a simulation that runs elsewhere: `time` counts rows of the window, and follows the newest. */
export class LiveClock extends Clock {
  /** @param {Wire} wire */
  constructor(wire) {
    super(0);
    this.wire = wire;
    /** @type {Window | null} */
    this.window = null;
    /** Rows that a reader has gone back from the newest. */
    this.back = 0;
    this.fresh = false;
  }

  /** Follow another window. @param {Window} window */
  follow(window) {
    this.window = window;
    this.last = window.live.ticks;
    this.time = window.ticks;
    this.back = 0;
    this.fresh = true;
  }

  /** A row came in, and some were forgotten. @param {number} forgotten */
  arrived(forgotten) {
    this.time -= forgotten;
    this.back = 0;
    this.fresh = true;
  }

  get shown() {
    return this.window ? this.window.tickAt(this.time) : 0;
  }

  /** @param {number} seconds @returns {boolean} */
  pass(seconds) {
    if (!this.window) return false;
    const before = this.time;
    const newest = this.window.ticks;
    if (this.back || !this.playing || this.window.gap > 1) this.time = newest - this.back;
    else this.time = Math.min(Math.max(this.time + seconds * PACE * this.speed, newest - LAG, 0), newest);
    const changed = this.fresh || this.time !== before;
    this.fresh = false;
    return changed;
  }

  play() {
    this._wish(true);
  }

  pause() {
    this._wish(false);
  }

  /** @param {boolean} on */
  _wish(on) {
    this.wire.send({ act: "play", on });
    this.heed(on, this.speed);
  }

  /** Hear how the simulation runs. @param {boolean} playing @param {number} speed */
  heed(playing, speed) {
    this.playing = playing;
    this.speed = speed;
    if (playing) this.back = 0;
    this._tell();
  }

  /** Look back at one of the rows that are kept. @param {number} time */
  seek(time) {
    if (!this.window) return;
    if (this.playing) this._wish(false);
    this.back = Math.min(Math.max(this.window.ticks - time, 0), this.window.ticks);
    this._tell();
  }

  /** @param {number} ticks */
  step(ticks) {
    if (!this.window) return;
    if (ticks > 0 && !this.back) {
      if (this.playing) this._wish(false);
      this.wire.send({ act: "step" });
    } else this.seek(this.window.ticks - Math.max(this.back - ticks, 0));
  }

  /** @param {number} speed */
  pace(speed) {
    super.pace(speed);
    this.wire.send({ act: "speed", speed: this.speed });
  }
}
