/** Gallery: many recordings at a glance, each a click away. */

import { tally } from "./agents.js";
import { FATES } from "./decode.js";
import { FlatPainter } from "./flat.js";
import { Scene } from "./scene.js";
import { colour } from "./shapes.js";
import { WebGlPainter } from "./webgl.js";

/** @typedef {import("./decode.js").Recording} Recording */

/** Size of posters [px]. */
const POSTER = [640, 360];

/** Say how a recording came out. @param {Recording} recording */
export function outcome(recording) {
  const counts = tally(recording, Infinity);
  const said = FATES.map((fate, n) => `${counts[n]} ${fate}`).filter((_, n) => counts[n]);
  return `${said.join(", ")} · ${recording.ticks} ticks`;
}

/** Give the time at which most is to be seen: the middle of what happens to the prey. @param {Recording} recording */
function liveliest({ end, prey, ticks }) {
  const ends = Array.from(end.subarray(0, prey)).filter((each) => each <= ticks);
  ends.sort((a, b) => a - b);
  return ends.length ? ends[Math.floor(ends.length / 2)] + 2 : ticks / 2;
}

/**
 * Draw a recording's poster, on the canvas that all posters are drawn on, and copy it.
 * @param {HTMLCanvasElement} poster @param {WebGlPainter | FlatPainter} painter
 * @param {Recording} recording @param {import("./shapes.js").Palette} theme
 */
function drawPoster(poster, painter, recording, theme) {
  const scene = new Scene(recording);
  scene.rect = { x: 0, y: 0, width: poster.width, height: poster.height };
  const look = { theme, unit: poster.width / 700, switches: new Set(["trails"]), looked: -1, hues: [] };
  scene.frame(liveliest(recording), look);
  painter.paint([scene], colour(theme.backdrop));
  poster.getContext("2d")?.drawImage(painter.canvas, 0, 0);
}

/**
 * Fill the gallery, one recording after the other, without keeping the page waiting.
 * @param {HTMLElement} place @param {{count: number, read: (n: number) => Promise<Recording>}} shelf
 * @param {import("./shapes.js").Palette} theme
 */
export async function fillGallery(place, shelf, theme) {
  place.replaceChildren();
  const easel = document.createElement("canvas");
  [easel.width, easel.height] = POSTER;
  const painter = WebGlPainter.on(easel) ?? new FlatPainter(easel);
  for (let n = 0; n < shelf.count; n++) {
    const link = document.createElement("a");
    link.href = `#recording=${n + 1}`;
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = POSTER;
    canvas.setAttribute("aria-hidden", "true");
    const [title, words] = [document.createElement("strong"), document.createElement("span")];
    title.dir = "auto";
    link.append(canvas, title, words);
    place.append(link);
    const recording = await shelf.read(n);
    title.textContent = recording.header.label || recording.header.title;
    words.textContent = outcome(recording);
    drawPoster(canvas, painter, recording, theme);
    await new Promise((resolve) => setTimeout(resolve));
  }
}
