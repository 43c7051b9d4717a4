"""Payment: what agents that obey are paid for a move, as their scenario's [rewards] say."""

import numpy as np

from tiswarm.dynamics.rows import ARRIVED, CAPTURED, CRASHED
from tiswarm.engine.trials.session import Kind, Session
from tiswarm.space import box


class Payment:
    """Remembers what was before a move, and settles after it."""

    def __init__(self, session: Session, where: dict[Kind, slice]) -> None:
        """Prepare arrays. where: which agents of those who are paid are of a kind."""
        self._session, self._where = session, where
        scenario = session.scenario
        self._rules = scenario.rewards
        self._target = np.array(scenario.target.position) if scenario.target.present and self._rules.prey.nearer else None
        self._period = box.period(scenario.world.size, scenario.world.boundary)
        kinds: list[Kind] = ["prey", "predators"]
        self._fate = {kind: np.zeros((session.places, session.count(kind)), np.int8) for kind in kinds}
        self._alive = {kind: np.zeros((session.places, session.count(kind)), bool) for kind in kinds}
        self._away = np.zeros((session.places, session.count("prey")))
        self.paid = np.zeros((session.places, sum(own.stop - own.start for own in where.values())), np.float32)

    def begin(self, where: np.ndarray) -> None:
        """Look at trials that have just begun at some places: [n]."""
        self._look(where)
        self._away[where] = self._distance()[where]

    def _look(self, where: np.ndarray) -> None:
        rows = self._session.blocks.layout.rows
        for kind in self._fate:
            if self._fate[kind].shape[1]:
                self._fate[kind][where] = self._session.row(kind, rows.fate)[where]
                self._alive[kind][where] = self._session.row(kind, rows.alive)[where] > 0.5

    def _distance(self) -> np.ndarray:
        """Measure how far each prey is from the target: [place, prey], m."""
        if self._target is None:
            return self._away
        place = self._session.rows("prey", self._session.blocks.layout.rows.place)
        ways = box.displacement(place - self._target, self._period)
        return np.sqrt((ways * ways).sum(axis=2))

    def alive(self, kind: Kind) -> np.ndarray:
        """Tell who is there: [place, agent], bool."""
        return self._alive[kind]

    def fate(self, kind: Kind) -> np.ndarray:
        """Give the number of what became of each so far: [place, agent]."""
        return self._fate[kind]

    def nobody(self) -> np.ndarray:
        """Tell where no prey is left: [place], bool."""
        return np.asarray(~self._alive["prey"].any(axis=1))

    def settle(self, running: np.ndarray) -> np.ndarray:
        """Give what agents are paid for the move that was made: [place, agent]; nothing where no trial ran, [place]."""
        fate, alive, away = dict(self._fate), dict(self._alive), self._away
        self._fate, self._alive = ({kind: each.copy() for kind, each in old.items()} for old in (fate, alive))
        self._look(np.flatnonzero(running))
        self._away = np.where(running[:, None], self._distance(), away)
        changed = {kind: np.where(fate[kind] == self._fate[kind], 0, self._fate[kind]) for kind in fate}
        for kind, own in self._where.items():
            if kind == "prey":
                rules = self._rules.prey
                paid = rules.nearer * (away - self._away) + rules.tick
                paid = np.where(alive[kind], paid, 0.0) + rules.arrived * (changed[kind] == ARRIVED)
                paid += rules.captured * (changed[kind] == CAPTURED) + rules.crashed * (changed[kind] == CRASHED)
            else:
                paid = self._hunters(alive[kind], changed)
            self.paid[:, own] = np.where(running[:, None], paid, 0.0)
        return self.paid

    def _hunters(self, alive: np.ndarray, changed: dict[Kind, np.ndarray]) -> np.ndarray:
        rules, kills = self._rules.predators, self._session.scenario.world.contact in ("deadly", "eaten")
        prey = changed["prey"]
        common = rules.captured * (prey == CAPTURED).sum(axis=1) + rules.arrived * (prey == ARRIVED).sum(axis=1) + rules.tick
        paid = np.where(alive, common[:, None], 0.0) + rules.crashed * (changed["predators"] == CRASHED)
        if kills and rules.touched:
            touches = self._session.row("predators", self._session.blocks.layout.rows.hit) > 0.5
            paid = paid + rules.touched * (alive & touches)
        return paid
