"""Tracks: paths in long form, a row for each agent and tick, and recordings made of such tables."""

import csv
import io
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from tiswarm.records.recording import Recording, Swarm
from tiswarm.scenario.model import validated
from tiswarm.scenario.words import literal
from tiswarm.space import box
from tiswarm.system.extras import needed

if TYPE_CHECKING:
    import pandas as pd

MOST_ROWS = 50_000_000
"""Ticks times agents that a table of tracks may ask for."""


def columns_of(recording: Recording) -> dict[str, np.ndarray]:
    """Lay a path out in long form, those who are gone left out: tick by tick, prey first.

    tick, time [s], agent (prey from 0, then predators), kind, x, y (and z) [m], vx, vy (and vz) [m/s], state, group.
    """
    ticks, agents, kinds, rest, first = [], [], [], [], 0
    for kind, swarm in (("prey", recording.prey), ("predators", recording.predators)):
        tick, agent = np.nonzero(swarm.alive)
        ticks.append(tick)
        agents.append(agent + first)
        kinds.append(np.full(len(tick), kind, "<U9"))
        rest.append([getattr(swarm, name)[tick, agent] for name in ("position", "velocity", "state", "group")])
        first += swarm.count
    tick = np.concatenate(ticks)
    order = np.argsort(tick, kind="stable")
    position, velocity, state, group = (np.concatenate(each)[order] for each in zip(*rest, strict=True))
    axes = "xyz"[: recording.dim]
    return {
        "tick": tick[order],
        "time": tick[order] * recording.scenario.world.dt,
        "agent": np.concatenate(agents)[order],
        "kind": np.concatenate(kinds)[order],
        **{axis: position[:, k] for k, axis in enumerate(axes)},
        **{f"v{axis}": velocity[:, k] for k, axis in enumerate(axes)},
        "state": state,
        "group": group,
    }


def csv_of(recording: Recording) -> str:
    """Write a path in long form."""
    columns = columns_of(recording)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*(each.tolist() for each in columns.values()), strict=True))
    return text.getvalue()


def tracks_of(recording: Recording) -> "pd.DataFrame":
    """Lay a path out under the names of trackpy (frame, particle) and with a time `t` for movingpandas."""
    pandas = needed("data", "pandas")
    columns = columns_of(recording)
    time = columns.pop("time")
    named = {"frame": columns.pop("tick"), "particle": columns.pop("agent")}
    moment = pandas.to_datetime(np.round(time * 1e9).astype(np.int64))  # since 1970, as movingpandas wants days
    frame = pandas.DataFrame({**named, "t": moment, **columns})
    frame.attrs = {"title": recording.scenario.title, "unit": "m", "dt": recording.scenario.world.dt}
    return frame


def recording_of(
    tracks: Any, size: Sequence[float] | None, boundary: str, dt: float, radius: float | None, title: str
) -> Recording:
    """Make a recording of tracks: see `Recording.from_tracks`."""
    numbers, kinds, names = _checked(tracks)
    frames = numbers[:, 0].astype(np.int64)
    first, last = int(frames.min()), int(frames.max())
    particles, agent = np.unique(numbers[:, 1], return_inverse=True)
    rows = last - first + 1
    if rows * len(particles) > MOST_ROWS:
        raise ValueError(f"tracks: {rows:,} frames of {len(particles):,} particles are too many; cut the table into parts")
    places = np.full((rows, len(particles), len(names)), np.nan)
    if len({*zip(frames.tolist(), agent.tolist(), strict=True)}) < len(frames):
        raise ValueError("tracks: a particle stands in one frame twice; keep one row for each")
    places[frames - first, agent] = numbers[:, 2:]
    low, high = numbers[:, 2:].min(axis=0), numbers[:, 2:].max(axis=0)
    if size is None:
        if boundary != "open":
            raise ValueError(f"size: say how large the world with boundary '{boundary}' is, such as size=(100, 50)")
        places -= low  # the world's corner is the origin
        size = np.maximum(high - low, 1e-3 * max(float((high - low).max()), 1e-3))
    hunts = np.zeros(len(particles), bool)
    hunts[agent] = kinds == "predators"
    if (hunts[agent] != (kinds == "predators")).any():
        raise ValueError("tracks: a particle is prey in one row and a predator in another; give it one kind")
    if hunts.all():
        raise ValueError("tracks: all are predators; a recording needs prey, the plain kind of agent")
    body = 0.004 * float(max(size)) if radius is None else float(radius)
    scenario = validated(_table(size, boundary, dt, rows - 1, hunts, body, title))
    period = box.period(scenario.world.size, boundary)
    if box.wraps(boundary):
        places = box.wrap(places, period)
    swarms = [_swarm(places[:, who], period, dt) for who in (~hunts, hunts)]
    recording = Recording(scenario, 0, 0, swarms[0], swarms[1], np.zeros((0, len(names))), np.zeros(0))
    recording.check()
    return recording


