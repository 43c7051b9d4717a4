"""One trial's path, tick by tick: save it, load it, check it."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tiswarm.records import tables
from tiswarm.records.archive import Archive, DamagedArchive
from tiswarm.scenario.model import Scenario
from tiswarm.space import box
from tiswarm.system.files import replacing

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

MOST_SCENARIO = MOST_NOTES = 1 << 20  # characters
MOST_ITEM = 4 * 64  # bytes of one number or of one name
FARTHEST = 1e15
"""How far away anybody can get [m]: the fastest in the longest trial are nearer by orders of magnitude."""

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
    judged: [agent, dim], m, where each was when it was judged to be gone, after the move of its last tick, or in it where
        contact is swept; NaN for those who are not. None where that is not known: of large swarms, and of recordings of before.
    """

    position: np.ndarray
    velocity: np.ndarray
    fate: np.ndarray
    state: np.ndarray
    group: np.ndarray
    terms: dict[str, np.ndarray] = field(default_factory=dict)
    judged: np.ndarray | None = None

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

    obstacle_position: [obstacle, dim], m; obstacle_radius: [obstacle], m. notes: lines on what went otherwise than was asked.
    """

    scenario: Scenario
    seed: int
    trial: int
    prey: Swarm
    predators: Swarm
    obstacle_position: np.ndarray
    obstacle_radius: np.ndarray
    notes: tuple[str, ...] = ()

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
            arrays |= {f"{kind}_judged": swarm.judged} if swarm.judged is not None else {}
        if self.notes:
            arrays["notes"] = np.array("\n".join(self.notes))
        with replacing(Path(path)) as part, part.open("wb") as file:
            np.savez_compressed(file, allow_pickle=False, **arrays)
        return Path(path)

    @classmethod
    def load(cls, path: str | os.PathLike) -> "Recording":
        """Read a recording back.

        Errors: ValueError when the file is no recording; OSError when it cannot be read.
        """
        try:
            with Archive(Path(path)) as stored:
                _check_headers(stored)
                prey, predators = (_swarm(stored, kind) for kind in ("prey", "predators"))
                scenario = Scenario.from_json(stored.text("scenario", MOST_SCENARIO))
                numbers = (stored.number("seed"), stored.number("trial"))
                obstacles = (stored.read("obstacle_position"), stored.read("obstacle_radius"))
                notes = tuple(stored.text("notes", MOST_NOTES).split("\n")) if "notes" in stored.headers else ()
                recording = cls(scenario, *numbers, prey, predators, *obstacles, notes)
            recording.check()
        except (ValueError, RecursionError) as error:
            reason = " ".join(str(error).split())
            raise ValueError(
                f"{path}: not a recording of tiswarm ({reason}); make one with tiswarm.record(...).save(...)"
            ) from None
        return recording

    def to_xarray(self) -> "xr.Dataset":
        """Give position, velocity, state, group and fate along tick, agent (prey first) and axis, with obstacles and terms.

        Units as CF has them; attributes say scenario, seed, trial and version. Needs the extra `data`. Errors: MissingExtra.
        """
        return tables.path_dataset(self)

    def to_netcdf(self, path: str | os.PathLike) -> Path:
        """Write what `to_xarray` gives as netCDF-4; the file appears whole or not at all. Errors: MissingExtra; OSError."""
        return tables.write_dataset(self.to_xarray(), path)

    def to_csv(self) -> str:
        """Write a row for each agent and tick, those who are gone left out: tick, time [s], agent, kind, x, y, vx, vy, ..."""
        from tiswarm.records.tracks import csv_of  # which builds on this module

        return csv_of(self)

    def to_tracks(self) -> "pd.DataFrame":
        """Give the path as trackpy names it (frame, particle, x, y), with `t` for movingpandas, kind, velocity and state.

        t: the time since the start as a date after 1970 began. Needs the extra `data`. Errors: MissingExtra.
        """
        from tiswarm.records.tracks import tracks_of

        return tracks_of(self)

    @classmethod
    def from_tracks(
        cls,
        tracks: "pd.DataFrame | Mapping[str, np.ndarray]",
        *,
        size: Sequence[float] | None = None,
        boundary: box.Boundary = "open",
        dt: float = 1.0,
        radius: float | None = None,
        title: str = "Tracks",
    ) -> "Recording":
        """Make a recording of tracked animals, to be filmed and measured as any other.

        tracks: columns frame and particle (or tick and agent), whole numbers, x, y and, in space, z [m], and kind ("prey", or
            "predators" for hunters) where there are both. Tracks may begin and end at any frame; gaps within one are filled by
            straight ways.
        size: of the world [m], whose corner is the origin; by default the tracks' own extent, moved there.
        boundary: "periodic" for animals that leave at one side and come back at the other.
        dt: time between two frames [s]. radius: of a body [m], by default what films show well.

        Velocities are differences of places. Who is lost before the last frame is gone, with the fate "alive".

        Errors: ValueError for what is no table of tracks; ScenarioError for a world that cannot be.
        """
        from tiswarm.records.tracks import recording_of

        return recording_of(tracks, size, boundary, dt, radius, title)

    def _repr_html_(self) -> str:
        from tiswarm.records.portrait import portrait

        return portrait(self)

    def check(self) -> None:
        """Raise ValueError unless shapes agree, numbers are finite, fates are known and nobody returns once gone.

        An agent may come after the start, as tracked animals do.
        """
        if self.prey.position.ndim != 3 or 0 in self.prey.position.shape:
            raise ValueError("recording: prey position is not [tick, agent, dim], or is empty")
        if self.dim != self.scenario.world.dim:
            raise ValueError(f"recording: positions have {self.dim} numbers, the scenario's world {self.scenario.world.dim}")
        if not 0 <= self.seed < 1 << 64 or not 0 <= self.trial < 1 << 31:
            raise ValueError(f"recording: seed {self.seed} and trial {self.trial} are not both possible")
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
                if values.shape != shape or values.dtype.kind != "f":
                    raise ValueError(f"recording: {name} term {term} is not of shape {shape}")
            judged = swarm.judged
            if judged is not None and (judged.shape != shape[1:] or not _possible(judged[np.isfinite(judged).any(axis=-1)])):
                raise ValueError(f"recording: {name} judged is not of shape {shape[1:]}, or holds a number that is none")
            if not (_possible(swarm.velocity[swarm.alive]) and _possible(swarm.position[swarm.alive])):
                raise ValueError(f"recording: {name} position and velocity are not finite where they are alive")
            if (np.diff(swarm.alive.astype(np.int8), axis=0, prepend=0) > 0).sum(axis=0).max(initial=0) > 1:
                raise ValueError(f"recording: an agent of {name} returns after it was gone")
        count = len(self.obstacle_radius) if self.obstacle_radius.ndim == 1 else -1
        if self.obstacle_position.shape != (count, self.dim) or not _possible(self.obstacle_position):
            raise ValueError("recording: obstacle position and radius do not fit each other")
        if not _possible(self.obstacle_radius) or (self.obstacle_radius < 0).any():
            raise ValueError("recording: obstacle radius holds a number that is none, or below 0")


def _swarm(stored: Archive, kind: str) -> Swarm:
    """Read the path of one kind of agents."""
    start = f"{kind}_term_"
    terms = {name.removeprefix(start): stored.read(name) for name in stored.headers if name.startswith(start)}
    judged = stored.read(f"{kind}_judged") if f"{kind}_judged" in stored.headers else None
    return Swarm(**{name: stored.read(f"{kind}_{name}") for name in _ARRAYS}, terms=terms, judged=judged)


_KINDS = {
    **{f"{kind}_{name}": "f" for kind in ("prey", "predators") for name in ("position", "velocity")},
    **{f"{kind}_{name}": "U" for kind in ("prey", "predators") for name in ("fate", "state")},
    **{f"{kind}_group": "i" for kind in ("prey", "predators")},
    "obstacle_position": "f",
    "obstacle_radius": "f",
}
"""Arrays of a recording: name -> kind of number."""


def _check_headers(stored: Archive) -> None:
    """Refuse what announces no recording, before any array is inflated. Errors: DamagedArchive."""
    for name, kind in _KINDS.items():
        header = stored.headers.get(name)
        if header is None or header.dtype.kind != kind or header.dtype.itemsize > MOST_ITEM:
            raise DamagedArchive(f"{name} is missing, or of another type")
    for kind in ("prey", "predators"):
        shape = stored.headers[f"{kind}_position"].shape
        wanted = {"velocity": shape, "fate": shape[1:2], "state": shape[:2], "group": shape[:2]}
        judged = stored.headers.get(f"{kind}_judged")
        if judged is not None and (judged.dtype.kind != "f" or judged.shape != shape[1:]):
            raise DamagedArchive(f"{kind}_judged has another type or shape than is possible")
        if any(stored.headers[f"{kind}_{name}"].shape != each for name, each in wanted.items()):
            raise DamagedArchive(f"the arrays of {kind} have shapes that do not fit each other")


def _possible(numbers: np.ndarray) -> bool:
    """Tell whether all numbers are finite and no larger than a trial can bring forth."""
    return bool((np.abs(numbers) <= FARTHEST).all())
