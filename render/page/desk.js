/** Desk: sliders, numbers and menus for all that may be turned, as the strategies' own declarations describe it. */

import { part } from "./controls.js";

/**
 * @typedef {{path: string, group: "world" | "prey" | "predators", owner: string, name: string, value: number | string,
 *   words: string, unit: string, low: number, high: number, step: number, names: Record<string, string> | null,
 *   anew: boolean, builds: boolean}} Knob
 */

/** Milliseconds after a reader's own turn within which an echo of an earlier one does not move a slider back. */
const OWN = 600;

const HEADS = { world: "World", prey: "Prey", predators: "Predators" };

/** Write a name as people do. @param {string} name */
function plainly(name) {
  return name.replace(/_/g, " ");
}

export class Desk {
  /** @param {(path: string, value: number | string) => void} turn called with what a reader turns */
  constructor(turn) {
    this.place = part("knobs", HTMLElement);
    this.turn = turn;
    /** @type {Map<string, (value: number | string) => void>} */
    this.shows = new Map();
    /** What was turned, and not sent yet. @type {Map<string, number | string>} */
    this.waiting = new Map();
    /** When each was turned last. @type {Map<string, number>} */
    this.turned = new Map();
  }

  /** Write the knobs of a scenario; what was folded stays so. @param {Knob[]} knobs */
  fill(knobs) {
    const focus = document.activeElement instanceof HTMLElement ? document.activeElement.id : "";
    const folded = new Map([...this.place.querySelectorAll("details")].map((each) => [each.id, each.open]));
    this.shows.clear();
    const boxes = [];
    for (const group of /** @type {const} */ (["prey", "predators", "world"])) {
      const own = knobs.filter((knob) => knob.group === group);
      if (!own.length) continue;
      const box = this._box(`knobs-${group}`, HEADS[group], folded.get(`knobs-${group}`) ?? true);
      const shared = this._box(`shared-${group}`, "Flocking and bodies", folded.get(`shared-${group}`) ?? false);
      for (const knob of own) (group === "world" || knob.owner || knob.builds ? box : shared).append(this._row(knob));
      if (shared.querySelector("input")) box.append(shared);
      boxes.push(box);
    }
    this.place.replaceChildren(...boxes);
    if (focus.startsWith("knob-")) document.getElementById(focus)?.focus();
  }

  /** @param {string} id @param {string} words @param {boolean} open */
  _box(id, words, open) {
    const box = document.createElement("details");
    const head = document.createElement("summary");
    box.id = id;
    box.open = open;
    head.textContent = words;
    box.append(head);
    return box;
  }

  /** @param {Knob} knob */
  _row(knob) {
    const row = document.createElement("div");
    const name = document.createElement("label");
    row.className = "knob";
    name.textContent = plainly(knob.name);
    name.htmlFor = `knob-${knob.path}`;
    row.append(name);
    if (knob.names) this._menu(row, knob);
    else this._slider(row, knob);
    const said = document.createElement("small");
    said.dir = "auto";
    said.id = `said-${knob.path}`;
    said.textContent = this._words(knob);
    row.append(said);
    return row;
  }

  /** @param {Knob} knob */
  _words({ names, value, words, owner }) {
    const told = names?.[String(value)] || words;
    return owner && told ? `${owner}: ${told}` : told;
  }

  /** @param {HTMLElement} row @param {Knob} knob */
  _menu(row, knob) {
    const menu = document.createElement("select");
    menu.id = `knob-${knob.path}`;
    for (const name of Object.keys(knob.names ?? {})) menu.add(new Option(name, name));
    menu.value = String(knob.value);
    menu.setAttribute("aria-describedby", `said-${knob.path}`);
    menu.addEventListener("change", () => this._turn(knob.path, menu.value, true));
    this.shows.set(knob.path, (value) => (menu.value = String(value)));
    row.append(menu);
  }

  /** @param {HTMLElement} row @param {Knob} knob */
  _slider(row, knob) {
    const [slider, number] = [document.createElement("input"), document.createElement("input")];
    const unit = document.createElement("span");
    slider.type = "range";
    slider.id = `knob-${knob.path}`;
    slider.setAttribute("aria-describedby", `said-${knob.path}`);
    [slider.min, slider.max, slider.step] = [knob.low, knob.high, knob.step].map(String);
    number.type = "number";
    number.step = "any";
    number.setAttribute("aria-label", `${plainly(knob.name)}, as a number${knob.unit ? ` [${knob.unit}]` : ""}`);
    unit.className = "unit";
    unit.textContent = knob.unit;
    const show = (/** @type {number | string} */ value) => {
      slider.value = String(value);
      number.value = String(Number(Number(value).toPrecision(6)));
      const share = (Number(slider.value) - knob.low) / (knob.high - knob.low || 1);
      slider.style.setProperty("--done", `${100 * share}%`);
    };
    slider.addEventListener("input", () => {
      show(slider.value);
      if (!knob.anew) this._turn(knob.path, Number(slider.value));
    });
    slider.addEventListener("change", () => this._turn(knob.path, Number(slider.value), knob.anew));
    number.addEventListener("change", () => {
      if (number.value === "") return;
      const value = Number(number.value);
      show(value);
      this._turn(knob.path, value);
    });
    show(knob.value);
    this.shows.set(knob.path, show);
    row.append(number, unit, slider);
  }

  /**
   * Tell what was turned, at most once a frame.
   * @param {string} path @param {number | string} value @param {boolean} [now]
   */
  _turn(path, value, now = false) {
    this.turned.set(path, performance.now());
    if (now) {
      this.waiting.delete(path);
      this.turn(path, value);
      return;
    }
    if (!this.waiting.size) requestAnimationFrame(() => this._send());
    this.waiting.set(path, value);
  }

  _send() {
    for (const [path, value] of this.waiting) this.turn(path, value);
    this.waiting.clear();
  }

  /**
   * Show numbers as they are now.
   * @param {Record<string, number | string>} values @param {boolean} [own] those just turned, too
   */
  show(values, own = false) {
    const now = performance.now();
    for (const [path, value] of Object.entries(values)) {
      if (own || now - (this.turned.get(path) ?? -OWN) >= OWN) this.shows.get(path)?.(value);
    }
  }
}
