/** Trails: where agents were, as ribbons that thin out and fade with age. */

import { hueOf, reachOf } from "./agents.js";

/** @typedef {import("./ground.js").View} View */

/** How far back trails go [ticks]: 2.5 s of a film. */
const BEHIND = 25;

/** Trails of predators are weaker than those of prey, whose story it is; width of a new one as a share of its agent's. */
const HUNTERS = 0.65,
  THICK = 0.42;

/** More agents than this have no trails: they would hide each other. With more than FEW, trails have one point a tick. */
const TRAILED = 3000,
  FEW = 300;

const points = new Float32Array(4 * (BEHIND * 3 + 4));
const spot = new Float32Array(3);

/** Draw the trails of all agents. @param {View} view */
export function drawTrails(view) {
  const { recording } = view;
  if (recording.count > TRAILED) return;
  const pace = recording.count > FEW ? 1 : 3;
  for (let agent = 0; agent < recording.count; agent++) trail(view, agent, pace);
}

/** @param {View} view @param {number} agent @param {number} pace points a tick */
function trail(view, agent, pace) {
  const { recording, paths, time, lens, ribbons, theme } = view;
  const { dim, header } = recording;
  const now = Math.min(time, recording.ticks);
  const last = Math.min(now, recording.end[agent]);
  const first = Math.max(now - BEHIND, 0);
  if (last <= first) return;
  const [hue, wide] = [hueOf(view, agent), THICK * reachOf(view, agent)];
  const strength = theme.trail_alpha * (agent < recording.prey ? 1 : HUNTERS);
  // Knots are fixed in time, so that they do not crawl; the newest piece ends where the agent is.
  const oldest = Math.ceil(first * pace);
  let [count, x, y] = [0, NaN, NaN];
  for (let knot = Math.ceil(last * pace); knot >= oldest; knot--) {
    const when = Math.min(knot / pace, last);
    paths.at(agent, when, spot, null, 0);
    const step = [recording.shortest(spot[0] - x, 0), recording.shortest(spot[1] - y, 1)];
    const torn = lens.deep && header.boundary === "periodic" && count > 0 && step[0] !== spot[0] - x;
    if (torn) {
      ribbons.line(points, count, hue);
      count = 0;
    }
    // In a flat periodic world the line goes on beyond the edge, and is seen again on the other side.
    [x, y] = count > 0 && !torn ? [x + step[0], y + step[1]] : [spot[0], spot[1]];
    lens.place(x, y, dim > 2 ? spot[2] : 0);
    const fresh = Math.max(1 - (now - when) / BEHIND, 0);
    points[count * 4] = lens.x;
    points[count * 4 + 1] = lens.y;
    points[count * 4 + 2] = wide * lens.near * (0.25 + 0.75 * fresh);
    points[count * 4 + 3] = strength * fresh ** 1.4;
    count += 1;
  }
  if (count > 1) ribbons.line(points, count, hue);
}
