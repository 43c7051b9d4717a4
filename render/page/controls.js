/** Controls: buttons, the scrub bar with its marks, switches and menus. */

import { tally } from "./agents.js";
import { CAPTURED, CRASHED, FATES } from "./decode.js";
import { SPEEDS } from "./clock.js";

/** @template {HTMLElement} T @param {string} id @param {new () => T} kind @returns {T} */
export function part(id, kind) {
  const found = document.getElementById(id);
  if (!(found instanceof kind)) throw new Error(`the page lacks ${id}`);
  return found;
}

/** Switches that a recording must have something for: [name, words, what it needs]. */
const SWITCHES = /** @type {const} */ ([
  ["trails", "Trails"],
  ["perception", "Perception"],
  ["links", "Links"],
  ["field", "Avoidance field"],
  ["coverage", "Swept ground"],
]);

export class Controls {
  /** @param {import("./stage.js").Stage} stage @param {import("./clock.js").Clock} clock */
  constructor(stage, clock) {
    this.stage = stage;
    this.clock = clock;
    this.play = part("play", HTMLButtonElement);
    this.scrub = part("scrub", HTMLInputElement);
    this.marks = part("marks", HTMLCanvasElement);
    this.when = part("when", HTMLOutputElement);
    this.counts = part("counts", HTMLElement);
    this.speed = part("speed", HTMLSelectElement);
    this.agent = part("agent", HTMLSelectElement);
    this.follow = part("follow", HTMLInputElement);
    this.loop = part("loop", HTMLButtonElement);
    this.said = part("said", HTMLElement);
    this.help = part("help", HTMLDialogElement);
    this.fill();
    this._listen();
    clock.watch(() => this.show());
    stage.watchers.push(() => this._chosen());
  }

  /** Write menus, switches and words that depend on the recordings. */
  fill() {
    const { scenes, switches } = this.stage;
    const [{ recording }] = scenes;
    this.speed.replaceChildren();
    this.agent.replaceChildren();
    this.scrub.max = String(this.clock.last);
    for (const speed of SPEEDS) this.speed.add(new Option(`${speed}×`, String(speed)));
    this.speed.value = String(this.clock.speed);
    this.agent.add(new Option("nobody", "-1"));
    for (let agent = 0; agent < Math.min(recording.count, 2000); agent++) {
      this.agent.add(new Option(recording.name(agent), String(agent)));
    }
    const place = part("switches", HTMLElement);
    place.querySelectorAll("label").forEach((label) => label.remove());
    for (const [name, words] of SWITCHES) {
      if (name === "field" && !scenes.some(({ recording: each }) => each.field.length)) continue;
      if (name === "coverage" && (recording.dim > 2 || recording.counts)) continue; // all ticks must be known
      const label = document.createElement("label");
      const box = document.createElement("input");
      box.type = "checkbox";
      box.id = `switch-${name}`;
      box.checked = switches.has(name) || (name === "coverage" && recording.header.swept !== null);
      if (box.checked) switches.add(name);
      box.addEventListener("change", () => {
        if (box.checked) switches.add(name);
        else switches.delete(name);
        this.stage.touched();
      });
      label.append(box, words);
      place.append(label);
    }
    this._introduce();
  }

  /** Say who plays. */
  _introduce() {
    const { scenes } = this.stage;
    const [{ recording }] = scenes;
    const { header } = recording;
    part("title", HTMLElement).textContent = header.title;
    const parts = [header.source, header.preset, `seed ${header.seed}`, `trial ${header.trial}`];
    part("subtitle", HTMLElement).textContent = parts.filter(Boolean).join(" · ");
    const who = part("who", HTMLElement);
    who.replaceChildren();
    for (const kind of /** @type {const} */ (["prey", "predators"])) {
      const agents = header[kind];
      if (!agents.count) continue;
      const strategies = [...new Set(scenes.map(({ recording: each }) => each.header[kind].strategy))].join(" | ");
      const name = kind === "predators" && agents.count === 1 ? "predator" : kind;
      const avoidance = agents.avoidance && agents.avoidance !== "none" ? ` · ${agents.avoidance}` : "";
      const line = document.createElement("span");
      line.className = kind;
      line.textContent = `${agents.count} ${name}: ${strategies}${scenes.length > 1 ? "" : avoidance}`;
      who.append(line);
    }
  }

  _listen() {
    const { clock, stage } = this;
    const press = (/** @type {string} */ id, /** @type {() => void} */ act) =>
      part(id, HTMLButtonElement).addEventListener("click", act);
    press("play", () => clock.toggle());
    press("back", () => clock.step(-1));
    press("on", () => clock.step(1));
    press("loop", () => this.toggleLoop());
    press("closer", () => this.zoom(1.4));
    press("farther", () => this.zoom(1 / 1.4));
    press("fit", () => stage.home());
    press("theme", () => this.toggleTheme());
    press("full", () => this.fullScreen());
    press("ask", () => this.help.showModal());
    this.help.addEventListener("click", (event) => event.target === this.help && this.help.close());
    this.scrub.addEventListener("input", () => clock.seek(Number(this.scrub.value)));
    this.speed.addEventListener("change", () => clock.pace(Number(this.speed.value)));
    this.agent.addEventListener("change", () => stage.choose(Number(this.agent.value), 0));
    this.follow.addEventListener("change", () => {
      stage.following = this.follow.checked && stage.chosen.agent >= 0;
      this.follow.checked = stage.following;
      stage.stale = true;
    });
  }

