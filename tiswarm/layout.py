"""Layout: which code a scenario selects (structure), and where each of its numbers lies (columns of a table)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from types import SimpleNamespace
from typing import Any

import numpy as np
import taichi as ti

from tiswarm import registry
from tiswarm.scenario import Scenario

# Rows of an agent's numbers in a block: position, velocity, what contact decided, what it saw, and the next state.
X, Y, VX, VY, ALIVE, FATE, FIELD_X, FIELD_Y, SEEN, HIT, NEXT_X, NEXT_Y, NEXT_VX, NEXT_VY, AGENT_ROWS = range(15)
# Values of FATE, in the order of recording.FATES.
STAYS, ARRIVED, CAPTURED, CRASHED = range(4)
# Rows of an obstacle.
OBSTACLE_X, OBSTACLE_Y, OBSTACLE_RADIUS, OBSTACLE_ROWS = range(4)
# Rows of a block's clock: is the lane in use, has its trial ended, ticks run, and what is counted.
ON, DONE, AGE, ALIVE_COUNT, ARRIVED_COUNT, CAPTURED_COUNT, CRASHED_COUNT, FIRST_ARRIVAL, LAST_ARRIVAL, CLOCK_ROWS = range(10)
# Rows of a block's whole numbers: the trial in each lane (as random numbers know it), its tick, and its place in the batch.
TRIAL, TICK, JOB, INTEGER_ROWS = range(4)

ROLES = (("prey", "strategy"), ("prey", "avoidance"), ("predators", "strategy"), ("predators", "avoidance"))
_AGENT_NUMBERS = ("count", "radius", "perception", "spacing", "max_speed", "cohesion", "separation", "alignment", "goal")
_CORNERS = ("0.0", "0.1", "1.0", "1.1")


@dataclass(frozen=True)
class Part:
    """One strategy or avoidance whose code a kernel holds.

    mixed: whether only some trials of the batch use it, so that a weight `on` of 1 or 0 must tell.
    """

    kind: str
    role: str
    name: str
    mixed: bool

    @property
    def strategy(self) -> Any:
        """Give the class with its hooks."""
        where: Any = self.kind if self.role == "strategy" else "avoidance"
        return registry.load(where, self.name)


@dataclass(frozen=True)
class Structure:
    """What selects a kernel's code: two batches with equal structures share one kernel.

    hunted: whether there are predators at all.
    """

    parts: tuple[Part, ...]
    hunted: bool

    @classmethod
    def of(cls, scenarios: Sequence[Scenario], predator_count: int) -> "Structure":
        """Find the structure that serves all scenarios of a batch; predator_count: the most in any trial."""
        hunted = predator_count > 0
        parts = []
        for kind, role in ROLES if hunted else ROLES[:2]:
            chosen = [_chosen_parts(scenario, kind, role) for scenario in scenarios]
            for name in sorted(set().union(*chosen)):
                parts.append(Part(kind, role, name, mixed=not all(name in each for each in chosen)))
        return cls(tuple(parts), hunted)


def _chosen_parts(scenario: Scenario, kind: str, role: str) -> tuple[str, ...]:
    where: Any = kind if role == "strategy" else "avoidance"
    return registry.parts(where, getattr(getattr(scenario, kind), role))


class Layout:
    """Where each number of a batch lies in its table, by structure.

    at: nested names -> column, as kernels use them (at.prey.perception); parts(kind, role): what kernels loop over.
    """

    def __init__(self, structure: Structure, lanes: Any) -> None:
        self.structure = structure
        self.paths: list[str] = []
        self.at = SimpleNamespace(
            dt=self._column("world.dt"),
            ticks=self._column("world.ticks"),
            target=SimpleNamespace(
                x=self._column("target.position.0"), y=self._column("target.position.1"), radius=self._column("target.radius")
            ),
            obstacles=SimpleNamespace(
                count=self._column("obstacles.count"),
                radius=[self._column(f"obstacles.radius.{end}") for end in (0, 1)],
                region=[self._column(f"obstacles.region.{corner}") for corner in _CORNERS],
            ),
        )
        for kind in ("prey", "predators"):
            names = {name: self._column(f"{kind}.{name}") for name in _AGENT_NUMBERS}
            region = [self._column(f"{kind}.spawn.region.{corner}") for corner in _CORNERS]
            velocity = [self._column(f"{kind}.spawn.velocity.{corner}") for corner in _CORNERS]
            setattr(self.at, kind, SimpleNamespace(**names, region=region, velocity=velocity))
        self._parts: list[SimpleNamespace] = []
        self.agent_rows = {"prey": AGENT_ROWS, "predators": AGENT_ROWS}
        for part in structure.parts:
            self._add(part, lanes)

    def _column(self, path: str) -> int:
        self.paths.append(path)
        return len(self.paths) - 1

    def _add(self, part: Part, lanes: Any) -> None:
        strategy = part.strategy
        weights = [field.name for field in fields(strategy.Weights)]
        derived = list(strategy.derived({name: np.zeros(1) for name in weights}))
        names = ["on", *weights, *derived]
        memory = list(getattr(strategy, "memory", ()))
        notes = list(getattr(strategy, "notes", ())) or ["nothing"]
        row = self.agent_rows[part.kind]
        self.agent_rows[part.kind] += len(memory)
        self._parts.append(
            SimpleNamespace(
                part=part,
                strategy=strategy,
                names=names,
                columns=[self._column(f"{part.kind}.{part.role}:{part.name}.{name}") for name in names],
                memory=memory,
                memory_rows=list(range(row, row + len(memory))),
                Weights=ti.types.struct(**dict.fromkeys(names, lanes)),
                Memory=ti.types.struct(**dict.fromkeys(memory or ["nothing"], lanes)),
                note_names=notes,
                Notes=ti.types.struct(**dict.fromkeys(notes, lanes)),
            )
        )

    def parts(self, kind: str, role: str, hook: str | None = None) -> list[SimpleNamespace]:
        """List the parts of a role, or those of them that have a hook of their own."""
        found = [each for each in self._parts if (each.part.kind, each.part.role) == (kind, role)]
        return found if hook is None else [each for each in found if _overrides(each.strategy, hook)]

    def table(self, scenarios: Sequence[Scenario], weights: Mapping[str, np.ndarray] | None = None) -> np.ndarray:
        """Lay the numbers of scenarios out, one row each: [row, column], float64.

        weights: path -> [trial], numbers that differ from trial to trial; then one scenario gives as many rows as trials.
        """
        every = [scenario.numbers() for scenario in scenarios]
        rows = len(next(iter(weights.values()))) if weights else len(every)

        def numbers(path: str) -> np.ndarray:
            if weights and path in weights:
                return np.asarray(weights[path], np.float64)
            values = np.array([each.get(path, 0.0) for each in every])
            return values if len(values) == rows else np.repeat(values, rows)

        columns = {path: numbers(path) for path in self.paths if ":" not in path}
        for each in self._parts:
            part = each.part
            own = {field.name: numbers(f"{part.kind}.weights.{field.name}") for field in fields(each.strategy.Weights)}
            on = np.array([float(part.name in _chosen_parts(scenario, part.kind, part.role)) for scenario in scenarios])
            own |= {"on": np.resize(on, rows)} | each.strategy.derived(own)
            columns |= {f"{part.kind}.{part.role}:{part.name}.{name}": own[name] for name in each.names}
        return np.stack([np.broadcast_to(columns[path], rows) for path in self.paths], axis=1)


def _overrides(strategy: type, hook: str) -> bool:
    base = [cls for cls in strategy.__mro__ if cls is not object][-1]
    return getattr(strategy, hook) is not getattr(base, hook)
