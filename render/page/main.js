/** Main: read what the page holds, and show it. */

import { Clock } from "./clock.js";
import { part } from "./controls.js";
import { decoded } from "./decode.js";
import { fillGallery } from "./gallery.js";
import { play, preferredTheme, settingsOf } from "./player.js";
import { Scene } from "./scene.js";

/** @typedef {import("./decode.js").Recording} Recording */

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
  const settings = settingsOf();
  const theme = preferredTheme();
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
  /** @type {Recording[]} */
  const recordings = [];
  for (const n of chosen) recordings.push(await shelf.read(n));
  const scenes = recordings.map((recording) => new Scene(recording, recordings));
  const clock = new Clock(Math.max(...recordings.map(({ ticks }) => ticks)));
  const player = play(scenes, clock, settings, theme);
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
