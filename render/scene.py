"""What moves in a recording: agents, their trails and states, drawn for one frame at a time."""

import numpy as np

from render import world
from render.camera import Camera, Orbit
from render.fates import Fates
from render.look import Look
from render.motion import motion
from render.now import Now, now
from render.overlays import Overlays
from render.shapes import NONE, capsules, colour, darts, discs, rings
from render.text import Atlas
from tiswarm.recording import Recording

SMALLEST = 2.5
"""No agent is drawn smaller than this radius [px], nor 5 px across."""

READABLE, CROWD = 5.2, 60
"""Agents are at least this large [units of type] while there are at most CROWD of them, and shrink as they become more."""

TRAILED = 3000
"""More agents than this have no trails: they would hide each other."""

HUNTERS = 0.65
"""Trails of predators are this much weaker than those of prey, whose story it is."""

CROWDED = 20_000
"""From this many agents on, a heat map shows where they are."""


class Scene:
    """A recording, ready to be drawn."""

    def __init__(self, recording: Recording, look: Look, atlas: Atlas, unit: float, knots: int = 2):
        """Prepare the paths.

        unit: pixels per unit of type, by which small things are sized. knots: points of a trail per tick; 2 make round curves.
        """
        self.recording, self.look, self.unit, self.theme = recording, look, unit, look.colours
        self._atlas = atlas
        self.paths = motion(recording)
        self._fates = Fates(recording, self.paths, self.theme, unit, look.speed)
        dense = self.paths.count >= CROWDED
        self._overlays = Overlays(recording, self.paths, self.theme, unit, (*look.overlay, *(("density",) if dense else ())))
        self._agents_shown = not dense
        # From then on nothing changes any more, but for cleaned ground, which fades.
        self._over = np.inf if "coverage" in look.overlay else self._fates.over(self.paths.ticks)
        self._last: tuple[Camera | None, list[np.ndarray]] = (None, [])
        self._line: tuple[Camera | None, np.ndarray | None] = (None, None)  # the knots on the screen of a still camera
        self._per_tick = knots
        self._knots = self.paths.knots(knots) if self._trails_shown() else None
        self._paints = self._palette()
        scenario, crowds = recording.scenario, (self.paths.count - self.paths.prey, self.paths.prey)
        self._radii = scenario.predators.radius, scenario.prey.radius
        self._least = [max(READABLE * unit * min(1.0, (CROWD / max(crowd, 1)) ** 0.5), SMALLEST) for crowd in crowds]

    def ground(self, camera: Camera) -> np.ndarray:
        """Draw the world: everything that stands still."""
        return world.ground(self.recording, self.theme, self._atlas, self.unit, camera)

    def frame(self, time: float, camera: Camera) -> list[np.ndarray]:
        """Draw what moves at a time [ticks]; past the last tick the last state stays and flashes go on."""
        if time < self._over:
            return self._drawn(time, camera)
        if self._last[0] is not camera:
            self._last = camera, self._drawn(time, camera)
        return self._last[1]

    def _drawn(self, time: float, camera: Camera) -> list[np.ndarray]:
        here = now(self.paths, time, camera)
        gone = not here.seen.all()
        rows = [self._overlays.below(here, camera)]
        if gone:
            rows += [self._fates.pulses(here, camera), self._fates.marks(here, camera)]
        if isinstance(camera, Orbit):
            rows.append(self._shadows(here, camera))
        if self._trails_shown():
            rows.append(self._trails(here, camera))
        if self._agents_shown:
            rows += [*self._predators(here, camera), *self._prey(here, camera)]
        if gone:
            rows.append(self._fates.flashes(here))
        return rows

    def _trails_shown(self) -> bool:
        return self.look.trail > 0 and self.paths.count <= TRAILED

    def _palette(self) -> np.ndarray:
        """Colour agents by the sub-swarm they belong to: [tick, agent, channel], linear light."""
        group, prey = np.maximum(self.paths.group, 0), self.paths.prey
        hues = [np.array([colour(each) for each in swatch], np.float32) for swatch in (self.theme.prey, self.theme.predator)]
        return np.concatenate([hues[0][group[:, :prey] % len(hues[0])], hues[1][group[:, prey:] % len(hues[1])]], axis=1)

    def _reach(self, prey: bool, camera: Camera) -> float:
        """Give an agent's radius on the screen: true, but large enough to be seen among as many as there are."""
        return max(self._radii[prey] * camera.scale, self._least[prey])

    def _shown(self, here: Now, prey: bool, camera: Camera) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Choose the agents to draw, the farthest first; give their numbers, radii [px] and colours."""
        first, last = (0, self.paths.prey) if prey else (self.paths.prey, self.paths.count)
        agents = first + np.flatnonzero(here.seen[first:last])
        if not isinstance(camera, Orbit):
            return agents, np.full(len(agents), self._reach(prey, camera)), self._paints[here.row][agents]
        agents = agents[np.argsort(here.near[agents], kind="stable")]
        near = here.near[agents]
        haze = np.clip(0.5 + 1.3 * (1 - near), 0, 0.75)[:, None]
        paints = self._paints[here.row][agents] * (1 - haze) + np.array(self.theme["backdrop"]) * haze
        return agents, np.maximum(self._reach(prey, camera) * near, SMALLEST), paints

    def _trails(self, here: Now, camera: Camera) -> np.ndarray:
        """Draw where agents were: lines that thin out and fade with age."""
        assert self._knots is not None
        paths, ticks = self.paths, self.look.trail * self.look.speed
        moment = min(here.time, float(paths.ticks))
        first, last = max(int(np.ceil((moment - ticks) * self._per_tick)), 0), int(np.ceil(moment * self._per_tick))
        if last <= first:
            return NONE
        times = np.append(np.arange(first, last) / self._per_tick, moment)
        # A line ends where its agent went, and breaks where the agent left one side of a periodic world for the other.
        shown = times[:-1, None] < paths.end
        if paths.period is not None:
            line = np.concatenate([self._knots[first:last], here.spot[None]])
            shown = shown & (np.abs(np.diff(line, axis=0)) < paths.period / 2).all(axis=2)
        agents, starts = shown.T.nonzero()
        pixels = np.concatenate([self._on_screen(camera, first, last).reshape(-1, 2), here.centre])
        start = starts * paths.count + agents
        fresh = np.maximum(1 - (moment - times) / ticks, 0)
        alpha, thin = self.theme.trail_alpha * fresh**1.4, 0.25 + 0.75 * fresh
        strong = np.where(paths.is_prey, 1.0, HUNTERS)[agents]
        wide = (np.where(paths.is_prey, *(0.42 * self._reach(prey, camera) for prey in (True, False))) * here.near)[agents]
        return capsules(
            pixels.take(start, axis=0),
            pixels.take(start + paths.count, axis=0),
            wide * thin[starts],
            wide * thin[starts + 1],
            self._paints[here.row][agents],
            alpha[starts] * strong,
            alpha[starts + 1] * strong,
            group=agents + 1,
        )

    def _on_screen(self, camera: Camera, first: int, last: int) -> np.ndarray:
        """Map knots to pixels [knot, agent, 2]: all of them, once, when a camera comes a second time, for then it is still."""
        assert self._knots is not None
        known, line = self._line
        if known is not camera:
            self._line = camera, None
            return camera.place(self._knots[first:last])
        if line is None:
            line = camera.place(self._knots)
            self._line = camera, line
        return line[first:last]

    def _prey(self, here: Now, camera: Camera) -> list[np.ndarray]:
        """Draw prey as drops, round in front; their state shows on them."""
        agents, reach, paints = self._shown(here, True, camera)
        if not len(agents):
            return []
        centre, heading, long = here.centre[agents], here.heading[agents], reach[:, None]
        nose, tail, edge = centre + heading * 0.35 * long, centre - heading * 1.9 * long, np.maximum(0.28 * reach, 1.0)
        alpha, edges, dye = self._twice(paints, edge)
        slim = np.concatenate([0.25 * reach, 0.22 * reach])
        return [
            capsules(_doubled(nose), _doubled(tail), _doubled(reach) + edges, slim + edges, dye, alpha),
            *self._states(self.paths.state[here.row][agents], nose, reach, paints),
        ]

    def _twice(self, paints: np.ndarray, edge: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Give opacity, width of the edge and colour of agents' outlines, followed by those of the agents themselves."""
        alpha = np.ones(2 * len(edge))
        alpha[: len(edge)] = 0.7
        outline = np.empty_like(paints)
        outline[:] = self.theme["outline"]
        return alpha, np.concatenate([edge, np.zeros_like(edge)]), np.concatenate([outline, paints])

    def _states(self, states: np.ndarray, nose: np.ndarray, reach: np.ndarray, paints: np.ndarray) -> list[np.ndarray]:
        """Mark who is not calm: a bright head; for any state but alarmed a ring too, wide and glowing when exploding."""
        rows = []
        stirred = states != "calm"
        if stirred.any():
            rows.append(discs(nose[stirred], reach[stirred] * 0.42, self.theme["alarm"], 0.9))
        acting = stirred & (states != "alarmed")
        if acting.any():
            wild = np.where(states[acting] == "exploding", 1.0, 0.0)
            size = reach[acting] * (2.1 + 0.6 * wild)
            rows.append(discs(nose[acting], size, paints[acting], 0.3 * wild, soft=size))
            rows.append(rings(nose[acting], size, 1.3 * self.unit, paints[acting], 0.9))
        return rows

    def _predators(self, here: Now, camera: Camera) -> list[np.ndarray]:
        """Draw predators as swept darts."""
        agents, reach, paints = self._shown(here, False, camera)
        if not len(agents):
            return []
        centre, heading = here.centre[agents], here.heading[agents]
        length, width, edge = 1.75 * reach, 1.25 * reach, np.maximum(0.3 * reach, 1.0)
        alpha, edges, dye = self._twice(paints, edge)
        notch = np.concatenate([0.55 * length, 0.8 * length])
        return [
            darts(
                _doubled(centre),
                _doubled(heading),
                _doubled(length) + 2 * edges,
                _doubled(width) + 1.3 * edges,
                notch,
                dye,
                alpha,
            )
        ]

    def _shadows(self, here: Now, camera: Camera) -> np.ndarray:
        """Drop the agents' shadows on the ground of a 3-D world."""
        spots = here.spot[here.seen, :2]
        if not len(spots):
            return NONE
        size = np.maximum(self._reach(True, camera) * camera.nearness(spots), SMALLEST)
        return discs(camera.place(spots), size, self.theme["shadow"], 0.5 * self.theme.shadow_alpha, soft=size)


def _doubled(rows: np.ndarray) -> np.ndarray:
    """Give an array followed by itself."""
    return np.concatenate([rows, rows])
