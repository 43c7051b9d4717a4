/** Agents: prey as drops, predators as darts, their states on them. */

import { Orbit } from "./camera.js";
import { drawBall } from "./ground.js";
import { colour, mixed } from "./shapes.js";

/** @typedef {import("./decode.js").Recording} Recording */

/** @typedef {import("./ground.js").View} View @typedef {import("./shapes.js").Colour} Colour */

const SMALLEST = 2.5;

/** Agents are at least READABLE large [units of type] while there are at most CROWD of them, and shrink as they become more. */
const READABLE = 5.2,
  CROWD = 60;

/** Of more agents than this, those near the edge of a periodic world are drawn beyond it, too; of fewer, everything is. */
export const CROWDED = 2000;

/** What is drawn of an agent lies within so many of its sizes, and so many pixels of outlines. */
const LONGEST = 4,
  OUTLINED = 4;

/**
 * Give how large an agent is on the screen, as it would be at the camera's pivot [px].
 * @param {View} view @param {number} agent
 */
export function reachOf({ recording, lens, unit }, agent) {
  const kind = recording.kind(agent);
  const least = Math.max(READABLE * unit * Math.min(1, Math.sqrt(CROWD / Math.max(kind.count, 1))), SMALLEST);
  return Math.max(kind.radius * lens.scale, least);
}

/** Give an agent's colour: its sub-swarm's. @param {View} view @param {number} agent @returns {Colour} */
export function hueOf({ recording, paths, time, theme }, agent) {
  if (agent >= recording.prey) return colour(theme.predator);
  const group = recording.group[paths.tick(time) * recording.count + agent];
  return colour(theme.prey[Math.max(group, 0) % theme.prey.length]);
}

/** Draw all agents that are there, predators below prey, or from far to near. @param {View} view */
export function drawAgents(view) {
  const { recording, lens } = view;
  const sizes = [recording.prey ? reachOf(view, 0) : 0, recording.count > recording.prey ? reachOf(view, recording.prey) : 0];
  if (lens instanceof Orbit) {
    drawByDepth(view, lens, sizes);
    return;
  }
  const torn = recording.header.boundary === "periodic" && recording.count > CROWDED;
  for (let agent = recording.prey; agent < recording.count; agent++) {
    drawAgent(view, agent, sizes[1]);
    if (torn) drawBeyond(view, agent, sizes[1]);
  }
  for (let agent = 0; agent < recording.prey; agent++) {
    drawAgent(view, agent, sizes[0]);
    if (torn) drawBeyond(view, agent, sizes[0]);
  }
}

/**
 * Draw an agent near an edge of a periodic world where it comes in at the other.
 * @param {View} view @param {number} agent @param {number} size
 */
function drawBeyond(view, agent, size) {
  const { recording, paths, lens } = view;
  const within = (LONGEST * size + OUTLINED) / lens.scale;
  const [width, height] = recording.header.size;
  const [px, py] = [paths.spot[agent * 2], paths.spot[agent * 2 + 1]];
  if (px >= within && px <= width - within && py >= within && py <= height - within) return; // nearly all of a crowd
  const shifts = [
    [px, width],
    [py, height],
  ].map(([place, side]) => [0, ...(place < within ? [side] : []), ...(place > side - within ? [-side] : [])]);
  for (const x of shifts[0]) for (const y of shifts[1]) if (x || y) drawAgent(view, agent, size, x, y);
}

/** @param {View} view @param {Orbit} lens @param {number[]} sizes */
function drawByDepth(view, lens, sizes) {
  const { recording, paths, time, below, theme } = view;
  /** @type {[number, () => void][]} */
  const things = [];
  for (let agent = 0; agent < recording.count; agent++) {
    if (!paths.seen(agent, time)) continue;
    const [x, y, z] = paths.spot.subarray(agent * 3, agent * 3 + 3);
    const size = sizes[agent < recording.prey ? 0 : 1];
    lens.place(x, y, 0);
    const wide = Math.max(size * lens.near, SMALLEST);
    below.disc(lens.x, lens.y, wide, colour(theme.shadow), 0.5 * theme.shadow_alpha, wide);
    lens.place(x, y, z);
    things.push([lens.near, () => drawAgent(view, agent, size)]);
  }
  for (const ball of recording.header.obstacles) {
    lens.place(ball[0], ball[1], ball[2]);
    things.push([lens.near, () => drawBall(view, lens, ball)]);
  }
  things.sort((a, b) => a[0] - b[0]);
  for (const [, draw] of things) draw();
}

