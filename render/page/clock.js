/** Clock: the time that is shown [ticks], and how it passes. */

import { HOLD } from "./scene.js";

/** Ticks a second at speed 1: those of a film. */
export const PACE = 10;

/** Speeds to choose from, from a tenth to twenty times a film's. */
export const SPEEDS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20];

export class Clock {
  /** @param {number} last the last tick */
  constructor(last) {
    this.last = last;
    this.time = 0;
    this.speed = 1;
    this.playing = false;
    this.loop = false;
    /** @type {(() => void)[]} */
    this.watchers = [];
  }

  /** The tick that is shown, with its fraction. */
  get shown() {
    return Math.min(this.time, this.last);
  }

  /** Call something whenever the clock is touched. @param {() => void} watcher */
  watch(watcher) {
    this.watchers.push(watcher);
  }

  _tell() {
    for (const watcher of this.watchers) watcher();
  }

  /** Let time pass. @param {number} seconds @returns {boolean} whether anything changed */
  pass(seconds) {
    if (!this.playing) return false;
    this.time += seconds * PACE * this.speed;
    if (this.time < this.last + HOLD) return true;
    this.time = this.loop ? 0 : this.last + HOLD;
    if (!this.loop) this.pause();
    return true;
  }

  play() {
    if (this.time >= this.last) this.time = 0;
    this.playing = true;
    this._tell();
  }

  pause() {
    this.playing = false;
    this._tell();
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  /** Go to a tick and stay there unless playing. @param {number} time */
  seek(time) {
    this.time = Math.min(Math.max(time, 0), this.last);
    this._tell();
  }

  /** Go some whole ticks on, or back, and stay. @param {number} ticks */
  step(ticks) {
    this.playing = false;
    const shown = Math.min(this.time, this.last);
    this.seek((ticks > 0 ? Math.floor(shown) : Math.ceil(shown)) + ticks);
  }

  /** @param {number} speed */
  pace(speed) {
    this.speed = Math.min(Math.max(speed, SPEEDS[0]), SPEEDS[SPEEDS.length - 1]);
    this._tell();
  }

  /** Choose the next speed up or down. @param {number} way */
  shift(way) {
    const faster = SPEEDS.find((each) => each > this.speed * 1.001);
    const slower = [...SPEEDS].reverse().find((each) => each < this.speed * 0.999);
    this.pace((way > 0 ? faster : slower) ?? this.speed);
  }
}
