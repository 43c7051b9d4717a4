"""Keys: what a tuning may change, on which scale, written KEY=LOW:HIGH or KEY=A,B,C."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any, Literal, get_args

import numpy as np

from tiswarm.scenario.errors import ScenarioError
from tiswarm.scenario.model import Scenario
from tiswarm.scenario.network import Network
from tiswarm.system.words import did_you_mean

Scale = Literal["linear", "log", "whole"]

DIGITS = 6
"""Significant digits of a number that a tuning settles on: what is checked, validated and written is the same."""

SPREAD = 0.2
"""What one on the search's scale is for a weight of a network."""

MOST_ARMS = 64
"""Combinations of choices that race each other; each needs generations of its own."""

WHOLE = (".count", "world.ticks", "measures.after", "measures.window", "prey.nearest", "predators.nearest")
"""How paths of whole numbers end."""


@dataclass(frozen=True)
class Range:
    """A number between two ends.

    whole: only whole numbers; log: each factor of two counts alike.
    """

    path: str
    low: float
    high: float
    scale: Scale = "linear"

    def __post_init__(self) -> None:
        """Check the ends. Errors: ScenarioError."""
        told = f"{self.path}={self.low:g}:{self.high:g}"
        if not (np.isfinite(self.low) and np.isfinite(self.high)):
            raise ScenarioError(f"{self.path}: the range holds a number that is not finite; use two finite ends")
        if not self.low < self.high:
            raise ScenarioError(f"{told}: the range must run from a lower to a higher number")
        if self.scale == "log" and self.low <= 0:
            raise ScenarioError(f"{told}: a log scale needs ends above 0")
        if self.scale == "whole" and (self.low != round(self.low) or self.high != round(self.high)):
            raise ScenarioError(f"{told}: whole numbers need whole ends")

    @property
    def step(self) -> float:
        """Give the way from one whole number to the next on the unit scale; 0 for real numbers."""
        return 1.0 / (self.high - self.low) if self.scale == "whole" else 0.0

    def value(self, unit: np.ndarray) -> np.ndarray:
        """Map places on the unit scale, 0 to 1, to numbers."""
        if self.scale == "log":
            return np.clip(self.low * (self.high / self.low) ** unit, self.low, self.high)
        plain = self.low + (self.high - self.low) * unit
        return np.clip(np.round(plain) if self.scale == "whole" else plain, self.low, self.high)

    def unit(self, value: float) -> float:
        """Map a number to its place on the unit scale, the nearer end for one outside."""
        held = min(max(value, self.low), self.high)
        if self.scale == "log":
            return float(np.log(held / self.low) / np.log(self.high / self.low))
        return (held - self.low) / (self.high - self.low)


@dataclass(frozen=True)
class Choice:
    """One of several words or values, found by a race."""

    path: str
    options: tuple[Any, ...]


def read(text: str) -> tuple[str, Any]:
    """Read KEY=LOW:HIGH, KEY=LOW:HIGH:log, KEY=LOW:HIGH:whole or KEY=A,B,C into what `tune` takes. Errors: ScenarioError."""
    path, equals, value = (each.strip() for each in text.partition("="))
    if not equals or not path or not value:
        raise ScenarioError(f"--over {text}: write KEY=LOW:HIGH, or KEY=A,B for a choice; as in prey.weights.evade=0:0.1")
    if ":" not in value:
        return path, [_plain(word.strip()) for word in value.split(",")]
    low, high, *scale = (word.strip() for word in value.split(":"))
    try:
        return path, (float(low), float(high), *scale)
    except ValueError:
        raise ScenarioError(f"--over {text}: {low!r} to {high!r} is no range of numbers; write KEY=LOW:HIGH") from None


def _plain(word: str) -> Any:
    import tomllib

    try:
        return tomllib.loads(f"value = {word}")["value"]
    except tomllib.TOMLDecodeError:
        return word


def split(over: Mapping[str, Any]) -> tuple[list[Range], list[Choice]]:
    """Sort what may change into ranges, (low, high[, scale]), and choices, lists. Errors: ScenarioError."""
    ranges, choices = [], []
    for path, given in over.items():
        if isinstance(given, list):
            if len({str(each) for each in given}) < 2 or len({str(each) for each in given}) < len(given):
                raise ScenarioError(f"{path}: {given} is no choice; name two different values or more, or a range LOW:HIGH")
            choices.append(Choice(path, tuple(given)))
            continue
        if not isinstance(given, tuple) or len(given) not in (2, 3) or not all(_is_real(end) for end in given[:2]):
            raise ScenarioError(f"{path}: {given!r} is no range; use (low, high), (low, high, 'log'), or a list of choices")
        scale: Any = given[2] if len(given) == 3 else "whole" if path.endswith(WHOLE) else "linear"
        if scale not in get_args(Scale):
            raise ScenarioError(f"{path}: unknown scale {scale!r}; {did_you_mean(str(scale), list(get_args(Scale)))}")
        if path.endswith(WHOLE) and scale != "whole":
            raise ScenarioError(f"{path}: holds whole numbers, which have no {scale} scale; leave the scale out")
        ranges.append(Range(path, float(given[0]), float(given[1]), scale))
    return ranges, choices