def _checked(tracks: Any) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """Give frame, particle and places [row, ...], the kind of each row, and the axes. Errors: ValueError."""
    names = [name for name in "xyz" if name in tracks]
    aliases = {"frame": "tick", "particle": "agent"}
    found = {name: name if name in tracks else other for name, other in aliases.items()}
    missing = [name for name, other in found.items() if other not in tracks] + [each for each in "xy" if each not in names]
    if missing:
        raise ValueError(f"tracks: no column {', '.join(missing)}; name them frame, particle, x, y and, in space, z")
    try:
        numbers = np.stack([np.asarray(tracks[name], np.float64) for name in (*found.values(), *names)], axis=1)
    except (TypeError, ValueError):
        raise ValueError(f"tracks: columns {', '.join((*found.values(), *names))} must hold numbers alone") from None
    if not len(numbers):
        raise ValueError("tracks: no rows; there is nothing to show")
    if not np.isfinite(numbers).all():
        raise ValueError("tracks: a number is missing or infinite; drop these rows, as with tracks.dropna()")
    if (numbers[:, :2] != np.round(numbers[:, :2])).any():
        raise ValueError("tracks: frame and particle must be whole numbers; count frames, not seconds")
    kinds = np.asarray(tracks["kind"]).astype(str) if "kind" in tracks else np.full(len(numbers), "prey")
    unknown = sorted(set(kinds) - {"prey", "predators"})
    if unknown:
        raise ValueError(f"tracks: kind '{unknown[0]}' is unknown; use 'prey' or 'predators'")
    return numbers, kinds, names


def _table(size: Any, boundary: str, dt: float, ticks: int, hunts: np.ndarray, radius: float, title: str) -> dict[str, Any]:
    """Give a scenario in which nothing acts: the ground that tracks are shown on."""
    still = {"avoidance": "none", "cohesion": 0.0, "separation": 0.0, "alignment": 0.0, "goal": 0.0}
    corner, far = [0.0] * len(size), [float(side) for side in size]
    agents = {**still, "radius": radius, "perception": 0.0, "spawn": {"region": [corner, far], "velocity": [corner, corner]}}
    return {
        "title": literal(title),
        "source": "tracks",
        "world": {"size": far, "ticks": max(ticks, 1), "dt": float(dt), "boundary": boundary, "contact": "none"},
        "target": {"present": False},
        "obstacles": {"region": [corner, far]},
        "prey": {**agents, "count": int((~hunts).sum())},
        "predators": {**agents, "count": int(hunts.sum())},
    }


def _swarm(places: np.ndarray, period: np.ndarray, dt: float) -> Swarm:
    """Fill gaps within tracks by straight ways, and take velocities from the places before and after."""
    rows, count, _ = places.shape
    filled = places.copy()
    velocity = np.full_like(places, np.nan)
    for agent in range(count):
        there = np.flatnonzero(np.isfinite(places[:, agent, 0]))
        ways = box.displacement(np.diff(places[there, agent], axis=0), period)
        unrolled = places[there[0], agent] + np.concatenate([np.zeros((1, places.shape[2])), np.cumsum(ways, axis=0)])
        own = np.arange(there[0], there[-1] + 1)
        path = np.stack([np.interp(own, there, column) for column in unrolled.T], axis=1)
        filled[own, agent] = box.wrap(path, period) if period.any() else path
        filled[there, agent] = places[there, agent]  # without the sum's rounding
        velocity[own, agent] = np.gradient(path, dt, axis=0) if len(own) > 1 else 0.0
    state, group = np.full((rows, count), "calm", "<U12"), np.full((rows, count), -1, np.int32)
    return Swarm(filled, velocity, np.full(count, "alive", "<U8"), state, group)
