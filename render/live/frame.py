"""Frame: one tick as the page gets it, in one message of bytes; `render/page/window.js` reads it.

Twelve whole numbers (uint32): FORMAT, scene, tick, the last change that was heard, 1 once the trial is over, how many prey have
each fate (four), agents drawn one by one, agents of the cloud, dimensions. Then, of the former, positions and velocities
(float32), sub-swarms (int16); places of the cloud (uint16, 65 536 steps over its box); states and fates (uint8). All are
little-endian.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

import tiswarm
from render.page.pack import Header, told
from tiswarm.records.recording import FATES
from tiswarm.space import box
from tiswarm.strategies import registry

FORMAT = 1

CLOUDED = 3000
"""More prey than this are a cloud, as they are in films."""

STRAY = 0.5
"""How far beyond an open world the cloud goes on [share of the world's size]."""


@dataclass
class Scene:
    """What all frames of one trial have in common.

    number: of the scene, which its frames name. before: how many prey had each fate when the trial was taken up: [fate];
    earlier: ticks that had run until then.
    """

    simulation: tiswarm.Simulation
    number: int
    before: np.ndarray
    earlier: int = 0

    def __post_init__(self) -> None:
        scenario = self.simulation.scenario
        self.clouded = scenario.prey.count > CLOUDED
        self.mortal = scenario.target.present or scenario.obstacles.count > 0 or scenario.predators.count > 0
        size = np.array(scenario.world.size, float)
        stray = 0.0 if box.bounded(scenario.world.boundary) else STRAY
        self.low, self.high = -stray * size, (1 + stray) * size
        self.states = list(dict.fromkeys(["calm", "alarmed", *self._special()]))

    def _special(self) -> list[str]:
        """List the states that strategies have names for."""
        scenario, found = self.simulation.scenario, []
        kinds: tuple[registry.Side, ...] = ("prey", "predators")
        for kind in kinds:
            weights = getattr(scenario, kind).weights
            for name, memory in self.simulation.memory(kind).items():
                found += list(registry.load(kind, name).states(memory, weights)) if memory else []
        return found

    def header(self) -> Header:
        """Say what the page must know before the first frame."""
        simulation = self.simulation
        scenario = simulation.scenario
        lone = 0 if self.clouded else scenario.prey.count
        return told(simulation, {"prey": lone, "predators": scenario.predators.count}) | {
            "scene": self.number,
            "ticks": self.earlier + simulation.max_ticks,
            "states": self.states,
            "cloud": {"low": self.low.tolist(), "high": self.high.tolist(), "count": scenario.prey.count}
            if self.clouded
            else None,
        }

    def frame(self, heard: int) -> bytes:
        """Write the tick that is now. heard: number of the last change that counts in it."""
        simulation = self.simulation
        dim = simulation.scenario.world.dim
        kinds: list[registry.Side] = ["predators"] if self.clouded else ["prey", "predators"]
        shown = [simulation.moment(kind) for kind in kinds if getattr(simulation.scenario, kind).count]
        cloud = self._cloud() if self.clouded else np.zeros((0, dim), "<u2")
        head = np.array(
            [FORMAT, self.number, self.earlier + simulation.age, heard, simulation.ended, *self.counts(), 0, 0, dim], "<u4"
        )
        head[9], head[10] = sum(len(each.position) for each in shown), len(cloud)
        parts = [head]
        for name, kind in (("position", "<f4"), ("velocity", "<f4"), ("group", "<i2")):
            parts += [np.asarray(getattr(each, name)).astype(kind) for each in shown]
        parts.append(cloud)
        parts += [_places(each.state, self.states) for each in shown]
        parts += [_places(each.fate, FATES) for each in shown]
        return b"".join(np.ascontiguousarray(each).tobytes() for each in parts)

    def counts(self) -> np.ndarray:
        """Count the prey of each fate, in the order of FATES, those of before included."""
        here = self.simulation.scenario.prey.count
        if not self.mortal:
            return self.before + np.array([here, 0, 0, 0])
        fate = self.simulation.fate("prey")
        return self.before + np.array([np.count_nonzero(fate == name) for name in FATES])

    def _cloud(self) -> np.ndarray:
        """Give where the prey that are there are: [agent, dim] of uint16."""
        shares = self.simulation.position("prey")
        shares -= self.low
        shares /= self.high - self.low
        inside = np.ones(len(shares), bool)
        for axis in shares.T:
            inside &= (axis >= 0) & (axis < 1)  # whoever is gone is nowhere
        kept = shares if inside.all() else shares[inside]
        kept *= 65_536
        return kept.astype("<u2")


def _places(names: np.ndarray, known: Sequence[str]) -> np.ndarray:
    """Give each name's place in a list, 0 for strange ones: [agent] of uint8."""
    found = np.zeros(len(names), np.uint8)
    for place, name in enumerate(known):
        found[names == name] = place
    return found
