/** Events: deaths and arrivals, a flash when they happen, a quiet mark afterwards. */

import { pixelOf } from "./agents.js";
import { ARRIVED, CAPTURED, CRASHED } from "./decode.js";
import { colour } from "./shapes.js";

/** @typedef {import("./ground.js").View} View */

/** How long a death or an arrival shines [ticks]: 0.7 s of a film. */
const FLASH = 7;

/**
 * Mark where prey died: a cross for a crash, a ring for a capture; let the target's ring swell for each arrival.
 * @param {View} view
 */
export function drawMarks(view) {
  const { recording, time, below: shapes, theme, unit } = view;
  for (let agent = 0; agent < recording.prey; agent++) {
    const age = time - recording.end[agent];
    if (!(age >= 0)) continue;
    const fate = recording.fate[agent];
    if (fate === ARRIVED) {
      if (age < 2 * FLASH) pulse(view, age / (2 * FLASH));
      continue;
    }
    const [x, y] = pixelOf(view, agent);
    if (fate === CAPTURED) shapes.ring(x, y, 3.4 * unit, 1.6 * unit, colour(theme.captured), 0.6);
    if (fate !== CRASHED) continue;
    const [arm, half] = [3.6 * unit, 0.8 * unit];
    shapes.capsule(x - arm, y - arm, x + arm, y + arm, half, half, colour(theme.crashed), 0.6);
    shapes.capsule(x - arm, y + arm, x + arm, y - arm, half, half, colour(theme.crashed), 0.6);
  }
}

/** @param {View} view @param {number} phase */
function pulse({ recording, lens, below: shapes, theme, unit }, phase) {
  const { target } = recording.header;
  if (!target) return;
  lens.place(target.position[0], target.position[1], target.position[2]);
  const radius = target.radius * lens.scale * lens.near;
  const swell = radius * (1 + 0.7 * (1 - (1 - phase) ** 2));
  shapes.ring(lens.x, lens.y, swell, 3 * unit * (1 - phase), colour(theme.arrived), 0.8 * (1 - phase));
  shapes.disc(lens.x, lens.y, radius * 0.8, colour(theme.arrived), 0.35 * (1 - phase) ** 2, radius * 0.6);
}

/**
 * Flash where agents die: two rings for a capture, a star of sparks for a crash; a soft glow where one arrives.
 * @param {View} view
 */
export function drawFlashes(view) {
  const { recording, time, above: shapes, theme, unit } = view;
  for (let agent = 0; agent < recording.count; agent++) {
    const age = time - recording.end[agent];
    if (!(age >= 0 && age < FLASH)) continue;
    const [fate, prey] = [recording.fate[agent], agent < recording.prey];
    const [x, y] = pixelOf(view, agent);
    if (fate === CRASHED) sparks(view, x, y, age / FLASH, unit * (prey ? 1 : 0.6));
    else if (prey) {
      const hue = colour(fate === CAPTURED ? theme.captured : theme.arrived);
      const left = 1 - age / FLASH;
      const ease = 1 - left ** 3;
      shapes.disc(x, y, unit * (4 + 9 * ease), hue, 0.75 * left ** 2, unit * 12);
      if (fate !== CAPTURED) continue;
      shapes.ring(x, y, unit * (6 + 26 * ease), unit * 3.2 * left, hue, left);
      shapes.ring(x, y, unit * (3 + 15 * ease), unit * 2 * left, colour(theme.ink), 0.8 * left);
    }
  }
}

/** @param {View} view @param {number} x @param {number} y @param {number} phase @param {number} size */
function sparks({ above: shapes, theme }, x, y, phase, size) {
  const hue = colour(theme.crashed);
  shapes.disc(x, y, 7 * size, hue, 0.7 * (1 - phase) ** 2, 9 * size);
  const ease = 1 - (1 - phase) ** 3;
  const half = Math.max(1.3 * size * (1 - phase), 0.2);
  for (let ray = 0; ray < 8; ray++) {
    const angle = (ray * Math.PI) / 4 + Math.PI / 8;
    const [c, s] = [Math.cos(angle) * size, Math.sin(angle) * size];
    const [near, far] = [4 + 10 * ease, 6 + 19 * ease];
    shapes.capsule(x + c * near, y + s * near, x + c * far, y + s * far, half, 0.4 * half, hue, 1 - phase);
  }
}
