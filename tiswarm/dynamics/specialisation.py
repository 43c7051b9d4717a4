"""Specialisation: what selects a kernel's code: which strategies, in which kind of world."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from tiswarm.dynamics import network_columns
from tiswarm.scenario.errors import ScenarioError
from tiswarm.scenario.model import Scenario
from tiswarm.scenario.network import Shape
from tiswarm.space import box
from tiswarm.strategies import registry


@dataclass(frozen=True)
class Part:
    """One strategy or avoidance whose code a kernel holds.

    mixed: whether only some trials of the batch use it, so that a weight `on` of 1 or 0 must tell; shape: of its network.
    """

    kind: registry.Side
    role: registry.Role
    catalogue: registry.Kind
    name: str
    mixed: bool
    shape: Shape | None = None

    @property
    def strategy(self) -> Any:
        """Give the class with its hooks."""
        return registry.load(self.catalogue, self.name)


@dataclass(frozen=True)
class WorldKind:
    """What all scenarios of one batch must have in common: the kind of world, and what is measured in it.

    unicycles, slow: which kinds of agents are driven so, and which have a least speed; narrow, choosy: which do not see behind
    them, and which heed the nearest mates alone; cells: of the coverage grid, (0, 0) without one. plan: how prey use planned
    ways, nothing where they go straight; plan_cells: of the ways' grid. safety: the form of the prey's certificates, nothing
    without; apart: which kinds of agents keep a distance at the start.
    """

    dim: int
    boundary: str
    wrap_sight: bool
    contact: str
    swept: bool
    verlet: bool
    per_second: bool
    targeted: bool
    counts_hits: bool
    clear: bool
    shapes: tuple[str, str]
    capped: tuple[bool, bool]
    unicycles: tuple[str, ...]
    slow: tuple[str, ...]
    narrow: tuple[str, ...]
    choosy: tuple[str, ...]
    measures: tuple[str, ...]
    cells: tuple[int, int]
    plan: str
    plan_cells: tuple[int, int]
    safety: str
    apart: tuple[str, ...]

    @classmethod
    def of(cls, scenario: Scenario) -> "WorldKind":
        """Find the frame of a scenario."""
        world, agents = scenario.world, {"prey": scenario.prey, "predators": scenario.predators}
        cell, planning = scenario.coverage.cell, scenario.planning
        planned = scenario.prey.goal_by == "path"
        return cls(
            dim=world.dim,
            boundary=world.boundary,
            wrap_sight=box.wraps(world.boundary) and world.wrap_sight,
            contact=world.contact,
            swept=world.contact_test == "swept",
            verlet=world.scheme == "verlet",
            per_second=world.gains == "per-second",
            targeted=scenario.target.present,
            counts_hits=scenario.obstacles.contact == "count",
            clear=scenario.obstacles.clear,
            shapes=(scenario.prey.spawn.shape, scenario.predators.spawn.shape),
            capped=(scenario.prey.spawn.capped, scenario.predators.spawn.capped),
            unicycles=tuple(kind for kind, each in agents.items() if each.drive == "unicycle"),
            slow=tuple(kind for kind, each in agents.items() if each.min_speed > 0),
            narrow=tuple(kind for kind, each in agents.items() if each.field_of_view < 360),
            choosy=tuple(kind for kind, each in agents.items() if each.nearest != "all"),
            measures=scenario.measures.names,
            cells=(int(np.ceil(world.size[0] / cell)), int(np.ceil(world.size[1] / cell))) if cell else (0, 0),
            plan=planning.plan if planned else "",
            plan_cells=planning.cells(world.size) if planned else (0, 0),
            safety=scenario.barrier.form if scenario.prey.safety == "barrier" else "",
            apart=tuple(kind for kind, each in agents.items() if each.spawn.apart > 0),
        )


@dataclass(frozen=True)
class Specialisation:
    """What selects a kernel's code: two batches with equal structures share one kernel.

    hunted: whether there are predators at all. mortal: whether anybody may die or arrive, or be seen by opponents.
    terms: whether agents note their velocity behind each term of a move.
    commanded: which kinds of agents obey a program outside, and what it tells them (commands.py).
    """

    frame: WorldKind
    parts: tuple[Part, ...]
    hunted: bool
    mortal: bool = True
    terms: bool = False
    commanded: tuple[tuple[str, str], ...] = ()

    @classmethod
    def of(
        cls,
        scenarios: Sequence[Scenario],
        predator_count: int,
        *,
        mortal: bool = True,
        terms: bool = False,
        commanded: tuple[tuple[str, str], ...] = (),
    ) -> "Specialisation":
        """Find the structure that serves all scenarios of a batch; predator_count: the most in any trial.

        mortal: as above; small trials always are, so that those with and without obstacles share a kernel.

        Errors: ScenarioError when their worlds are of different kinds.
        """
        frames = {WorldKind.of(scenario) for scenario in scenarios}
        if len(frames) > 1:
            one, other = list(frames)[:2]
            name = next(field.name for field in fields(WorldKind) if getattr(one, field.name) != getattr(other, field.name))
            told = f"{getattr(one, name)} and {getattr(other, name)}"
            raise ScenarioError(f"batch: scenarios differ in {name} ({told}); run them one after the other")
        hunted = predator_count > 0
        parts = []
        for same in zip(*(registry.roles(scenario) for scenario in scenarios), strict=True):
            kind, role, catalogue, _ = same[0]
            if kind == "predators" and not hunted:
                continue
            chosen = [registry.parts(catalogue, name) for *_, name in same]
            for name in sorted(set().union(*chosen)):
                mixed = not all(name in each for each in chosen)
                users = [scenario for scenario, own in zip(scenarios, chosen, strict=True) if name in own]
                shape = network_columns.shape_of(users, kind) if role == "strategy" else None
                parts.append(Part(kind, role, catalogue, name, mixed, shape))
        return cls(frames.pop(), tuple(parts), hunted, mortal, terms, commanded)
