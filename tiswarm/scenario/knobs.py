"""Knobs: the numbers and choices of a scenario that somebody may turn while it runs, each with its range, unit and words."""

from dataclasses import dataclass
from math import floor, log10
from typing import Any, Literal

from tiswarm.scenario.model import Scenario
from tiswarm.scenario.parts import LIMIT, MOST_AGENTS
from tiswarm.strategies import registry
from tiswarm.strategies.declared import Declared, declared

TURNED = ("cohesion", "separation", "alignment", "goal", "perception", "spacing", "max_speed", "radius")
"""Numbers that prey and predators have beside the weights of their strategies, in the order in which they are shown."""

WORDS = {
    "perception": "how far agents see",
    "max_speed": "speed limit",
    "radius": "size of an agent's body",
    "prey.count": "how many; a new trial begins",
    "predators.count": "how many; a new trial begins",
    "obstacles.count": "how many; a new trial begins",
    "target.position.0": "where the target is, to the east",
    "target.position.1": "where the target is, to the north",
}
"""What the declaration does not say in words."""

SPAN = 4
"""A slider goes from nothing to so many times the number that the preset states."""

STEPS = 200
"""About so many steps lie between its ends."""

Kind = Literal["number", "choice"]


@dataclass(frozen=True)
class Knob:
    """One number or choice.

    path: its key; group: "prey", "predators" or "world"; owner: the strategy or avoidance that declares it, or nothing.
    low, high, step: of a slider; the number itself may go beyond, from `least` to `most`. names: what may be chosen -> words.
    anew: whether another value begins a new trial; builds: whether it is another structure, whose kernel is compiled.
    """

    path: str
    group: str
    owner: str
    name: str
    value: float | str
    words: str = ""
    unit: str = ""
    low: float = 0.0
    high: float = 0.0
    step: float = 0.0
    least: float = -LIMIT
    most: float = LIMIT
    names: dict[str, str] | None = None
    anew: bool = False
    builds: bool = False

    def checked(self, value: Any) -> Any:
        """Give what the knob is turned to, as scenarios have it. Errors: ValueError."""
        if self.names is not None:
            if value not in self.names:
                raise ValueError(f"{self.path}: {str(value)[:80]!r} is unknown; use one of {', '.join(self.names)}")
            return value
        if not self.least <= number(value) <= self.most:
            raise ValueError(f"{self.path}: {value:g} is not possible; use {self.least:g} to {self.most:g}")
        return whole(value) if isinstance(self.value, int) else number(value)


def number(value: Any) -> float:
    """Check a finite number that somebody gave. Errors: ValueError."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < float("inf"):
        raise ValueError(f"{str(value)[:80]!r} is no number")
    return float(value)


def whole(value: Any) -> int:
    """Check a whole number that somebody gave. Errors: ValueError."""
    if number(value) != int(value):
        raise ValueError(f"{value} is no whole number")
    return int(value)


def knobs(scenario: Scenario, reference: Scenario) -> list[Knob]:
    """List what may be turned. reference: the scenario as it was loaded, whose numbers the ranges come from."""
    found = _counts(scenario, reference)
    if scenario.target.present:
        found += [_place(scenario, axis) for axis in (0, 1)]
    for side in ("prey", "predators"):
        if getattr(scenario, side).count:
            found += [*_menus(scenario, side), *_weights(scenario, reference, side), *_shared(scenario, reference, side)]
    return found


def _counts(scenario: Scenario, reference: Scenario) -> list[Knob]:
    """Give how many there are of each kind."""
    found = []
    for kind in ("prey", "predators", "obstacles"):
        path, before = f"{kind}.count", getattr(reference, kind).count
        value, least = getattr(scenario, kind).count, 1 if kind == "prey" else 0
        high = max(min(SPAN * before, before + 50_000), 10, value)
        found.append(
            Knob(
                *(path, "world", "", kind, value, WORDS[path], ""),
                *(least, high, max(1, round(high / STEPS)), least, MOST_AGENTS),
                anew=True,
            )
        )
    return found


def _place(scenario: Scenario, axis: int) -> Knob:
    """Give one coordinate of the target."""
    path, value, side = f"target.position.{axis}", scenario.target.position[axis], scenario.world.size[axis]
    words, step = WORDS[path], _round(side / STEPS)
    low, high, planned = min(0.0, value), max(side, value), scenario.prey.goal_by == "path"
    return Knob(path, "world", "", f"target {'xy'[axis]}", value, words, "m", low, high, step, anew=planned)


def _menus(scenario: Scenario, side: registry.Side) -> list[Knob]:
    """Give the strategies and avoidances that there are for such a world."""
    found = []
    for role, kind in registry.catalogues(side):
        chosen, words = getattr(getattr(scenario, side), role), registry.described(kind)
        fit = {
            name: words[name]
            for name in registry.names(kind)
            if name == chosen or scenario.world.dim in registry.dimensions(kind, name)
        }
        found.append(Knob(f"{side}.{role}", side, "", role, chosen, names=fit, anew=True, builds=True))
    return found


def _weights(scenario: Scenario, reference: Scenario, side: registry.Side) -> list[Knob]:
    """Give the weights of a side's strategy and avoidance; a network's file is none."""
    agents, before = getattr(scenario, side), getattr(reference, side).weights
    found = []
    for role, kind in registry.catalogues(side):
        for part in registry.parts(kind, getattr(agents, role)):
            said = declared(registry.load(kind, part).Weights)
            choices = registry.choices(kind, part)
            for name, default in registry.defaults(kind, part).items():
                path, told = f"{side}.weights.{name}", said.get(name, Declared())
                if name in choices:
                    names = dict.fromkeys(choices[name], "")
                    found.append(Knob(path, side, part, name, agents.weights[name], told.words, names=names))
                elif not isinstance(default, str):
                    stated = before.get(name, default)
                    found.append(_slider(path, side, part, name, agents.weights[name], stated or default, told))
    return found


def _shared(scenario: Scenario, reference: Scenario, side: registry.Side) -> list[Knob]:
    """Give the numbers that agents of all strategies have."""
    agents, before = getattr(scenario, side), getattr(reference, side)
    said, found = declared(type(agents)), []
    for name in TURNED:
        told = said.get(name, Declared())
        if not told.words:
            told = Declared(WORDS[name], told.unit)
        bounds = [each.ge for each in type(agents).model_fields[name].metadata if hasattr(each, "ge")]
        least = max([-LIMIT, *bounds])
        found.append(_slider(f"{side}.{name}", side, "", name, getattr(agents, name), getattr(before, name), told, least))
    return found


def _slider(
    path: str, side: str, owner: str, name: str, value: Any, stated: float, told: Declared, least: float = -LIMIT
) -> Knob:
    """Give a slider from nothing to several times what is stated, to 1 where that is nothing; the value lies within."""
    end = SPAN * stated if stated else 1.0
    low, high = min(0.0, end, value), max(0.0, end, value)
    step = _round((high - low) / STEPS)
    return Knob(
        path, side, owner, name, value, told.words, told.unit, low if low > least else step * (least > 0), high, step, least
    )


def _round(step: float) -> float:
    """Give the next smaller of 1, 2 and 5 times a power of ten."""
    power = 10.0 ** floor(log10(step))
    return float(f"{next(each for each in (5, 2, 1) if each * power <= step * (1 + 1e-9)) * power:.3g}")