  /** Zoom about the middle. @param {number} factor */
  zoom(factor) {
    const { rect } = this.stage.scenes[0];
    this.stage.zoom(factor, rect.x + rect.width / 2, rect.y + rect.height / 2);
  }

  toggleLoop() {
    this.clock.loop = !this.clock.loop;
    this.loop.setAttribute("aria-pressed", String(this.clock.loop));
  }

  toggleTheme() {
    const { stage } = this;
    stage.theme = stage.theme === "dark" ? "light" : "dark";
    document.documentElement.dataset.theme = stage.theme;
    stage.touched();
    this.drawMarks();
  }

  fullScreen() {
    if (document.fullscreenElement) document.exitFullscreen();
    else document.documentElement.requestFullscreen?.().catch(() => this.say("this browser keeps the page in its window"));
  }

  /** Choose the next agent, or the one before. @param {number} way */
  nextAgent(way) {
    const { stage } = this;
    const count = stage.scenes[stage.chosen.scene].recording.count + 1;
    stage.choose(((stage.chosen.agent + 1 + way + count) % count) - 1);
  }

  toggleFollow() {
    this.follow.checked = !this.follow.checked;
    this.follow.dispatchEvent(new Event("change"));
  }

  /** Tell listeners of screen readers something. @param {string} words */
  say(words) {
    this.said.textContent = words;
  }

  /** Show what was chosen. */
  _chosen() {
    const { chosen, following, scenes } = this.stage;
    const value = chosen.scene === 0 ? String(chosen.agent) : "-1";
    if (this.agent.value !== value) this.agent.value = value;
    this.follow.checked = following;
    this.follow.disabled = chosen.agent < 0;
    if (chosen.agent >= 0) this.say(`${scenes[chosen.scene].recording.name(chosen.agent)} chosen`);
  }

  /** Show the clock. */
  show() {
    const { clock } = this;
    const name = clock.playing ? "Pause" : "Play";
    if (this.play.getAttribute("aria-label") !== name) {
      this.play.setAttribute("aria-label", name);
      this.play.classList.toggle("playing", clock.playing);
    }
    if (this.speed.value !== String(clock.speed)) this.speed.value = String(clock.speed);
    this.passed();
    if (!clock.playing) this.say(this.scrub.getAttribute("aria-valuetext") ?? "");
  }

  /** Show how far time has come. */
  passed() {
    const { clock, stage } = this;
    const time = clock.shown;
    const { dt } = stage.scenes[0].recording.header;
    this.scrub.value = String(Math.floor(time));
    const words = `tick ${Math.floor(time)} of ${clock.last}`;
    this.scrub.setAttribute("aria-valuetext", words);
    this.when.textContent = `${(time * dt).toFixed(1)} s · tick ${Math.floor(time)}`;
    const shares = clock.last ? time / clock.last : 1;
    this.scrub.style.setProperty("--done", `${100 * shares}%`);
    const counts = stage.scenes.map(({ recording }) => tally(recording, clock.time));
    FATES.forEach((_, fate) => {
      const cell = /** @type {HTMLElement} */ (this.counts.children[fate]);
      const number = /** @type {HTMLElement} */ (cell.firstElementChild);
      const said = counts.map((count) => count[fate]).join(" | ");
      if (number.textContent !== said) number.textContent = said;
    });
  }

  /** Mark captures, crashes and arrivals on the scrub bar. */
  drawMarks() {
    const { marks, stage, clock } = this;
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [Math.round(marks.clientWidth * ratio), Math.round(marks.clientHeight * ratio)];
    if (!width || !height) return;
    [marks.width, marks.height] = [width, height];
    const pen = /** @type {CanvasRenderingContext2D} */ (marks.getContext("2d"));
    const half = 3 * ratio;
    for (const { recording } of stage.scenes) {
      for (let agent = 0; agent < recording.prey; agent++) {
        if (!(recording.end[agent] <= recording.ticks)) continue;
        const x = half + (recording.end[agent] / Math.max(clock.last, 1)) * (width - 2 * half);
        const fate = recording.fate[agent];
        pen.fillStyle = pen.strokeStyle = stage.palette[FATES[fate]];
        this._mark(pen, fate, x, height / 2, half);
      }
    }
  }

  /** Draw a disc for an arrival, a ring for a capture, a cross for a crash: told apart without colours.
   * @param {CanvasRenderingContext2D} pen @param {number} fate @param {number} x @param {number} y @param {number} half */
  _mark(pen, fate, x, y, half) {
    pen.lineWidth = half * 0.6;
    pen.beginPath();
    if (fate === CRASHED) {
      pen.moveTo(x - half, y - half);
      pen.lineTo(x + half, y + half);
      pen.moveTo(x - half, y + half);
      pen.lineTo(x + half, y - half);
      pen.stroke();
    } else {
      pen.arc(x, y, half, 0, 2 * Math.PI);
      if (fate === CAPTURED) pen.stroke();
      else pen.fill();
    }
  }
}
