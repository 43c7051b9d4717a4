/** Stage: the canvas that scenes are drawn on, side by side, and what pointers do there. */

import { reachOf } from "./agents.js";
import { Orbit } from "./camera.js";
import { fillCard } from "./card.js";
import { FlatPainter } from "./flat.js";
import { areaHue } from "./ground.js";
import { TERM_HUES } from "./overlays.js";
import { Pointers } from "./pointers.js";
import { colour } from "./shapes.js";
import { WebGlPainter } from "./webgl.js";

/** @typedef {import("./scene.js").Scene} Scene */

/** @typedef {import("./camera.js").Flat} Flat */

/** How near to an agent a pointer must be [CSS px], a finger less exactly. */
const NEAR = 16,
  FINGER = 30;

/** Room above each of several scenes for its name [CSS px]. */
const HEAD = 30;

/**
 * @typedef {{scene: number, agent: number}} Looked
 * @typedef {{grasp(event: PointerEvent): boolean, move(event: PointerEvent): void, release(event: PointerEvent): void,
 *   tap(event: PointerEvent): boolean, busy: boolean}} Hand
 */

export class Stage {
  /**
   * @param {{canvas: HTMLCanvasElement, labels: HTMLElement, card: HTMLElement}} parts @param {Scene[]} scenes
   * @param {import("./clock.js").Clock} clock @param {Record<string, import("./shapes.js").Palette>} themes
   */
  constructor({ canvas, labels, card }, scenes, clock, themes) {
    this.canvas = canvas;
    this.labels = labels;
    this.card = card;
    this.scenes = scenes;
    this.clock = clock;
    this.themes = themes;
    this.theme = "dark";
    /** @type {Set<string>} */
    this.switches = new Set(["trails"]);
    /** The agent under the pointer, and the one that was chosen. @type {Looked} */
    this.hovered = { scene: 0, agent: -1 };
    /** @type {Looked} */
    this.chosen = { scene: 0, agent: -1 };
    this.following = false;
    /** What pointers do in a world that runs: each tells whether it was meant. @type {Hand | null} */
    this.hand = null;
    this.painter = WebGlPainter.on(canvas) ?? new FlatPainter(canvas);
    /** Seconds that the last frames took. @type {number[]} */
    this.took = [];
    this.stale = true;
    /** Pixels per unit of type. */
    this.unit = 1;
    /** @type {(() => void)[]} */
    this.watchers = [];
    this._listen();
  }

  get palette() {
    return this.themes[this.theme];
  }

  get hues() {
    return this.theme === "light" ? TERM_HUES.light : TERM_HUES.dark;
  }

  /** What a card and arrows are shown of. */
  get looked() {
    return this.hovered.agent >= 0 ? this.hovered : this.chosen;
  }

  /** Take the room there is: windows side by side, or one above the other. */
  resize() {
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [Math.round(this.canvas.clientWidth * ratio), Math.round(this.canvas.clientHeight * ratio)];
    if (!width || !height) return;
    if (this.canvas.width !== width || this.canvas.height !== height) [this.canvas.width, this.canvas.height] = [width, height];
    const count = this.scenes.length;
    const { low, high } = this.scenes[0].lens.extent;
    const aspect = (high[0] - low[0]) / Math.max(high[1] - low[1], 1e-9);
    let [columns, best] = [1, 0];
    for (let n = 1; n <= count; n++) {
      const [w, h] = [width / n, height / Math.ceil(count / n)];
      const scale = Math.min(w / aspect, h);
      if (scale > best) [columns, best] = [n, scale];
    }
    const rows = Math.ceil(count / columns);
    this.scenes.forEach((scene, n) => {
      const [column, row] = [n % columns, Math.floor(n / columns)];
      const [x, y] = [Math.round((column * width) / columns), Math.round((row * height) / rows)];
      const head = count > 1 ? Math.round(HEAD * ratio) : 0;
      scene.rect = { x, y: y + head, width: Math.round(width / columns), height: Math.round(height / rows) - head };
    });
    const cell = Math.min(width / columns, (height / rows) * 1.4);
    this.unit = Math.min(Math.max(cell / 900, 0.72 * ratio), 2.4 * ratio);
    this.stale = true;
  }

  /** Draw a frame. */
  draw() {
    const started = performance.now();
    const { clock, palette, unit } = this;
    if (this.following && this.chosen.agent >= 0) this._follow();
    this.scenes.forEach((scene, n) => {
      const looked = n === this.looked.scene ? this.looked.agent : -1;
      scene.frame(clock.time, { theme: palette, unit, switches: this.switches, looked, hues: this.hues });
    });
    this.painter.paint(this.scenes, colour(palette.backdrop));
    this._label();
    this._show();
    this.took.push((performance.now() - started) / 1000);
    if (this.took.length > 120) this.took.shift();
    this.stale = false;
  }

  _follow() {
    const scene = this.scenes[this.chosen.scene];
    scene.paths.load(this.clock.time);
    const { dim } = scene.recording;
    scene.lens.follow(scene.paths.spot.subarray(this.chosen.agent * dim, (this.chosen.agent + 1) * dim));
  }

