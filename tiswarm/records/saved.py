"""Saved: the files that the thesis's simulator wrote for its web page (Lupau 2022), read as recordings.

One JSON document a trial: `environments` has an entry a tick, the start first, with a `header` and a `structure`: map, target,
obstacles, `swarm_agents` (prey) and `projectiles` (predators). Whoever is gone is missing from then on.
"""

import json
import math
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tiswarm.records.labels import named
from tiswarm.records.recording import Recording, Swarm
from tiswarm.scenario.errors import ScenarioError
from tiswarm.scenario.model import Scenario, validated
from tiswarm.scenario.words import literal
from tiswarm.strategies import registry

_LISTS: dict[registry.Kind, str] = {"prey": "swarm_agents", "predators": "projectiles"}

_ALIASES = {"kitchensink": "kitchen-sink", "outwards-field": "outward"}

_FARTHEST = 1e12
"""Numbers beyond this are damage, not metres."""

_HUNTERS = (("center", "centre"), ("png", "pronav"), ("cluster", "cluster"))
"""What the name of a configuration says of its predators."""


def is_saved(path: str | os.PathLike) -> bool:
    """Tell whether a file looks like a saved simulation, as it begins; a study's manifest does not."""
    with Path(path).open("rb") as file:
        return b'"environments"' in file.read(4096)


def load_saved(path: str | os.PathLike) -> Recording:
    """Read a saved simulation.

    Strategies are not in the file: they are taken from the name of its configuration, where that names one. Fates are not
    either: whoever is missing met what was nearest to where it was about to be, the target, a predator that went in the same
    tick, or an obstacle.

    Errors: ValueError when the file is no saved simulation; OSError when it cannot be read.
    """
    try:
        return _recording(json.loads(Path(path).read_text(encoding="utf-8")))
    except (ValueError, TypeError, KeyError, RecursionError, OverflowError) as error:
        reason = f"{error} is missing" if isinstance(error, KeyError) else " ".join(str(error).split())
        raise ValueError(f"{path}: not a simulation saved by the thesis's simulator ({reason[:200]})") from None


def _recording(told: Any) -> Recording:
    ticks = _listed(_mapping(told, "the document").get("environments"), "environments")
    if not ticks:
        raise ValueError("environments has no entry")
    structures = [_mapping(_mapping(each, "an environment").get("structure"), "structure") for each in ticks]
    paths = {kind: _paths(structures, name) for kind, name in _LISTS.items()}
    if not paths["prey"][0].shape[1]:
        raise ValueError("swarm_agents is empty at the start")
    rings = [_mapping(each, "an obstacle") for each in _listed(structures[0].get("obstacles", []), "obstacles")]
    centres = np.array([_point(each["position"]) for each in rings]).reshape(-1, 2)
    radii = np.array([_number(each["radius"]) for each in rings])
    scenario = _scenario(told, ticks[0], structures[0], len(rings), {kind: each[0].shape[1] for kind, each in paths.items()})
    swarms: dict[str, Swarm] = {}
    pairs: tuple[tuple[registry.Kind, registry.Kind], ...] = (("prey", "predators"), ("predators", "prey"))
    for kind, other in pairs:
        (position, velocity), rivals = paths[kind], paths[other][0]
        moments = zip(position, velocity, rivals, strict=True)
        state = np.stack([named(scenario, kind, own, speeds, others, {}) for own, speeds, others in moments])
        group = np.full(state.shape, -1, np.int32)
        fate = _fates(scenario, kind, position, velocity, rivals, centres, radii)
        swarms[kind] = Swarm(position, velocity, fate, state, group)
    recording = Recording(scenario, 0, 0, swarms["prey"], swarms["predators"], centres, radii)
    recording.check()
    return recording


def _mapping(value: Any, what: str) -> Mapping[str, Any]:
    if not isinstance(value, dict):
        raise ValueError(f"{what} is no object")
    return value


def _listed(value: Any, what: str) -> Sequence[Any]:
    if not isinstance(value, list):
        raise ValueError(f"{what} is no list")
    return value


