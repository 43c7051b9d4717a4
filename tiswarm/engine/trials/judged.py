"""Judged: where agents were when they were found to touch, to crash or to have arrived, which no later tick tells."""

import numpy as np

from tiswarm.engine.trials.trial import Single
from tiswarm.records.recording import FATES
from tiswarm.space import box


class Judged:
    """The places at which a trial's agents were judged to be gone. places: kind -> [agent, dim], m; NaN before that."""

    def __init__(self, own: Single):
        """Begin with nobody gone."""
        self._own, dim = own, own.scenario.world.dim
        self.places = {kind: np.full((getattr(own.scenario, kind).count, dim), np.nan) for kind in ("prey", "predators")}

    def note(self) -> None:
        """Note the places of those who are gone since the last tick, each of which must be told."""
        fresh = {kind: (self._own.fate(kind) != FATES[0]) & np.isnan(self.places[kind][:, 0]) for kind in self.places}
        if not any(gone.any() for gone in fresh.values()):
            return
        world = self._own.scenario.world
        for kind, gone in fresh.items():
            place, travel = self._own.last(kind)
            if world.contact_test == "swept":
                for fate in FATES[1:]:
                    mine = gone & (self._own.fate(kind) == fate)
                    place[mine] -= self._left(kind, fate, place[mine], travel[mine], fresh)[:, None] * travel[mine]
            self.places[kind][gone] = box.wrap(place[gone], box.period(world.size, world.boundary))

    def _left(self, kind: str, fate: str, place: np.ndarray, travel: np.ndarray, fresh: dict[str, np.ndarray]) -> np.ndarray:
        """Give the share of the tick that was left when agents came closest to whom they met: [agent], 0 to 1.

        As `nearest` of dynamics/contact.py: both moved evenly on straight lines.
        """
        where, way, reach = self._met(kind, fate, fresh)
        if not len(where):
            return np.zeros(len(place))
        world = self._own.scenario.world
        against = travel[:, None] - way
        found = box.displacement(place[:, None] - where - against / 2, box.period(world.size, world.boundary))
        length = (against**2).sum(axis=2)
        share = np.clip(-(found * against).sum(axis=2) / np.where(length > 0, length, 1), -0.5, 0.5)
        gap = np.linalg.norm(found + share[..., None] * against, axis=2) - reach
        return np.take_along_axis(0.5 - share, gap.argmin(axis=1)[:, None], axis=1)[:, 0]

    def _met(self, kind: str, fate: str, fresh: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Give whom agents of a fate may have met: places and ways in the tick [body, dim], m, and radii [body], m."""
        scenario = self._own.scenario
        if fate == "captured":
            other = "predators" if kind == "prey" else "prey"
            there = fresh[other] | (self._own.fate(other) == FATES[0])
            where, way = (each[there] for each in self._own.last(other))
            return where, way, np.zeros(len(where))
        where, reach = self._own.obstacles() if fate == "crashed" else (np.zeros((0, scenario.world.dim)), np.zeros(0))
        if scenario.target.present and (fate == "arrived" or kind == "predators"):
            where, reach = np.vstack([where, scenario.target.position]), np.append(reach, scenario.target.radius)
        return where, np.zeros_like(where), reach
