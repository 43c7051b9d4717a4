/** Main: read what the page holds, and show it. */

import { Clock } from "./clock.js";
import { Controls, part } from "./controls.js";
import { decoded } from "./decode.js";
import { fillGallery } from "./gallery.js";
import { listenToKeys } from "./keys.js";
import { Plots } from "./plots.js";
import { Scene } from "./scene.js";
import { Stage } from "./stage.js";

/** @typedef {import("./decode.js").Recording} Recording */

/**
 * @typedef {{version: string, title: string, view: "player" | "gallery",
 *   themes: Record<string, import("./shapes.js").Palette>}} Settings
 */

/** The recordings that lie in the page, read when they are asked for. */
class Shelf {
  constructor() {
    this.headers = [...document.querySelectorAll("script.header")];
    this.numbers = [...document.querySelectorAll("script.numbers")];
    this.count = this.headers.length;
  }

  /** @param {number} n @returns {Promise<Recording>} */
  read(n) {
    return decoded(JSON.parse(this.headers[n].textContent ?? ""), this.numbers[n].textContent ?? "");
  }
}

/** What the address says behind "#": a recording of a gallery, a tick, an agent. */
function wanted() {
  const said = new URLSearchParams(location.hash.slice(1));
  return (/** @type {string} */ name) => (said.has(name) ? Number(said.get(name)) : NaN);
}

/** Wire a player for some recordings. @param {Recording[]} recordings @param {Settings} settings @param {string} theme */
function play(recordings, settings, theme) {
  const clock = new Clock(Math.max(...recordings.map(({ ticks }) => ticks)));
  const scenes = recordings.map((recording) => new Scene(recording, recordings));
  const parts = {
    canvas: part("stage", HTMLCanvasElement),
    labels: part("labels", HTMLElement),
    card: part("card", HTMLElement),
  };
  const stage = new Stage(parts, scenes, clock, settings.themes);
  stage.theme = theme;
  const controls = new Controls(stage, clock);
  const plots = new Plots(part("plots", HTMLElement), recordings, clock.last, (tick) => clock.seek(tick));
  listenToKeys(controls);
  const refit = () => {
    stage.resize();
    controls.drawMarks();
    plots.draw(clock.time, stage.palette);
  };
  new ResizeObserver(refit).observe(parts.canvas);
  clock.watch(() => stage.touched());
  stage.watchers.push(() => plots.draw(clock.time, stage.palette));
  refit();
  let before = performance.now();
  const tick = (/** @type {number} */ now) => {
    if (clock.pass(Math.min((now - before) / 1000, 0.25))) {
      stage.stale = true;
      controls.passed();
      plots.draw(clock.time, stage.palette);
    }
    before = now;
    if (stage.stale) stage.draw();
    requestAnimationFrame(tick);
  };
  requestAnimationFrame(tick);
  return { clock, stage, controls, plots };
}

/** Begin where the address says, or at the start. @param {ReturnType<typeof play>} player */
function begin({ clock, stage, controls }) {
  const asked = wanted();
  const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
  if (Number.isFinite(asked("tick"))) clock.seek(asked("tick"));
  else if (!calm) clock.play();
  if (Number.isFinite(asked("agent"))) stage.choose(Math.min(asked("agent"), stage.scenes[0].recording.count) - 1, 0);
  controls.show();
}

async function main() {
  const settings = /** @type {Settings} */ (JSON.parse(part("settings", HTMLScriptElement).textContent ?? ""));
  const theme = matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark";
  document.documentElement.dataset.theme = theme;
  const shelf = new Shelf();
  const asked = wanted()("recording");
  part("version", HTMLElement).textContent = `tiswarm ${settings.version}`;
  window.addEventListener("hashchange", () => location.reload());
  if (settings.view === "gallery" && !(asked >= 1 && asked <= shelf.count)) {
    document.body.dataset.view = "gallery";
    part("title", HTMLElement).textContent = settings.title;
    part("subtitle", HTMLElement).textContent = `${shelf.count} recordings`;
    const switched = part("theme", HTMLButtonElement);
    const chosen = () => settings.themes[document.documentElement.dataset.theme ?? theme];
    const fill = () => fillGallery(part("gallery", HTMLElement), shelf, chosen());
    switched.addEventListener("click", () => {
      document.documentElement.dataset.theme = document.documentElement.dataset.theme === "dark" ? "light" : "dark";
      fill();
    });
    await fill();
    document.body.dataset.ready = "true";
    return;
  }
  document.body.dataset.view = "player";
  part("overview", HTMLElement).hidden = settings.view !== "gallery";
  const chosen = settings.view === "gallery" ? [asked - 1] : shelf.headers.keys();
  const recordings = [];
  for (const n of chosen) recordings.push(await shelf.read(n));
  const player = play(recordings, settings, theme);
  begin(player);
  /** For whoever scripts the page: the clock, the stage and its scenes. */
  Object.assign(globalThis, { tiswarm: player });
  document.body.dataset.ready = "true";
}

main().catch((error) => {
  document.body.dataset.view = "failed";
  part("failed", HTMLElement).textContent = `This page cannot be shown: ${error.message}.`;
  throw error;
});
