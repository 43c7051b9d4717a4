/** Player: stage, clock, controls and keys, wired to each other. */

import { Controls, part } from "./controls.js";
import { listenToKeys } from "./keys.js";
import { Plots } from "./plots.js";
import { Stage } from "./stage.js";

/** @typedef {import("./scene.js").Scene} Scene */

/**
 * @typedef {{version: string, title: string, view: "player" | "gallery" | "live",
 *   themes: Record<string, import("./shapes.js").Palette>}} Settings
 */

/** Give what the page was written with. @returns {Settings} */
export function settingsOf() {
  return JSON.parse(part("settings", HTMLScriptElement).textContent ?? "");
}

/** Give the theme that its reader prefers, and show it. @returns {string} */
export function preferredTheme() {
  const theme = matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark";
  document.documentElement.dataset.theme = theme;
  return theme;
}

/**
 * Wire a player for some scenes. charts: whether what was measured is plotted below.
 * @param {Scene[]} scenes @param {import("./clock.js").Clock} clock @param {Settings} settings @param {string} theme
 * @param {boolean} [charts]
 */
export function play(scenes, clock, settings, theme, charts = true) {
  const parts = {
    canvas: part("stage", HTMLCanvasElement),
    labels: part("labels", HTMLElement),
    card: part("card", HTMLElement),
  };
  const stage = new Stage(parts, scenes, clock, settings.themes);
  stage.theme = theme;
  const controls = new Controls(stage, clock);
  const recordings = charts ? scenes.map(({ recording }) => recording) : [];
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
