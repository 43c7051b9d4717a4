"""Design: studies as their TOML files state them, and the cells they consist of."""

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import BeforeValidator, Field, ValidationError, model_validator

from tiswarm.scenario.errors import ScenarioError, explained
from tiswarm.scenario.measures import COUNTED, MEASURED
from tiswarm.scenario.model import Scenario
from tiswarm.scenario.parts import Part, Positive
from tiswarm.scenario.presets import MOST_TOML, load, preset_folder, read_toml, study_names
from tiswarm.studies.axes import NAME, Axis, Combine, Whole, label, points
from tiswarm.system.files import read_bounded
from tiswarm.system.words import did_you_mean

MEASURES = ("success", "time", "impact_spread")
"""What a study reports unless it says otherwise."""

SHARES = ("success",)
"""Measures that are shares of the agents of a trial."""

MOST_CELLS = 10_000

Figure = Literal["bars", "heat", "pairs", "scatter"]


class Published(Part):
    """Where the published means are, and how sure they are."""

    file: str  # CSV beside the study: table, row and one column for each of the study's measures
    trials: Whole
    spread: Positive = 1.0  # their standard error is spread · sd/√trials


class Design(Part):
    """A base scenario, what is changed in all cells, and the axes along which cells differ."""

    base: str = ""
    set: dict[str, Any] = Field(default_factory=dict)  # key of the scenario -> value, in every cell
    axes: tuple[Axis, ...] = ()
    combine: Combine = "grid"
    samples: Whole | None = None  # cells of a Latin hypercube

    @property
    def keys(self) -> tuple[str, ...]:
        """List the keys of the axes."""
        return tuple(key for axis in self.axes for key in axis.keys)

    @property
    def shown(self) -> tuple[str, ...]:
        """List the keys of the axes that tables show."""
        return tuple(key for axis in self.axes for key in axis.shown)


class Table(Design):
    """One table; `key` and `values` are short for a single axis."""

    name: str
    title: str

    @model_validator(mode="before")
    @classmethod
    def _from_one_key(cls, value: Any) -> Any:
        if not isinstance(value, Mapping) or "key" not in value or "axes" in value:
            return value
        rest = {key: each for key, each in value.items() if key not in ("key", "values")}
        return {**rest, "axes": [{key: value[key] for key in ("key", "values") if key in value}]}

    @model_validator(mode="after")
    def _check(self) -> Self:
        if not self.base or not self.axes:
            raise ValueError("a table needs a base, and key and values or axes")
        return self


class Correlate(Part):
    """A correlation over the cells of a study: x, an axis's key or a measure, against y, a measure."""

    x: str
    y: str


class Game(Part):
    """A study read as a zero-sum game: prey choose along some axes, predators along others."""

    prey: Annotated[tuple[str, ...], Field(min_length=1)]  # keys
    predators: Annotated[tuple[str, ...], Field(min_length=1)]
    payoff: str = "success"  # what prey want large and predators small


def _listed(value: Any) -> Any:
    return [value] if isinstance(value, Mapping) else value


class Study(Design):
    """A study as its TOML file states it: tables, or one design of its own."""

    title: str
    source: str = ""
    trials: Whole = 1000  # per cell
    seed: Annotated[int, Field(strict=True, ge=0)] = 0  # unless the command line has another
    independent: bool = False  # whether each cell draws from a seed of its own, instead of all meeting the same luck
    measures: Annotated[tuple[str, ...], Field(min_length=1)] = MEASURES
    shares: tuple[str, ...] = SHARES  # measures that are shares of the agents of a trial, whose interval is Wilson's
    figures: tuple[Figure, ...] | None = None
    published: Published | None = None
    correlate: Annotated[tuple[Correlate, ...], BeforeValidator(_listed)] = ()
    game: Game | None = None
    tables: Annotated[tuple[Table, ...], Field(min_length=1)] | None = None

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.tables is None and not (self.base and self.axes):
            raise ValueError("a study needs [[tables]], or a base and [[axes]]")
        if self.tables is not None and (self.base or self.axes or self.samples or self.combine != "grid"):
            raise ValueError("base, axes, combine and samples stand in each of [[tables]], or tables are left out")
        if self.tables is not None and len({table.name for table in self.tables}) < len(self.tables):
            raise ValueError("tables: give each a name of its own")
        if len(set(self.measures)) < len(self.measures):
            raise ValueError("measures: name each once")
        return self

    def all_tables(self, name: str) -> tuple[Table, ...]:
        """List the tables; a design of the study's own is one, with the study's name and title."""
        if self.tables is not None:
            return self.tables
        own = {key: getattr(self, key) for key in ("base", "axes", "combine", "samples")}
        return (Table(name=name, title=self.title, **own),)