def _is_real(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


@dataclass(frozen=True)
class Arm:
    """One combination of choices, with the ranges that it knows, for one scenario or several.

    side: prey or predators, whose network is trained; empty for none. Its weights are coordinates behind those of the ranges.
    """

    chosen: tuple[tuple[str, Any], ...]
    scenarios: tuple[Scenario, ...]
    ranges: tuple[Range, ...]
    side: str = ""

    @property
    def name(self) -> str:
        """Say what was chosen."""
        return ", ".join(f"{path.rpartition('.')[2]} {value}" for path, value in self.chosen)

    @property
    def network(self) -> Network | None:
        """Give the network that training starts from."""
        return self.scenarios[0].network(self.side) if self.side else None

    @property
    def start(self) -> np.ndarray:
        """Give where the search begins: the numbers of the first scenario on the unit scale, and zero for each weight."""
        numbers = self.scenarios[0].numbers()
        places = [each.unit(numbers[each.path]) for each in self.ranges]
        return np.array([*places, *([0.0] * (self.network.shape.size if self.network else 0))], np.float64)

    def values(self, unit: np.ndarray) -> np.ndarray:
        """Map places of the search to numbers and weights: [candidate, coordinate] both."""
        columns = [each.value(unit[:, k]) for k, each in enumerate(self.ranges)]
        numbers = np.stack(columns, axis=1) if columns else np.zeros((len(unit), 0))
        if self.network is None:
            return numbers
        return np.hstack([numbers, self.network.weights + SPREAD * unit[:, len(self.ranges) :]])

    def settled(self, unit: np.ndarray) -> np.ndarray:
        """Give the numbers of one place of the search, in as many digits as a preset has, and the weights: [coordinate]."""
        values = self.values(unit[None])[0]
        for k, each in enumerate(self.ranges):
            values[k] = min(max(float(f"{values[k]:.{DIGITS}g}"), each.low), each.high)
        return values

    def tuned(self, values: Sequence[float] | np.ndarray, network: str = "") -> tuple[Scenario, ...]:
        """Give the scenarios with these numbers: [coordinate]; network: the file that the weights were written to."""
        own: dict[str, Any] = {
            each.path: int(value) if each.scale == "whole" else float(value)
            for each, value in zip(self.ranges, values, strict=False)
        }
        if self.side:
            own[f"{self.side}.weights.network"] = network
        return tuple(scenario.replaced(own) if own else scenario for scenario in self.scenarios)


def arms(scenarios: Sequence[Scenario], over: Mapping[str, Any], side: str = "") -> list[Arm]:
    """List all combinations of choices; a range belongs to those arms that have its key; side: whose network is trained.

    Errors: ScenarioError for a key that no arm has, or that is no number.
    """
    ranges, choices = split(over)
    if not ranges and not choices and not side:
        raise ScenarioError("tune: nothing to change; name a key with --over KEY=LOW:HIGH")
    combinations = list(product(*(each.options for each in choices)))
    if len(combinations) > MOST_ARMS:
        raise ScenarioError(f"tune: {len(combinations)} combinations of choices; use {MOST_ARMS} at most")
    found = []
    used: set[str] = set()
    for options in combinations:
        chosen = tuple(zip((each.path for each in choices), options, strict=True))
        here = tuple(scenario.replaced(dict(chosen)) if chosen else scenario for scenario in scenarios)
        own = tuple(each for each in ranges if all(each.path in scenario.numbers() for scenario in here))
        used |= {each.path for each in own}
        _check_networks(here, side)
        found.append(Arm(chosen, here, own, side))
    for each in ranges:
        if each.path not in used:
            raise ScenarioError(f"--over {each.path}: {_told(scenarios, each.path)}")
    return found


def _check_networks(scenarios: Sequence[Scenario], side: str) -> None:
    """Raise ScenarioError where the network that is to be trained is not there, or not the same in all scenarios."""
    if side not in ("", "prey", "predators"):
        raise ScenarioError(f"network: {side!r} have none; use prey or predators")
    found = [each.network(side) for each in scenarios] if side else []
    if any(each is None for each in found):
        raise ScenarioError(f"network: the {side} are led by none; add --set {side}.strategy=neural")
    if len({each.digest for each in found if each is not None}) > 1:
        raise ScenarioError(f"network: scenarios begin with different networks of the {side}; begin with one")


def _told(scenarios: Sequence[Scenario], path: str) -> str:
    """Say why a path cannot be changed."""
    for scenario in scenarios:
        numbers = scenario.numbers()
        if path not in numbers:
            place: Any = json_of(scenario)
            for key in path.split("."):
                place = place.get(key) if isinstance(place, dict) else None
            if place is not None:
                return f"is no number but {place!r}; give a list of choices, KEY=A,B"
            return f"unknown key of {scenario.preset or scenario.title}; {did_you_mean(path, list(numbers))}"
    return "is known to no combination of the choices"


def json_of(scenario: Scenario) -> dict[str, Any]:
    """Give a scenario as plain tables."""
    import json

    plain: dict[str, Any] = json.loads(scenario.to_json())
    return plain
