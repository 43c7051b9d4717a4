/** Live: a page whose simulation runs elsewhere on this machine, and is turned here. */

import { Cloud } from "./cloud.js";
import { part } from "./controls.js";
import { Desk } from "./desk.js";
import { WorldHand } from "./hand.js";
import { showOutcomes } from "./outcomes.js";
import { play, preferredTheme, settingsOf } from "./player.js";
import { LiveClock, Wire } from "./pulse.js";
import { Scene } from "./scene.js";
import { Window, WindowPaths } from "./window.js";

/** Milliseconds that a note stays. */
const NOTED = 8000;

class LivePage {
  constructor() {
    this.settings = settingsOf();
    this.theme = preferredTheme();
    /** @type {ReturnType<typeof play> | null} */
    this.player = null;
    /** @type {import("./window.js").LiveHeader | null} */
    this.header = null;
    /** @type {Scene | null} */
    this.scene = null;
    /** @type {Window | null} */
    this.window = null;
    /** @type {Record<string, number | string>} */
    this.values = {};
    /** The last change whose frame was drawn. */
    this.heard = -1;
    this.serial = 0;
    /** The change whose outcomes are shown. */
    this.settled = -1;
    this.noted = 0;
    /** @type {Record<string, any>} */
    this.state = {};
    this.desk = new Desk((path, value) => this.wire.send({ act: "set", path, value }));
    this.wire = new Wire(
      (message) => this.told(message),
      (frame) => this.shown(frame),
      (open) => this.connected(open),
    );
    this.clock = new LiveClock(this.wire);
    this._listen();
  }

  _listen() {
    const press = (/** @type {string} */ id, /** @type {() => void} */ act) =>
      part(id, HTMLButtonElement).addEventListener("click", act);
    press("again", () => this.wire.send({ act: "restart", seed: this.state.seed ?? 0 }));
    press("afresh", () => this.wire.send({ act: "restart" }));
    press("film", () => part("filming", HTMLDialogElement).showModal());
    press("copy", () => {
      const command = part("command", HTMLTextAreaElement);
      command.select();
      navigator.clipboard.writeText(command.value).catch(() => this.note("copy the command by hand: this browser keeps it"));
    });
  }

  /** @param {{kind: string} & Record<string, any>} message */
  told(message) {
    if (message.kind === "scene") this.header = /** @type {any} */ (message);
    else if (message.kind === "knobs") this.desk.fill(message.knobs);
    else if (message.kind === "values") this._values(message);
    else if (message.kind === "state") this._state(message);
    else if (message.kind === "trials") this._outcomes(/** @type {any} */ (message));
    else if (message.kind === "note") {
      this.note(message.words);
      if (message.wrong) this.desk.show(this.values, true);
    }
  }

  /** @param {Record<string, any>} message */
  _values({ values, serial, sizes, target, film }) {
    this.values = values;
    this.serial = serial;
    this.desk.show(values);
    part("command", HTMLTextAreaElement).value = film;
    const header = this.scene?.recording.header;
    if (!header) return;
    Object.assign(header.prey, sizes.prey);
    Object.assign(header.predators, sizes.predators);
    if (header.target && target && !this.player?.stage.hand?.busy) header.target.position = target;
    if (this.player) this.player.stage.stale = true;
  }

  /** @param {{serial: number} & Parameters<typeof showOutcomes>[0]} told */
  _outcomes(told) {
    this.settled = told.serial;
    showOutcomes(told);
  }

  /** @param {Record<string, any>} state */
  _state(state) {
    this.state = state;
    this.clock.heed(state.playing, state.speed);
    const building = part("building", HTMLElement);
    building.hidden = !state.building;
    building.textContent = state.building ? `Compiling ${state.building}; what you see runs on until it is there.` : "";
  }

  /** @param {import("./window.js").Frame} frame */
  shown(frame) {
    if (!this.header || frame.scene !== this.header.scene) return;
    const fresh = this.scene?.recording !== this.window || this.window?.live !== this.header;
    if (fresh) this.window = new Window(this.header);
    const window = /** @type {Window} */ (this.window);
    const forgotten = window.push(frame);
    this.heard = frame.heard;
    if (fresh) this._begin(window, frame);
    else {
      if (this.scene?.paths instanceof WindowPaths) this.scene.paths.extend();
      this.scene?.cloud?.push(frame.cloud);
      this.clock.arrived(forgotten);
    }
  }

  /**
   * Show another trial, from where the last one was looked at.
   * @param {Window} window @param {import("./window.js").Frame} frame
   */
  _begin(window, frame) {
    const { header } = window;
    const before = this.scene;
    const paths = new WindowPaths(window);
    paths.extend();
    const scene = new Scene(window, [window], paths);
    scene.roams = header.sky && header.boundary === "open" && header.dim === 2;
    if (before && String(before.recording.header.size) === String(header.size)) {
      scene.lens = before.lens;
      scene.held = before.held;
    }
    if (window.live.cloud) {
      scene.cloud = new Cloud(window.live.cloud, header.dim, header.boundary === "periodic");
      scene.cloud.push(frame.cloud);
    }
    this.scene = scene;
    this.clock.follow(window);
    if (this.player) {
      const { stage, controls } = this.player;
      stage.scenes = [scene];
      stage.resize();
      stage.choose(stage.chosen.agent < window.count ? stage.chosen.agent : -1);
      controls.fill();
      controls.show();
    } else this._open(scene);
    this._introduce(window);
  }

  /** @param {Scene} scene */
  _open(scene) {
    document.body.dataset.view = "player";
    this.player = play([scene], this.clock, this.settings, this.theme, false);
    const { stage, controls } = this.player;
    stage.hand = new WorldHand(stage, (message) => this.wire.send(message));
    controls.show();
    if (matchMedia("(prefers-reduced-motion: reduce)").matches && this.clock.playing) this.clock.pause();
    /** For whoever scripts the page. */
    Object.assign(globalThis, { tiswarm: { ...this.player, page: this } });
    document.body.dataset.ready = "true";
  }

  /** Say how many a cloud stands for. @param {Window} window */
  _introduce(window) {
    const { cloud, prey } = window.live;
    part("drops", HTMLElement).hidden = window.dim > 2;
    if (!cloud) return;
    const line = document.createElement("span");
    line.className = "prey";
    line.textContent = `${cloud.count.toLocaleString("en")} prey: ${prey.strategy}`;
    part("who", HTMLElement).prepend(line);
  }

  /** @param {boolean} open */
  connected(open) {
    document.body.dataset.lost = String(!open);
    if (!open) this.note("The simulation is not there any more; start tiswarm live again, and open its new address.");
  }

  /** Say something for a while. @param {string} words */
  note(words) {
    const place = part("note", HTMLElement);
    place.textContent = words;
    place.hidden = false;
    clearTimeout(this.noted);
    this.noted = setTimeout(() => (place.hidden = true), NOTED);
  }
}

document.body.dataset.view = "failed";
part("title", HTMLElement).textContent = settingsOf().title;
part("failed", HTMLElement).textContent = "The simulation is starting; kernels that were never used are compiled first…";
part("version", HTMLElement).textContent = `tiswarm ${settingsOf().version}`;
new LivePage();