def _number(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise ValueError(f"{str(value)[:40]} is no number")
    if abs(value) > _FARTHEST:
        raise ValueError(f"{value:.3g} is too large")
    return float(value)


def _point(value: Any) -> tuple[float, float]:
    if not isinstance(value, list) or len(value) != 2:
        raise ValueError(f"{str(value)[:40]} is no point of two numbers")
    return _number(value[0]), _number(value[1])


def _paths(structures: Sequence[Mapping[str, Any]], name: str) -> tuple[np.ndarray, np.ndarray]:
    """Give positions and velocities of one kind of agents: [tick, agent, 2] each, NaN once gone."""
    order: dict[str, int] = {}
    rows = []
    for tick, structure in enumerate(structures):
        agents = [_mapping(each, "an agent") for each in _listed(structure.get(name, []), name)]
        here = {str(each["id"]): (*_point(each["position"]), *_point(each["velocity"])) for each in agents}
        if len(here) < len(agents):
            raise ValueError(f"{name} has an id twice at tick {tick}")
        if tick == 0:
            order = {each: number for number, each in enumerate(here)}
        for each in here:
            if each not in order:
                raise ValueError(f"{name}: {each[:40]} appears at tick {tick}, after the start")
        rows.append([here.get(each, (math.nan,) * 4) for each in order])
    numbers = np.array(rows, float).reshape(len(rows), len(order), 4)
    return numbers[..., :2], numbers[..., 2:]


def _scenario(
    told: Mapping[str, Any], tick: Mapping[str, Any], structure: Mapping[str, Any], obstacles: int, counts: Mapping[str, int]
) -> Scenario:
    """Give the scenario, as far as the file tells."""
    header = _mapping(tick.get("header", {}), "header")
    ground, area = _mapping(structure["map_structure"], "map_structure"), structure.get("target_area")
    danger, safe, height = (_number(ground[key]) for key in ("danger_area_width", "safe_area_width", "map_height"))
    edges = {"danger area": (0.0, danger), "safe area": (danger, danger + safe)}
    words = (str(told.get("timestamp", "")), str(told.get("associated_config_file", "")))
    table: dict[str, Any] = {
        "title": literal(str(told.get("name", ""))) or "Untitled",
        "source": ", ".join(["saved by the thesis's simulator", *(each for each in words if each)]),
        "world": {
            "size": [danger + safe, height],
            "ticks": max(int(_number(header.get("max_ticks", 1))), 1),
            "dt": _number(header.get("delta_time", 1)),
            "areas": [{"label": name, "region": [[a, 0.0], [b, height]]} for name, (a, b) in edges.items() if b > a],
        },
        "obstacles": {"count": obstacles},
        "target": {"present": False},
    }
    if area is not None:
        place = _mapping(area, "target_area")
        table["target"] = {"position": _point(place["position"]), "radius": _number(place["size"])}
    named_by = _named_by(words[1])
    for kind, name in _LISTS.items():
        agents = structure.get(name, [])
        table[kind] = {"count": counts[kind], **named_by[kind]}
        for key, path in (("size", "radius"), ("perception_distance", "perception"), ("swarm_distance", "spacing")):
            if agents and key in agents[0]:
                table[kind][path] = _number(agents[0][key])
    try:
        return validated(table)
    except ScenarioError as error:
        raise ValueError(str(error)) from None


def _named_by(configuration: str) -> dict[str, dict[str, str]]:
    """Give strategies that a configuration's name tells, "obstacle_avoidance_10/spiral_field.json" for example."""
    study, _, stem = configuration.rpartition("/")
    name = stem.removesuffix(".json").replace("_", "-")
    name = _ALIASES.get(name, name.removesuffix("-field"))
    prey: dict[str, str] = {}
    if name in registry.names("prey"):
        prey["strategy"] = name
    elif name in registry.names("avoidance"):
        prey["avoidance"] = name
    hunters = next((strategy for word, strategy in _HUNTERS if word in (study or stem)), None)
    return {"prey": prey, "predators": {"strategy": hunters} if hunters else {}}


def _fates(
    scenario: Scenario,
    kind: registry.Kind,
    position: np.ndarray,
    velocity: np.ndarray,
    rivals: np.ndarray,
    centres: np.ndarray,
    radii: np.ndarray,
) -> np.ndarray:
    """Say what became of each agent: [agent]. Of several things that it may have met, the one it was deepest in."""
    agents, others = (scenario.prey, scenario.predators) if kind == "prey" else (scenario.predators, scenario.prey)
    fate = np.full(position.shape[1], "alive", dtype="<U8")
    there, ends = np.isfinite(position[..., 0]), np.isfinite(rivals[..., 0]).sum(axis=0)
    for agent, end in enumerate(there.sum(axis=0)):
        if end == len(position):
            continue
        spot = position[end - 1, agent] + velocity[end - 1, agent] * scenario.world.dt
        met = {"crashed": math.inf}
        if len(radii):
            met["crashed"] = float((np.linalg.norm(centres - spot, axis=1) - radii).min()) - agents.radius
        gone = rivals[end - 1, ends == end]
        if len(gone):
            met["captured"] = float(np.linalg.norm(gone - spot, axis=1).min()) - agents.radius - others.radius
        if kind == "prey" and scenario.target.present:
            met["arrived"] = float(np.linalg.norm(np.subtract(scenario.target.position, spot))) - scenario.target.radius
        fate[agent] = min(met, key=lambda name: met[name])
    return fate
