"""Recorded: what a recording shows, tick by tick, in NumPy; of the same trial running.py measures the same in the kernel."""

from collections.abc import Callable

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from tiswarm.measures.deadlocks import trapped, trapped_milling, trapped_time
from tiswarm.measures.ground import coverage, states, time_to, visit_variation
from tiswarm.records.recording import Recording
from tiswarm.scenario.measures import CHANGED, MEASURED, SETTLED, STILL
from tiswarm.space import box
from tiswarm.system.words import did_you_mean

TINY = 1e-12
"""Squared lengths are not taken for smaller than this in quotients, so that coincident agents give no infinity [m²]."""

ROWS = 256
"""Agents whose distances to all others are in memory at once."""


def polarisation(recording: Recording) -> np.ndarray:
    """Give how far alive prey head one way, |Σ u(v)|/n: [tick], 0 to 1, NaN where nobody is alive."""
    alive, _, velocity = _alive(recording)
    return _mean(np.linalg.norm(_units(velocity).sum(axis=1), axis=-1), alive)


def milling(recording: Recording) -> np.ndarray:
    """Give how far alive prey turn about their mean place c, |Σ u(x - c) × u(v)|/n: [tick], 0 to 1, NaN where nobody is alive.

    In a periodic world c is the mean of the images nearest to the first prey that is alive.
    """
    alive, _, velocity = _alive(recording)
    position = np.where(alive[..., None], box.about_first(recording.prey.position, recording.period), 0.0)
    count = np.maximum(alive.sum(axis=1), 1)[:, None, None]
    way = position - position.sum(axis=1, keepdims=True) / count
    way = np.where(alive[..., None], recording.shortest(way), 0.0)
    flat = ((0, 0), (0, 0), (0, 3 - recording.dim))
    spin = np.cross(np.pad(_units(way), flat), np.pad(_units(velocity), flat))
    return _mean(np.linalg.norm(spin.sum(axis=1), axis=-1), alive)


def speed(recording: Recording) -> np.ndarray:
    """Give the mean speed of alive prey: [tick], m/s, NaN where nobody is alive."""
    alive, _, velocity = _alive(recording)
    return _mean(np.linalg.norm(velocity, axis=-1).sum(axis=1), alive)


def kinetic(recording: Recording) -> np.ndarray:
    """Give the kinetic energy of alive prey, Σ ½|v|²: [tick], m²/s², NaN where nobody is alive."""
    alive, _, velocity = _alive(recording)
    return np.where(alive.any(axis=1), 0.5 * (velocity**2).sum(axis=(1, 2)), np.nan)


def potential(recording: Recording) -> np.ndarray:
    """Give the potential energy of alive prey: [tick], m²/s², NaN where nobody is alive.

    spacing² Σ_{i<j} V(r), V(r) = 1/r² + ln r² with r in units of prey.spacing, constant beyond prey.perception (Tanner,
    Jadbabaie and Pappas 2003).
    """
    prey = recording.scenario.prey
    spacing2, reach2 = max(prey.spacing**2, TINY), prey.perception**2
    energy = np.full(recording.ticks + 1, np.nan)
    for tick, _, places in states(recording):
        energy[tick] = 0.0
        for first in range(0, len(places), ROWS):
            away = recording.shortest(places[first : first + ROWS, None] - places)
            pairs = np.triu(np.ones(away.shape[:2], bool), first + 1)  # each pair once
            ratio = np.maximum(np.minimum((away**2).sum(axis=-1)[pairs], reach2), TINY) / spacing2
            energy[tick] += prey.spacing**2 * (1 / ratio + np.log(ratio)).sum()
    return energy


def neighbour_distances(recording: Recording) -> np.ndarray:
    """Give the distance to each prey's nearest neighbour: [tick, agent], m, NaN for those who are gone or alone.

    In a periodic world it is measured across the edges where that is shorter.
    """
    distances = np.full(recording.prey.alive.shape, np.nan)
    for tick, here, places in states(recording, least=2):
        tree = _tree(places, recording)
        distances[tick, here] = tree.query(tree.data, k=2)[0][:, 1]
    return distances


def nearest(recording: Recording) -> np.ndarray:
    """Give the mean distance to the nearest neighbour: [tick], m, NaN where fewer than two prey are alive."""
    distances = neighbour_distances(recording)
    return _mean(np.nansum(distances, axis=1), np.isfinite(distances))


def least_distance(recording: Recording) -> np.ndarray:
    """Give the least distance of any two prey: [tick], m, NaN where fewer than two are alive."""
    distances = neighbour_distances(recording)
    least = np.where(np.isfinite(distances), distances, np.inf).min(axis=1)
    return np.where(np.isfinite(least), least, np.nan)


def stalled(recording: Recording) -> np.ndarray:
    """Tell where all alive prey stand still and none has arrived yet: [tick], 1 or 0, NaN where nobody is alive.

    Who stands still is slower than a hundredth of prey.max_speed.
    """
    alive, _, velocity = _alive(recording)
    still = ((velocity**2).sum(axis=-1) < (STILL * recording.scenario.prey.max_speed) ** 2).all(axis=1)
    home = ((recording.prey.fate == "arrived") & ~alive).any(axis=1)
    return np.where(alive.any(axis=1), still & ~home, np.nan)


