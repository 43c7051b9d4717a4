"""Table: where each number of a scenario lies in the table of a batch, a column each, a row a trial."""

from collections.abc import Mapping, Sequence
from dataclasses import fields
from types import SimpleNamespace
from typing import Any

import numpy as np
import taichi as ti

from tiswarm.dynamics import network_columns, terms
from tiswarm.dynamics.rows import JOINT_ROWS, agent_rows
from tiswarm.dynamics.specialisation import Part, Specialisation
from tiswarm.scenario.model import Scenario
from tiswarm.strategies import registry

GAINS = ("separation", "alignment", "cohesion", "goal", "field")
"""What agents that are told factors of their gains are told, in this order."""

_AGENT_NUMBERS = ("count", "radius", "perception", "spacing", "max_speed", "cohesion", "separation", "alignment", "goal")


class ParameterTable:
    """Where each number of a batch lies in its table, by structure.

    at: nested names -> column, as kernels use them (at.prey.perception); rows: of an agent, which begin with those that all
    have; filled_rows: kind -> how many with the strategies' memory; agent_rows: the same, or one more that nobody uses;
    obstacle_rows: centre and radius; plan: rows of the board on which ways are found; joint: the first of those on which
    commands are corrected together; board: rows of these and of what predators' surveys write, fixed ones and for each prey;
    courses: kind -> term -> rows of the velocity behind it, in a move's order, where terms are noted; commands: kind -> rows
    of what agents that obey are told; parts(kind, role): what kernels loop over, each with its class (strategy), the hooks it
    has of its own (own), and its structs.
    """

    def __init__(self, structure: Specialisation, lanes: Any) -> None:
        self.structure = structure
        self.paths: list[str] = []
        self.axes = range(structure.frame.dim)
        frame = structure.frame
        self.rows = agent_rows(
            frame.dim, bool(frame.unicycles), frame.measures, frame.swept, frame.plan == "list", bool(frame.safety)
        )
        self.obstacle_rows = structure.frame.dim + 1
        self.at = SimpleNamespace(
            dt=self._column("world.dt"),
            ticks=self._column("world.ticks"),
            size=self._vector("world.size"),
            margin=self._column("world.margin"),
            turn_factor=self._column("world.turn_factor"),
            after=self._column("measures.after"),
            distance=self._column("measures.distance"),
            cell=self._column("coverage.cell"),
            tool=self._column("coverage.tool"),
            target=SimpleNamespace(place=self._vector("target.position"), radius=self._column("target.radius")),
            obstacles=SimpleNamespace(
                count=self._column("obstacles.count"),
                radius=[self._column(f"obstacles.radius.{end}") for end in (0, 1)],
                region=self._box("obstacles.region"),
            ),
        )
        for kind in ("prey", "predators"):
            setattr(self.at, kind, self._agents(kind))
        if self.rows.trap:
            self.at.trap = SimpleNamespace(**{name: self._column(f"measures.{name}") for name in ("window", "within", "path")})
        self._parts: list[SimpleNamespace] = []
        self.agent_rows = {"prey": self.rows.count, "predators": self.rows.count}
        self.plan = self._plan(*frame.plan_cells)
        if frame.safety:
            keys = ("radius", "gain", "wall_share")
            self.at.barrier = SimpleNamespace(**{key: self._column(f"barrier.{key}") for key in keys})
        self.joint = 3 * self.plan.cells
        self.board = SimpleNamespace(fixed=self.joint + (JOINT_ROWS if frame.safety == "joint" else 0), each=0)
        for part in structure.parts:
            self._add(part, lanes)
        self.courses: dict[str, dict[str, list[int]]] = {kind: {} for kind in self.agent_rows}
        for kind, noted in self.courses.items() if structure.terms else ():
            for term in terms.names(self, kind):
                first = self.agent_rows[kind]
                noted[term] = list(range(first, first + frame.dim))
                self.agent_rows[kind] += frame.dim
        self.commands: dict[str, list[int]] = {}
        for kind, mode in structure.commanded:
            first = self.agent_rows[kind]
            self.commands[kind] = list(range(first, first + (len(GAINS) if mode == "gains" else frame.dim)))
            self.agent_rows[kind] += len(self.commands[kind])
        self.filled_rows = self.agent_rows
        self.agent_rows = {kind: count | 1 for kind, count in self.filled_rows.items()}  # odd: see lanes.bounded

    def _agents(self, kind: str) -> SimpleNamespace:
        """Give the columns of a kind's own numbers."""
        frame = self.structure.frame
        names = [*_AGENT_NUMBERS, *(["ahead", "max_turn"] if kind in frame.unicycles else [])]
        names += ["min_speed"] if kind in frame.slow else []
        names += ["field_of_view"] if kind in frame.narrow else []
        names += ["nearest"] if kind in frame.choosy else []
        columns = {name: self._column(f"{kind}.{name}") for name in names}
        columns |= {"apart": self._column(f"{kind}.spawn.apart")} if kind in frame.apart else {}
        columns |= {"view": self._column(f"{kind}:view")} if kind in frame.narrow else {}  # of that field, its least cosine
        spawn = {name: self._box(f"{kind}.spawn.{name}") for name in ("region", "velocity")}
        period = {f"period_{'xyz'[k]}": self.at.size[k] for k in self.axes}
        return SimpleNamespace(**columns, **spawn, **period)

    def _column(self, path: str) -> int:
        self.paths.append(path)
        return len(self.paths) - 1

    def _vector(self, path: str) -> list[int]:
        return [self._column(f"{path}.{axis}") for axis in self.axes]

    def _box(self, path: str) -> SimpleNamespace:
        return SimpleNamespace(low=self._vector(f"{path}.0"), high=self._vector(f"{path}.1"))

    def _plan(self, across: int, up: int) -> SimpleNamespace:
        """Lay out the grid of planned ways, with a rim of one cell: next one, length of the way from there, wall."""
        if not across:
            return SimpleNamespace(cells=0)
        self.at.planning = SimpleNamespace(**{name: self._column(f"planning.{name}") for name in ("cell", "clearance")})
        cells = (across + 2) * (up + 2)
        return SimpleNamespace(across=across, up=up, cells=cells, next=0, length=cells, wall=2 * cells)

    def _add(self, part: Part, lanes: Any) -> None:
        strategy = part.strategy
        weights = _numbers_of(strategy)
        derived = list(strategy.derived({name: np.zeros(1) for name in weights}))
        names = ["on", *weights, *derived]
        memory = self._names(getattr(strategy, "memory", ()))
        notes = self._names(strategy.notes) or ["nothing"]
        row = self.agent_rows[part.kind]
        scratch = row + len(memory)
        self.agent_rows[part.kind] = scratch + (part.shape.scratch if part.shape else 0)
        board = SimpleNamespace(**vars(self.board))  # where its own rows begin
        if part.kind == "predators" and part.role == "strategy":
            fixed, each = strategy.board_rows(len(self.axes))
            self.board = SimpleNamespace(fixed=board.fixed + fixed, each=board.each + each)
        columns = [self._column(f"{part.kind}.{part.role}:{part.name}.{name}") for name in names]
        network = len(self.paths)
        self.paths += network_columns.paths_of(part.kind, part.name, part.shape)
        self._parts.append(
            SimpleNamespace(
                part=part,
                strategy=strategy,
                own=[hook for hook in vars(_base_of(strategy)) if _overrides(strategy, hook)],
                names=names,
                columns=columns,
                memory=memory,
                memory_rows=list(range(row, row + len(memory))),
                board=board,
                scratch=scratch,
                network=network,
                Weights=ti.types.struct(**dict.fromkeys(names, lanes)),
                Memory=ti.types.struct(**dict.fromkeys(memory or ["nothing"], lanes)),
                note_names=notes,
                Notes=ti.types.struct(**dict.fromkeys(notes, lanes)),
            )
        )

    def _names(self, names: Sequence[str]) -> list[str]:
        """List names, one an axis for "NAME*"."""
        spread = [[f"{name[:-1]}_{'xyz'[k]}" for k in self.axes] if name.endswith("*") else [name] for name in names]
        return [name for each in spread for name in each]

    def parts(self, kind: str, role: str, hook: str | None = None) -> list[SimpleNamespace]:
        """List the parts of a role, or those of them that have a hook of their own."""
        found = [each for each in self._parts if (each.part.kind, each.part.role) == (kind, role)]
        return found if hook is None else [each for each in found if hook in each.own]

    def flocks(self, kind: str) -> bool:
        """Tell whether separation, cohesion and alignment act on agents of a kind in any trial."""
        return all(p.strategy.flocks or p.part.mixed for p in self.parts(kind, "strategy"))

    def shown(self, kind: str) -> dict[str, int]:
        """Map what agents see of each other's memory to its row."""
        return {
            name: row
            for each in self.parts(kind, "strategy")
            for name, row in zip(each.memory, each.memory_rows, strict=True)
            if name in self._names(getattr(each.strategy, "shown", ()))
        }

    def table(
        self,
        scenarios: Sequence[Scenario],
        weights: Mapping[str, np.ndarray] | None = None,
        networks: Mapping[str, np.ndarray] | None = None,
    ) -> np.ndarray:
        """Lay the numbers of scenarios out, one row each: [row, column], float64.

        weights: path -> [row], numbers that differ from row to row; then one scenario gives as many rows. networks: prey or
        predators -> [row, weight], networks that differ so.
        """
        every = [scenario.numbers() for scenario in scenarios]
        differing = [*(weights or {}).values(), *(networks or {}).values()]
        rows = len(differing[0]) if differing else len(every)

        def numbers(path: str) -> np.ndarray:
            if weights and path in weights:
                return np.asarray(weights[path], np.float64)
            values = np.array([each.get(path, 0.0) for each in every])
            return values if len(values) == rows else np.repeat(values, rows)

        columns = {path: numbers(path) for path in self.paths if ":" not in path}
        for kind in self.structure.frame.narrow:
            columns[f"{kind}:view"] = least_cosine(numbers(f"{kind}.field_of_view"))
        for each in self._parts:
            part = each.part
            own = {name: numbers(f"{part.kind}.weights.{name}") for name in _numbers_of(each.strategy)}
            names = [getattr(getattr(scenario, part.kind), part.role) for scenario in scenarios]
            on = np.array([float(part.name in registry.parts(part.catalogue, name)) for name in names])
            own |= {"on": np.resize(on, rows)} | each.strategy.derived(own)
            columns |= {f"{part.kind}.{part.role}:{part.name}.{name}": own[name] for name in each.names}
            if part.shape is not None:
                columns |= network_columns.columns_of(part.kind, part.name, part.shape, scenarios, networks)
        return np.stack([np.broadcast_to(columns[path], rows) for path in self.paths], axis=1)


def least_cosine(degrees: np.ndarray) -> np.ndarray:
    """Give the cosine of half a field of view, less than any for 360°, where rounding must hide nobody."""
    return np.where(degrees >= 360, -2.0, np.cos(np.radians(degrees) / 2))


def _numbers_of(strategy: Any) -> list[str]:
    """List the weights of a strategy but the name of its network's file."""
    return [field.name for field in fields(strategy.Weights) if field.type is not str]


def _base_of(strategy: type) -> type:
    """Give Prey, Predator or Avoidance, which list all hooks."""
    return [cls for cls in strategy.__mro__ if cls is not object][-1]


def _overrides(strategy: type, hook: str) -> bool:
    return getattr(strategy, hook) is not getattr(_base_of(strategy), hook)