@dataclass(frozen=True)
class Cell:
    """One scenario of a study, and the seed that all its trials share.

    point: key of the scenario -> its value, for each key of the table's axes that the cell sets.
    """

    number: int
    table: Table
    point: dict[str, Any]
    scenario: Scenario
    seed: int

    @property
    def row(self) -> str:
        """Name the cell within its table."""
        return "/".join(label(self.point[key]) for key in self.table.shown if key in self.point)


def find_study(name: str) -> Path:
    """Find a study's file by name or path. Errors: ScenarioError."""
    if name.endswith(".toml"):
        return Path(name)
    if name not in study_names():
        raise ScenarioError(f"study: unknown '{name}'; {did_you_mean(name, study_names())}")
    return preset_folder() / "studies" / f"{name}.toml"


def load_study(name: str) -> Study:
    """Load a study. Errors: ScenarioError."""
    try:
        return Study.model_validate(read_toml(find_study(name)))
    except ValidationError as error:
        raise ScenarioError(explained(error, Study)) from None


def cells(name: str, study: Study, seed: int, overrides: Mapping[str, Any] | None = None) -> list[Cell]:
    """List a study's cells in their order.

    overrides: key of the scenario -> value, in every cell, after the study's own `set`.

    Errors: ScenarioError for a cell that is no scenario, or for keys that no axis has.
    """
    found: list[Cell] = []
    bases: dict[str, Scenario] = {}
    for table in study.all_tables(Path(name).stem):
        for point in points(table.axes, table.combine, table.samples):
            if len(found) == MOST_CELLS:
                raise ScenarioError(f"axes: more than {MOST_CELLS:,} cells; use fewer values or a Latin hypercube")
            settings = {**study.set, **table.set, **(overrides or {}), **point}
            settings.pop(NAME, None)
            base = str(settings.pop("base", table.base))
            if base not in bases:
                bases[base] = load(str(find_study(name).parent / base) if base.endswith(".toml") else base)
            scenario = _measuring(bases[base].replaced(settings), study.measures)
            own = _seed_of(seed, len(found)) if study.independent else seed
            found.append(Cell(len(found), table, point, scenario, own))
    _check_keys(study, found)
    return found


def _measuring(scenario: Scenario, names: tuple[str, ...]) -> Scenario:
    """Let a scenario measure what the study reports and it would not. Errors: ScenarioError for an unknown measure."""
    for name in names:
        if name not in COUNTED and name not in MEASURED:
            raise ScenarioError(f"measures: unknown '{name}'; {did_you_mean(name, [*COUNTED, *MEASURED])}")
    new = [name for name in names if name in MEASURED and name not in scenario.measures.names]
    return scenario.replaced({"measures.names": [*scenario.measures.names, *new]}) if new else scenario


def _seed_of(seed: int, number: int) -> int:
    """Draw the seed of a cell that shares no luck with others."""
    return int(np.random.SeedSequence([seed, number]).generate_state(1, np.uint64)[0])


def _check_keys(study: Study, found: list[Cell]) -> None:
    keys = sorted({key for cell in found for key in cell.point})
    for pair in study.correlate:
        if pair.x not in keys and pair.x not in study.measures:
            raise ScenarioError(
                f"correlate.x: '{pair.x}' is no axis and no measure; {did_you_mean(pair.x, [*keys, *study.measures])}"
            )
        if pair.y not in study.measures:
            raise ScenarioError(
                f"correlate.y: '{pair.y}' is no measure of the study; {did_you_mean(pair.y, list(study.measures))}"
            )
    if study.game is not None:
        sides = (*study.game.prey, *study.game.predators)
        if sorted(sides) != keys or study.tables is not None:
            raise ScenarioError(f"game: its keys must be those of the study's own axes, each on one side; they are {keys}")
        if study.game.payoff not in study.measures:
            raise ScenarioError(
                f"game.payoff: '{study.game.payoff}' is no measure; {did_you_mean(study.game.payoff, list(study.measures))}"
            )


def published_means(study: Study, folder: Path, found: list[Cell]) -> dict[tuple[str, str], dict[str, float]]:
    """Read the published means: (table, row) -> measure -> mean. Errors: ScenarioError for a file that does not fit."""
    if study.published is None:
        return {}
    path = folder / study.published.file
    try:
        lines = list(csv.DictReader(read_bounded(path, MOST_TOML).decode("utf-8-sig").splitlines()))
        means = {(line["table"], line["row"]): {measure: float(line[measure]) for measure in study.measures} for line in lines}
    except (OSError, KeyError, TypeError, ValueError) as error:
        needed = ", ".join(study.measures)
        raise ScenarioError(f"published.file: {path} cannot be used ({error}); it needs table, row, {needed}") from None
    known = {(cell.table.name, cell.row) for cell in found}
    for place in means:
        if place not in known:
            raise ScenarioError(f"published.file: {path} has a row {'/'.join(place)} that the study does not have")
    return means
