/** Ground: what stands still: floor, grid, areas, edges, target and obstacles. */

import { Orbit } from "./camera.js";
import { colour, mixed } from "./shapes.js";

/** @typedef {import("./camera.js").Flat} Flat */

/** @typedef {import("./decode.js").Recording} Recording */

/**
 * What is drawn, and how: a frame in the making.
 * @typedef {{recording: Recording, paths: import("./paths.js").Paths, lens: Flat | Orbit, unit: number, time: number,
 *   theme: import("./shapes.js").Palette, switches: Set<string>, below: import("./shapes.js").Shapes,
 *   ribbons: import("./shapes.js").Ribbons, above: import("./shapes.js").Shapes, roams: boolean}} View
 */

const STEPS = [0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000];

const LINES = 12,
  WALL = 5;

/** Draw the ground. @param {View} view */
export function drawGround(view) {
  const { recording, lens, below: shapes, theme, unit } = view;
  if (lens instanceof Orbit) {
    room(view, lens);
    return;
  }
  const { header } = recording;
  lens.place(0, header.size[1]);
  const [x0, y0] = [lens.x, lens.y];
  lens.place(header.size[0], 0);
  const [x1, y1] = [lens.x, lens.y];
  floor(view, x0, y0, x1, y1);
  if (!header.sky || view.roams) grid(view, 0.06, unit / 2);
  for (const area of header.areas) {
    lens.place(area.low[0], area.high[1]);
    const [ax, ay] = [lens.x, lens.y];
    lens.place(area.high[0], area.low[1]);
    shapes.box(ax, ay, lens.x, lens.y, colour(areaHue(area.label, theme)), { alpha: theme.tint_alpha });
  }
  edge(view, x0, y0, x1, y1);
  if (header.target) target(view);
  for (const [x, y, radius] of header.obstacles) pebble(view, x, y, radius);
}

/**
 * Name the colour of an area, as films do.
 * @param {string} label @param {import("./shapes.js").Palette} theme @returns {string}
 */
export function areaHue(label, theme) {
  const words = label.toLowerCase();
  return theme[words.includes("danger") ? "danger" : words.includes("safe") ? "safe" : "line"];
}

/** @param {View} view @param {number} x0 @param {number} y0 @param {number} x1 @param {number} y1 */
function floor({ recording, lens, roams, below: shapes, theme, unit }, x0, y0, x1, y1) {
  const corner = 3 * unit;
  if (roams) {
    // Whoever leaves the world has the same sky everywhere.
    const { x, y, width, height } = lens.rect;
    shapes.box(x, y, x + width, y + height, colour(theme.sky[0]));
    shapes.box(x, y, x + width, y + height, colour(theme.sky[1]), { alpha: 0, below: 1 });
    return;
  }
  shapes.box(x0, y0, x1, y1, colour(theme.shadow), { alpha: theme.shadow_alpha * 0.7, corner: 2 * corner, soft: 28 * unit });
  if (recording.header.sky) {
    shapes.box(x0, y0, x1, y1, colour(theme.sky[0]), { corner });
    shapes.box(x0, y0, x1, y1, colour(theme.sky[1]), { alpha: 0, below: 1, corner });
    return;
  }
  shapes.box(x0, y0, x1, y1, colour(theme.world), { corner });
  const reach = Math.hypot(x1 - x0, y1 - y0) / 2;
  shapes.disc((x0 + x1) / 2, (y0 + y1) / 2, reach * 0.25, colour(theme.glow), theme.glow_alpha, reach * 1.5);
}

/** @param {View} view @param {number} x0 @param {number} y0 @param {number} x1 @param {number} y1 */
function edge({ recording, below: shapes, theme, unit }, x0, y0, x1, y1) {
  if (recording.header.boundary !== "walls") {
    shapes.box(x0, y0, x1, y1, colour(theme.line), { alpha: 0.22, corner: 3 * unit, stroke: 0.75 * unit });
    return;
  }
  const half = (WALL / 2) * unit;
  shapes.box(x0, y0, x1, y1, colour(theme.shadow), { alpha: 0.5 * theme.shadow_alpha, soft: 10 * unit, stroke: 2 * unit });
  const look = { corner: 2 * half, stroke: half };
  shapes.box(x0 - half, y0 - half, x1 + half, y1 + half, colour(theme.obstacle), look);
  const light = { alpha: 0.9, corner: 2 * half, stroke: 0.6 * unit };
  shapes.box(x0 - half, y0 - half, x1 + half, y1 + half, colour(theme.obstacle_light), light);
}

