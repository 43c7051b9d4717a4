"""Pack: a recording as what the page reads, a header of plain values and one block of compressed numbers.

docs/page.md describes the format. Whole numbers are told by how they differ from what the ticks before them promise, and the
bytes of equal weight lie together: smooth paths become runs of zeros, which compress well.
"""

import base64
import zlib
from collections.abc import Mapping
from typing import Any

import numpy as np

from render.scene.background import Field
from render.scene.rigs import heights
from render.source import Live, is_sky, target_of
from tiswarm.measures import recorded
from tiswarm.records.recording import FATES, Recording, Swarm

FORMAT = 1
"""Number of the format, which the page checks."""

COARSE = 65_534
"""Steps of 16 bits between the lowest and the highest value."""

WORK = 100_000_000
"""The potential energy, which compares all pairs at every tick, is left out beyond so many comparisons."""

Header = dict[str, Any]


class Sections:
    """The numbers of one recording, section by section, and where each lies."""

    def __init__(self) -> None:
        """Begin with none."""
        self.places: dict[str, Header] = {}
        self._parts: list[bytes] = []
        self._length = 0

    def _add(self, name: str, whole: np.ndarray, order: int, **told: Any) -> None:
        """Write whole numbers [tick, ...], as their differences of some order along the ticks."""
        bits = whole.dtype.itemsize * 8
        for _ in range(order):
            whole = np.concatenate([whole[:1], np.diff(whole, axis=0)])
        signed = whole.view(f"<i{bits // 8}")
        folded = np.ascontiguousarray((signed << 1) ^ (signed >> (bits - 1)))  # small numbers of either sign have no high bytes
        planes = folded.view(np.uint8).reshape(-1, bits // 8).T
        raw = planes.tobytes()
        shape = list(whole.shape)
        self.places[name] = {"at": self._length, "bits": bits, "shape": shape, "order": order, **told}
        self._parts.append(raw)
        self._length += len(raw)

    def coded(self, name: str, codes: np.ndarray) -> None:
        """Add small whole numbers [tick, agent], at least -1 and below 65 535."""
        self._add(name, (codes.astype(np.int64) + 1).astype(np.dtype("<u2")), 1, kind="codes")

    def exact(self, name: str, values: np.ndarray) -> None:
        """Add numbers [tick, ...] as float32, NaN for none."""
        self._add(name, values.astype(np.dtype("<f4")).view(np.dtype("<u4")), 1, kind="float")

    def coarse(self, name: str, values: np.ndarray, low: np.ndarray, high: np.ndarray, order: int) -> None:
        """Add numbers [tick, agent, dim] as 16 bits between low and high [dim]; NaN has no meaning in it."""
        step = np.where(high > low, (high - low) / COARSE, 1.0)
        known = np.isfinite(values)
        whole = np.round((np.where(known, values, low) - low) / step).astype(np.int64)
        ends = known.sum(axis=0)
        for tick in range(1, len(whole)):  # those who are gone go on as they went, which needs no numbers
            gone = tick >= ends
            if gone.any():
                promised = whole[tick - 1] * 2 - whole[max(tick - 2, 0)] if order == 2 else whole[tick - 1]
                whole[tick] = np.where(gone, promised, whole[tick])
        self._add(name, (whole % 65_536).astype(np.dtype("<u2")), order, kind="scaled", low=low.tolist(), step=step.tolist())

    def packed(self) -> str:
        """Give all sections, compressed, as base64."""
        return base64.b64encode(zlib.compress(b"".join(self._parts), 6)).decode("ascii")


def packed(recording: Recording, *, exact: bool = False, field: Field | None = None) -> tuple[Header, str]:
    """Give the header and the numbers of a recording. exact: float32 instead of 16 bits. field: arrows of an avoidance."""
    sections = Sections()
    header = told(recording, {"prey": recording.prey.count, "predators": recording.predators.count})
    both = (recording.prey, recording.predators)
    if any((each.alive.any(axis=0) & ~each.alive[0]).any() for each in both):
        raise ValueError("page: somebody comes after the start, which pages cannot show; film the recording instead")
    places = np.concatenate([each.position.reshape(-1, recording.dim) for each in both])
    places = places[np.isfinite(places[:, 0])]
    box = (places.min(axis=0), places.max(axis=0)) if len(places) else (np.zeros(recording.dim), np.ones(recording.dim))
    for kind, swarm in zip(("prey", "predators"), both, strict=True):
        if swarm.count:
            header[kind] |= _swarm(sections, kind, swarm, box, exact)
    header["measures"] = _measures(sections, recording)
    if field is not None and np.any(field.arrows):
        sections.exact("field", np.concatenate([field.points, field.arrows], axis=1))
    header["sections"] = sections.places
    return header, sections.packed()


def _swarm(sections: Sections, kind: str, swarm: Swarm, box: tuple[np.ndarray, np.ndarray], exact: bool) -> dict[str, Any]:
    """Add the path of one kind of agents; give what else is to be said of them."""
    names, codes = np.unique(swarm.state, return_inverse=True)
    sections.coded(f"{kind}.state", codes.reshape(swarm.state.shape))
    sections.coded(f"{kind}.group", swarm.group)
    ends = swarm.alive.sum(axis=0)
    for name, values, order in (("position", swarm.position, 2), ("velocity", swarm.velocity, 1)):
        if exact:
            sections.exact(f"{kind}.{name}", values)
        else:
            low, high = box if name == "position" else _around_zero(values)
            sections.coarse(f"{kind}.{name}", values, low, high, order)
    for name, values in swarm.terms.items():
        if exact:
            sections.exact(f"{kind}.terms.{name}", values)
        else:
            sections.coarse(f"{kind}.terms.{name}", values, *_around_zero(values), 1)
    return {
        "states": names.tolist(),
        "terms": list(swarm.terms),
        "fate": [FATES.index(each) for each in swarm.fate],
        "end": [int(end) if end <= len(swarm.position) - 1 else None for end in ends],
        "judged": [
            [_short(x) for x in place] if np.isfinite(place[0]) else None
            for place in ([] if swarm.judged is None else swarm.judged)
        ],
    }


def _around_zero(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Give a range for numbers [tick, agent, dim] in whose middle, exactly, lies zero."""
    most = np.nanmax(np.abs(values), axis=(0, 1), initial=1e-9, where=np.isfinite(values))
    return -most, most


def told(recording: Recording | Live, counts: Mapping[str, int]) -> Header:
    """Give what is known of a recording, or of a simulation, beside its numbers. counts: how many agents of each kind."""
    scenario = recording.scenario
    target, world = target_of(recording), scenario.world
    header: Header = {
        "format": FORMAT,
        "title": scenario.title,
        "source": scenario.source,
        "preset": scenario.preset,
        "seed": recording.seed,
        "trial": recording.trial,
        "ticks": recording.ticks,
        "dim": world.dim,
        "dt": world.dt,
        "size": list(world.size),
        "heights": list(heights(recording)),
        "boundary": world.boundary,
        "sky": is_sky(recording),
        "areas": [{"label": a.label, "low": list(a.region.low), "high": list(a.region.high)} for a in world.areas],
        "target": {"position": list(target.position), "radius": target.radius} if target else None,
        "obstacles": [
            [*map(_short, place), _short(radius)]
            for place, radius in zip(recording.obstacle_position, recording.obstacle_radius, strict=True)
        ],
        "swept": {"cell": scenario.coverage.cell, "tool": scenario.coverage.tool} if scenario.coverage.cell else None,
    }
    for kind, agents in (("prey", scenario.prey), ("predators", scenario.predators)):
        header[kind] = {
            "count": counts[kind],
            "strategy": agents.strategy,
            "avoidance": agents.avoidance,
            "radius": agents.radius,
            "perception": agents.perception,
            "view": agents.field_of_view,
            "nearest": None if agents.nearest == "all" else agents.nearest,
            "states": [],
            "terms": [],
            "fate": [],
            "end": [],
        }
    return header


def _short(value: float) -> float:
    return float(f"{value:.7g}")


def _measures(sections: Sections, recording: Recording) -> list[str]:
    """Add what the plots show, [tick] each; give the names. Counts need none: the page counts."""
    found: Mapping[str, Any] = {
        "polarisation": recorded.polarisation,
        "nearest": recorded.nearest,
        "kinetic": recorded.kinetic,
    }
    found = dict(found)
    if recording.prey.count**2 * recording.ticks <= WORK:
        found["potential"] = recorded.potential
    if recording.scenario.coverage.cell:
        found["coverage"] = recorded.coverage
    for name, measure in found.items():
        sections.exact(f"measure.{name}", measure(recording)[:, None])
    return list(found)