  /** Write names of areas and of scenes over the picture. */
  _label() {
    const ratio = window.devicePixelRatio || 1;
    /** @type {[string, number, number, string, string][]} */
    const wanted = [];
    for (const { recording, lens, rect } of this.scenes) {
      const { areas, label } = recording.header;
      if (this.scenes.length > 1) wanted.push([label, rect.x, rect.y - HEAD * ratio, this.palette.ink, "scene"]);
      if (lens instanceof Orbit) continue;
      for (const area of areas) {
        lens.place(area.low[0], area.high[1]);
        const [x, y] = [lens.x, lens.y];
        lens.place(area.high[0], area.low[1]);
        const inside = x > rect.x - 9 && x < rect.x + rect.width && y > rect.y - 9 && y < rect.y + rect.height;
        const roomy = lens.x - x > 110 * ratio;
        if (inside && roomy) wanted.push([area.label, x, y, areaHue(area.label, this.palette), "area"]);
      }
    }
    while (this.labels.children.length > wanted.length) this.labels.lastChild?.remove();
    wanted.forEach(([words, x, y, hue, kind], n) => {
      const there = this.labels.children[n] ?? this.labels.appendChild(document.createElement("span"));
      const label = /** @type {HTMLElement} */ (there);
      if (label.textContent !== words) label.textContent = words;
      label.dir = "auto";
      label.className = kind;
      label.style.color = hue;
      label.style.transform = `translate(${x / ratio}px, ${y / ratio}px)`;
    });
  }

  /** Show the card of what is looked at, beside it. */
  _show() {
    const { scene: n, agent } = this.looked;
    const scene = this.scenes[n];
    this.card.hidden = agent < 0;
    if (agent < 0 || !scene) return;
    const tick = scene.paths.tick(this.clock.time);
    const said = `${n} ${agent} ${tick} ${this.theme}`;
    if (this.card.dataset.said !== said) fillCard(this.card, scene.recording, agent, tick, this.hues);
    this.card.dataset.said = said;
    const ratio = window.devicePixelRatio || 1;
    const [x, y] = this.pixel(n, agent).map((each) => each / ratio);
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const [w, h] = [this.card.offsetWidth, this.card.offsetHeight];
    const ring = scene.view ? reachOf(scene.view, agent) / ratio : 0;
    const aside = Math.min(20 + 2.5 * ring, width / 5);
    const left = x + aside + w < width ? x + aside : Math.max(x - aside - w, 4);
    const top = Math.min(Math.max(y - h / 2, 4), Math.max(height - h - 4, 4));
    this.card.style.transform = `translate(${Math.min(left, Math.max(width - w - 4, 0))}px, ${top}px)`;
  }

  /** Give where an agent is on the canvas [canvas px]. @param {number} scene @param {number} agent @returns {number[]} */
  pixel(scene, agent) {
    const { paths, lens, recording } = this.scenes[scene];
    const at = agent * recording.dim;
    lens.place(paths.spot[at], paths.spot[at + 1], recording.dim > 2 ? paths.spot[at + 2] : 0);
    return [lens.x, lens.y];
  }

  /** Find the agent under a pointer. @param {PointerEvent} event @returns {Looked} */
  _under(event) {
    const [x, y, scene] = this.spot(event);
    const within = (event.pointerType === "touch" ? FINGER : NEAR) * (window.devicePixelRatio || 1);
    return { scene, agent: this.scenes[scene].pick(x, y, within, this.clock.time) };
  }

  /**
   * Give a pointer's place [canvas px] and the scene under it.
   * @param {MouseEvent} event @returns {[number, number, number]}
   */
  spot(event) {
    const [box, ratio] = [this.canvas.getBoundingClientRect(), window.devicePixelRatio || 1];
    const [x, y] = [(event.clientX - box.left) * ratio, (event.clientY - box.top) * ratio];
    const over = this.scenes.findIndex(({ rect: r }) => x >= r.x && x < r.x + r.width && y >= r.y && y < r.y + r.height);
    return [x, y, Math.max(over, 0)];
  }

  /** Choose an agent, or none by -1. @param {number} agent @param {number} [scene] */
  choose(agent, scene = this.chosen.scene) {
    this.chosen = { scene, agent };
    if (agent < 0) this.following = false;
    this.touched();
  }

  /** Zoom all scenes about a pixel of one. @param {number} factor @param {number} x @param {number} y @param {number} [at] */
  zoom(factor, x, y, at = 0) {
    const from = this.scenes[at].rect;
    for (const { lens, rect } of this.scenes) lens.closer(factor, x - from.x + rect.x, y - from.y + rect.y);
    this.touched();
  }

  /** Show everything again. */
  home() {
    for (const scene of this.scenes) {
      scene.held = false;
      scene.lens.home();
    }
    this.following = false;
    this.touched();
  }

  /** Draw anew at the next chance, and tell who watches. */
  touched() {
    this.stale = true;
    for (const watcher of this.watchers) watcher();
  }

  _listen() {
    new Pointers(this);
    this.canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    this.canvas.addEventListener("webglcontextrestored", () => {
      this.painter = WebGlPainter.on(this.canvas) ?? this.painter;
      this.stale = true;
    });
    this.canvas.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        this.zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)), ...this.spot(event));
      },
      { passive: false },
    );
    this.canvas.addEventListener("dblclick", () => this.home());
  }

  /** @param {PointerEvent} event */
  hover(event) {
    const found = event.pointerType === "touch" ? { scene: 0, agent: -1 } : this._under(event);
    if (found.agent === this.hovered.agent && found.scene === this.hovered.scene) return;
    this.hovered = found;
    this.stale = true;
  }

  /** @param {PointerEvent} event */
  tap(event) {
    const found = this._under(event);
    const again = found.agent === this.chosen.agent && found.scene === this.chosen.scene;
    this.choose(again ? -1 : found.agent, found.scene);
  }

  /** Drag all scenes. @param {number} dx @param {number} dy canvas px */
  drag(dx, dy) {
    for (const scene of this.scenes) {
      scene.held = true;
      scene.lens.drag(dx, dy);
    }
    if (!(this.scenes[0].lens instanceof Orbit)) this.following = false;
    this.touched();
  }
}