def corrected(recording: Recording) -> np.ndarray:
    """Give the share of alive prey whose command a certificate changed in the move before: [tick], NaN where nobody is alive.

    A change is more than a millionth of prey.max_speed; there is none before the first move, nor without prey.safety.
    Errors: ValueError for a recording without terms, which does not know commands.
    """
    prey = recording.prey
    changed = np.zeros(prey.alive.shape, bool)
    if recording.scenario.prey.safety != "none":
        if not prey.terms:
            raise ValueError("corrected: a recording without terms knows no commands; record with terms=True")
        if "barrier" in prey.terms:
            change = np.linalg.norm(np.nan_to_num(prey.terms["barrier"][:-1]), axis=-1)
            changed[1:] = change > CHANGED * recording.scenario.prey.max_speed
    return _mean((changed & prey.alive).sum(axis=1), prey.alive)


def groups(recording: Recording, distance: float | None = None) -> np.ndarray:
    """Count the groups of alive prey: [tick], NaN where nobody is alive.

    A group is joined by chains of distances of at most `distance` [m], the scenario's measures.distance when None.
    """
    reach = recording.scenario.measures.distance if distance is None else distance
    count = np.full(recording.ticks + 1, np.nan)
    for tick, _, places in states(recording):
        first, second = _tree(places, recording).query_pairs(reach, output_type="ndarray").T
        joined = coo_array((np.ones(len(first), bool), (first, second)), shape=(len(places), len(places)))
        count[tick] = connected_components(joined, directed=False, return_labels=False)
    return count


def hits(recording: Recording) -> np.ndarray:
    """Count the prey that have been inside an obstacle so far: [tick].

    The start is not judged, and a touch in the very tick in which prey are captured or arrive is not in a recording.
    """
    position, touched = recording.prey.position, np.zeros(recording.prey.alive.shape, bool)
    for centre, radius in zip(recording.obstacle_position, recording.obstacle_radius, strict=True):
        size = recording.scenario.prey.radius + radius
        touched[1:] |= (recording.shortest(position[1:] - centre) ** 2).sum(axis=-1) < size**2
    return np.logical_or.accumulate(touched).sum(axis=1).astype(np.float64)


def settling_time(recording: Recording, after: int = 0) -> float:
    """Give when the mean speed was last above a twentieth of the greatest until then [s], NaN where nobody is alive.

    after: the tick that is the first to count.
    """
    values = speed(recording)[after:]
    ticks = np.flatnonzero(np.isfinite(values)) + after
    if not len(ticks):
        return float("nan")
    values = values[ticks - after]
    moving = ticks[values > SETTLED * np.maximum.accumulate(values)]
    return float(moving[-1] * recording.scenario.world.dt) if len(moving) else 0.0


def overshoot(recording: Recording, after: int = 0) -> float:
    """Give by what share of the last mean distance to the nearest neighbour the greatest is greater, NaN where there is none.

    after: the tick that is the first to count.
    """
    values = nearest(recording)[after:]
    values = values[np.isfinite(values)]
    return float(values.max() / max(values[-1], TINY) - 1.0) if len(values) else float("nan")


MEANS: dict[str, Callable[[Recording], np.ndarray]] = {
    "polarisation": polarisation,
    "milling": milling,
    "nearest": nearest,
    "groups": groups,
    "speed": speed,
    "kinetic": kinetic,
    "potential": potential,
    "stalled": stalled,
    "corrected": corrected,
}
"""Measures that a trial has as a mean over its states from measures.after on."""

LEAST: dict[str, Callable[[Recording], np.ndarray]] = {"least-distance": least_distance}
"""Measures of which a trial has the least over these states."""

LAST: dict[str, Callable[[Recording], np.ndarray]] = {
    "hits": hits,
    "coverage": coverage,
    "visit-variation": visit_variation,
    "trapped": trapped,
    "trapped-time": trapped_time,
    "trapped-milling": trapped_milling,
}
"""Measures that a trial has as they stand when it ends."""


WHOLE: dict[str, Callable[[Recording, int], float]] = {"settling-time": settling_time, "overshoot": overshoot}
"""Measures of all states from measures.after on together."""


def measured(recording: Recording, name: str) -> float:
    """Give what `results.measures[name]` is for this trial, NaN where no state has it.

    Errors: ValueError for an unknown name, and for a measure of swept ground where the scenario has no grid.
    """
    if name not in MEASURED:
        raise ValueError(f"measure: unknown '{name}'; {did_you_mean(name, list(MEASURED))}")
    after = min(recording.scenario.measures.after, recording.scenario.world.ticks)
    if name.startswith("time-to-"):
        return time_to(recording, int(name.removeprefix("time-to-")) / 100)
    if name in LAST:
        early = name == "hits" and recording.ticks < after
        return float("nan") if early else float(LAST[name](recording)[-1])
    if name in WHOLE:
        return WHOLE[name](recording, after)
    values = (MEANS | LEAST)[name](recording)[after:]
    values = values[np.isfinite(values)]
    if not len(values):
        return float("nan")
    return float(values.min() if name in LEAST else values.mean())


def _alive(recording: Recording) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Give who is alive, [tick, agent], and places and velocities with zeros for those who are not: [tick, agent, dim]."""
    prey = recording.prey
    there = prey.alive[..., None]
    return prey.alive, np.where(there, prey.position, 0.0), np.where(there, prey.velocity, 0.0)


def _units(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.sqrt(np.maximum((vectors**2).sum(axis=-1, keepdims=True), TINY))


def _mean(total: np.ndarray, counted: np.ndarray) -> np.ndarray:
    """Divide totals [tick] by how many agents are counted [tick, agent], NaN where none is."""
    count = counted.sum(axis=1)
    return np.divide(total, count, out=np.full(len(total), np.nan), where=count > 0)


def _tree(places: np.ndarray, recording: Recording) -> KDTree:
    """Sort places so that who is near whom is found fast, across the edges of a periodic world."""
    period = recording.period
    return KDTree(box.wrap(places, period), boxsize=period if period.any() else None)
