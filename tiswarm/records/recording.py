"""One trial's path, tick by tick: save it, load it, check it."""

import os
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from tiswarm.scenario.model import Scenario
from tiswarm.space import box
from tiswarm.system.files import replacing

FATES = ("alive", "arrived", "captured", "crashed")

_ARRAYS = ("position", "velocity", "fate", "state", "group")


@dataclass(frozen=True)
class Swarm:
    """The path of the prey or of the predators.

    position, velocity: [tick, agent, dim], float64, m and m/s; row 0 is the start; NaN once the agent is gone.
    fate: [agent], one of FATES; a predator that took prey is "captured" too, since both die of it.
    state: [tick, agent], "calm", "alarmed" (sees an opponent) or a state of the strategy ("exploding", "jumped", ...).
    group: [tick, agent], int, the sub-swarm of agents that split up, or -1.
    terms: name -> [tick, agent, dim], m/s, what each term of the move out of a tick's state added to the velocity; NaN where no
        move followed. Empty unless terms were recorded.
    """

    position: np.ndarray
    velocity: np.ndarray
    fate: np.ndarray
    state: np.ndarray
    group: np.ndarray
    terms: dict[str, np.ndarray] = field(default_factory=dict)

    @classmethod
    def of(cls, moments: "Sequence[Swarm]") -> "Swarm":
        """Put moments, arrays [agent, ...] of one tick each, one behind the other."""
        position, velocity, state, group = (
            np.stack([getattr(each, name) for each in moments]) for name in ("position", "velocity", "state", "group")
        )
        return cls(position, velocity, moments[-1].fate, state, group)

    @property
    def count(self) -> int:
        """Count the agents that started."""
        return self.position.shape[1]

    @property
    def alive(self) -> np.ndarray:
        """Tell who is still there: [tick, agent], bool."""
        return np.isfinite(self.position[:, :, 0])


@dataclass(frozen=True)
class Recording:
    """One trial's path, with the scenario it ran.

    obstacle_position: [obstacle, dim], m; obstacle_radius: [obstacle], m.
    """

    scenario: Scenario
    seed: int
    trial: int
    prey: Swarm
    predators: Swarm
    obstacle_position: np.ndarray
    obstacle_radius: np.ndarray

    @property
    def ticks(self) -> int:
        """Count the ticks that ran; positions have one row more."""
        return self.prey.position.shape[0] - 1

    @property
    def dim(self) -> int:
        """Count the dimensions of the world."""
        return self.prey.position.shape[2]

    @property
    def period(self) -> np.ndarray:
        """Give after which length the world repeats itself along each axis: [dim], m; 0 where it does not."""
        return box.period(self.scenario.world.size, self.scenario.world.boundary)

    def shortest(self, way: np.ndarray) -> np.ndarray:
        """Take the shortest image of ways [..., dim] where the world is periodic."""
        return box.displacement(way, self.period)

    def save(self, path: str | os.PathLike) -> Path:
        """Write the recording as a compressed .npz; the file appears whole or not at all."""
        arrays = {
            "scenario": np.array(self.scenario.to_json()),
            "seed": np.array(self.seed),
            "trial": np.array(self.trial),
            "obstacle_position": self.obstacle_position,
            "obstacle_radius": self.obstacle_radius,
        }
        for kind in ("prey", "predators"):
            swarm = getattr(self, kind)
            arrays |= {f"{kind}_{name}": getattr(swarm, name) for name in _ARRAYS}
            arrays |= {f"{kind}_term_{name}": values for name, values in swarm.terms.items()}
        with replacing(Path(path)) as part, part.open("wb") as file:
            np.savez_compressed(file, allow_pickle=False, **arrays)
        return Path(path)

    @classmethod
    def load(cls, path: str | os.PathLike) -> "Recording":
        """Read a recording back.

        Errors: ValueError when the file is no recording; OSError when it cannot be read.
        """
        try:
            stored = np.load(path, allow_pickle=False)
            if not isinstance(stored, np.lib.npyio.NpzFile):
                raise ValueError("not an .npz file")
            with stored:
                prey, predators = (_swarm(stored, kind) for kind in ("prey", "predators"))
                scenario = Scenario.from_json(str(stored["scenario"]))
                numbers = (int(stored["seed"]), int(stored["trial"]))
                obstacles = (stored["obstacle_position"], stored["obstacle_radius"])
                recording = cls(scenario, *numbers, prey, predators, *obstacles)
            recording.check()
        except (KeyError, ValueError, TypeError, IndexError, EOFError, zipfile.BadZipFile, zlib.error) as error:
            reason = " ".join(str(error).split())
            raise ValueError(
                f"{path}: not a recording of tiswarm ({reason}); make one with tiswarm.record(...).save(...)"
            ) from None
        return recording

    def check(self) -> None:
        """Raise ValueError unless shapes agree, numbers are finite, fates are known and nobody returns once gone."""
        if self.prey.position.ndim != 3:
            raise ValueError("recording: prey position is not [tick, agent, dim]")
        rows = self.ticks + 1
        for name, swarm in (("prey", self.prey), ("predators", self.predators)):
            shape = (rows, swarm.count, self.dim)
            if swarm.position.shape != shape or swarm.velocity.shape != shape:
                raise ValueError(f"recording: {name} position and velocity are not both of shape {shape}")
            if swarm.fate.shape != (swarm.count,) or not np.isin(swarm.fate, FATES).all():
                raise ValueError(f"recording: {name} fate must hold one of {', '.join(FATES)} for each agent")
            if swarm.state.shape != (rows, swarm.count) or swarm.group.shape != (rows, swarm.count):
                raise ValueError(f"recording: {name} state and group are not both of shape {(rows, swarm.count)}")
            for term, values in swarm.terms.items():
                if values.shape != shape:
                    raise ValueError(f"recording: {name} term {term} is not of shape {shape}")
            if not np.isfinite(swarm.velocity[swarm.alive]).all():
                raise ValueError(f"recording: {name} velocity is not finite where they are alive")
            if (swarm.alive[1:] & ~swarm.alive[:-1]).any():
                raise ValueError(f"recording: an agent of {name} returns after it was gone")
        count = len(self.obstacle_radius) if self.obstacle_radius.ndim == 1 else -1
        if self.obstacle_position.shape != (count, self.dim) or not np.isfinite(self.obstacle_position).all():
            raise ValueError("recording: obstacle position and radius do not fit each other")


def _swarm(stored: Mapping[str, np.ndarray], kind: str) -> Swarm:
    """Read the path of one kind of agents."""
    start = f"{kind}_term_"
    terms = {name.removeprefix(start): stored[name] for name in stored if name.startswith(start)}
    return Swarm(**{name: stored[f"{kind}_{name}"] for name in _ARRAYS}, terms=terms)