/**
 * @param {View} view @param {number} agent @param {number} size
 * @param {number} east @param {number} north how far from its place it is drawn [m]
 */
function drawAgent(view, agent, size, east = 0, north = 0) {
  const { recording, paths, time, lens, theme } = view;
  if (!paths.seen(agent, time)) return;
  const { dim } = recording;
  const at = agent * dim;
  const [x, y, z] = [paths.spot[at] + east, paths.spot[at + 1] + north, dim > 2 ? paths.spot[at + 2] : 0];
  lens.place(x, y, z);
  lens.turn(x, y, z, paths.slope[at], paths.slope[at + 1], dim > 2 ? paths.slope[at + 2] : 0);
  let [hue, reach] = [hueOf(view, agent), size];
  if (lens instanceof Orbit) {
    hue = mixed(hue, colour(theme.backdrop), lens.haze());
    reach = Math.max(reach * lens.near, SMALLEST);
  }
  if (agent < recording.prey) drop(view, agent, reach, hue);
  else dart(view, agent, reach, hue);
}

/** Draw a prey, round in front. @param {View} view @param {number} agent @param {number} reach @param {Colour} hue */
function drop(view, agent, reach, hue) {
  const { lens, above: shapes, theme, unit } = view;
  const { x, y, hx, hy } = lens;
  const [nx, ny] = [x + hx * 0.35 * reach, y + hy * 0.35 * reach];
  const [tx, ty] = [x - hx * 1.9 * reach, y - hy * 1.9 * reach];
  const edge = Math.max(0.28 * reach, 1);
  shapes.capsule(nx, ny, tx, ty, reach + edge, 0.25 * reach + edge, colour(theme.outline), 0.7);
  shapes.capsule(nx, ny, tx, ty, reach, 0.22 * reach, hue);
  const state = stateOf(view, agent);
  if (state === "calm") return;
  shapes.disc(nx, ny, reach * 0.42, colour(theme.alarm), 0.9);
  if (state === "alarmed") return;
  const wild = state === "exploding" ? 1 : 0;
  const size = reach * (2.1 + 0.6 * wild);
  shapes.disc(nx, ny, size, hue, 0.3 * wild, size);
  shapes.ring(nx, ny, size, 1.3 * unit, hue, 0.9);
}

/** @param {View} view @param {number} agent */
function stateOf({ recording, paths, time }, agent) {
  return recording.states[recording.state[paths.tick(time) * recording.count + agent]];
}

/**
 * Draw a predator, with a dot in the colour of the cluster that it chases.
 * @param {View} view @param {number} agent @param {number} reach @param {Colour} hue
 */
function dart(view, agent, reach, hue) {
  const { recording, paths, time, lens, above: shapes, theme } = view;
  const { x, y, hx, hy } = lens;
  const [long, wide, edge] = [1.75 * reach, 1.25 * reach, Math.max(0.3 * reach, 1)];
  shapes.dart(x, y, hx, hy, long + 2 * edge, wide + 1.3 * edge, 0.55 * long, colour(theme.outline), 0.7);
  shapes.dart(x, y, hx, hy, long, wide, 0.8 * long, hue);
  const group = recording.group[paths.tick(time) * recording.count + agent];
  if (group < 0) return;
  const [cx, cy, size] = [x + hx * 0.1 * reach, y + hy * 0.1 * reach, 0.5 * reach];
  shapes.disc(cx, cy, 1.3 * size, colour(theme.outline), 0.9);
  shapes.disc(cx, cy, size, colour(theme.prey[group % theme.prey.length]));
}

/** Give an agent's place on the screen. @param {View} view @param {number} agent @returns {[number, number]} */
export function pixelOf({ recording, paths, lens }, agent) {
  const at = agent * recording.dim;
  lens.place(paths.spot[at], paths.spot[at + 1], recording.dim > 2 ? paths.spot[at + 2] : 0);
  return [lens.x, lens.y];
}

/**
 * Count what became of the prey up to a time.
 * @param {Recording} recording @param {number} time @returns {number[]} as FATES
 */
export function tally(recording, time) {
  if (recording.counts) return recording.counts;
  const counts = [0, 0, 0, 0];
  for (let agent = 0; agent < recording.prey; agent++) counts[recording.end[agent] <= time ? recording.fate[agent] : 0] += 1;
  return counts;
}