/** Draw lines at round numbers of metres. @param {View} view @param {number} alpha @param {number} half */
function grid({ recording, lens, roams, below: shapes, theme }, alpha, half) {
  const [width, height] = recording.header.size;
  let [x0, y0, x1, y1] = [0, 0, width, height];
  if (roams) {
    const [across, up] = [lens.rect.width / 2 / lens.scale, lens.rect.height / 2 / lens.scale];
    [x0, y0, x1, y1] = [lens.centre[0] - across, lens.centre[1] - up, lens.centre[0] + across, lens.centre[1] + up];
  }
  const most = Math.max(width, height);
  const step = STEPS.find((each) => most / each <= LINES) ?? STEPS[STEPS.length - 1];
  const line = (/** @type {number[]} */ [ax, ay, bx, by]) => {
    lens.place(ax, ay);
    const [px, py] = [lens.x, lens.y];
    lens.place(bx, by);
    shapes.capsule(px, py, lens.x, lens.y, half, half, colour(theme.line), alpha);
  };
  if (Math.max(x1 - x0, y1 - y0) / step > 100) return;
  for (let x = (Math.floor(x0 / step) + 1) * step; x < x1; x += step) line([x, y0, x, y1]);
  for (let y = (Math.floor(y0 / step) + 1) * step; y < y1; y += step) line([x0, y, x1, y]);
}

/** @param {View} view */
function target({ recording, lens, below: shapes, theme, unit }) {
  const { target: given } = recording.header;
  if (!given) return;
  lens.place(given.position[0], given.position[1], given.position[2]);
  const { x, y } = lens;
  const radius = given.radius * lens.scale * lens.near;
  const hue = colour(theme.target);
  shapes.disc(x, y, radius * 1.15, hue, 0.16, radius * 1.1);
  shapes.disc(x, y, radius, hue, 0.14);
  shapes.ring(x, y, radius, 2.2 * unit, hue, 0.95);
  shapes.ring(x, y, radius * 0.62, 1.2 * unit, hue, 0.45);
  shapes.disc(x, y, Math.max(radius * 0.16, 2 * unit), hue, 0.95);
}

/**
 * Shade an obstacle like a pebble lit from the upper left.
 * @param {View} view @param {number} mx @param {number} my @param {number} radius
 */
function pebble({ lens, below: shapes, theme }, mx, my, radius) {
  lens.place(mx, my);
  const { x, y } = lens;
  const r = radius * lens.scale;
  shapes.disc(x + r * 0.22, y + r * 0.22, r, colour(theme.shadow), theme.shadow_alpha, Math.max(r * 0.8, 1));
  shapes.disc(x, y, r, mixed(colour(theme.obstacle), colour(theme.shadow), 0.25));
  shapes.disc(x - r * 0.05, y - r * 0.05, r * 0.9, colour(theme.obstacle), 1, Math.max(r * 0.18, 1));
  shapes.disc(x - r * 0.3, y - r * 0.3, r * 0.3, colour(theme.obstacle_light), 0.75, Math.max(r * 0.7, 1));
}

/**
 * Draw the floor of a 3-D world, what stands on it, and the twelve edges of its room.
 * @param {View} view @param {Orbit} lens
 */
function room(view, lens) {
  const { recording, below: shapes, theme, unit } = view;
  const { size, heights, target: given } = recording.header;
  /** @type {number[][]} */
  const corners = [];
  for (let n = 0; n < 8; n++) {
    lens.place(n & 1 ? size[0] : 0, n & 2 ? size[1] : 0, heights[n & 4 ? 1 : 0]);
    corners.push([lens.x, lens.y, lens.near]);
  }
  /** @type {number[]} */
  const ground = [];
  for (const [x, y] of [[0, 0], [0, size[1]], [size[0], size[1]], [size[0], 0]]) {
    lens.place(x, y);
    ground.push(lens.x, lens.y);
  }
  shapes.quad(ground, colour(theme.world));
  shapes.quad(ground, colour(theme.glow), 0.5 * theme.glow_alpha);
  grid(view, 0.16, 0.6 * unit);
  corners.forEach(([ax, ay, near], a) => {
    for (const bit of [1, 2, 4]) {
      if (a & bit) continue;
      const [bx, by, other] = corners[a | bit];
      const alphas = /** @type {const} */ ([0.32 * near ** 2, 0.32 * other ** 2]);
      shapes.capsule(ax, ay, bx, by, 0.6 * unit * near, 0.6 * unit * other, colour(theme.line), ...alphas);
    }
  });
  for (const [x, y, , radius] of recording.header.obstacles.filter((each) => each.length === 4)) {
    lens.place(x, y);
    const r = radius * lens.scale * lens.near;
    shapes.disc(lens.x, lens.y, r, colour(theme.shadow), 0.5 * theme.shadow_alpha, r);
  }
  if (given) target(view);
}

/**
 * Draw an obstacle of a 3-D world as a ball lit from the upper left.
 * @param {View} view @param {Orbit} lens @param {number[]} ball
 */
export function drawBall({ above: shapes, theme }, lens, [mx, my, mz, radius]) {
  lens.place(mx, my, mz);
  const { x, y } = lens;
  const r = radius * lens.scale * lens.near;
  const haze = lens.haze();
  const [body, light] = [theme.obstacle, theme.obstacle_light].map((each) => mixed(colour(each), colour(theme.backdrop), haze));
  shapes.disc(x, y, r, mixed(body, [0, 0, 0], 0.25));
  shapes.disc(x - r * 0.06, y - r * 0.06, r * 0.86, body, 1, Math.max(r * 0.3, 1));
  shapes.disc(x - r * 0.3, y - r * 0.3, r * 0.3, light, 0.8, Math.max(r * 0.8, 1));
}
