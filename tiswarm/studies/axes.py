"""Axes: which values of a scenario's keys a study visits, as a full grid, side by side, or as a Latin hypercube."""

import itertools
import json
import math
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from tiswarm.scenario.errors import ScenarioError
from tiswarm.scenario.parts import Part, Real

Whole = Annotated[int, Field(strict=True, ge=1, le=1_000_000)]

Combine = Literal["grid", "zip", "latin"]

NAME = "name"
"""A key that no scenario has: what tables call the stop of an axis whose values are too many to read."""

DIGITS = 6
"""Significant digits of drawn values, so that a table's columns state exactly what was run."""


class Axis(Part):
    """One key and the values it takes, or several keys that change together; `base` is a key, too.

    For several keys each value is a list, one for each of them; it may end early, and the keys behind are then left alone (a
    strategy's own weight where another strategy is chosen). Or it is a table, key = value, of some of them. One of the keys may
    be `name`, what tables call the stop.

    Either `values`, or a range `low` to `high`: of `steps` even steps, both ends included, or drawn from by a Latin hypercube.
    """

    key: str | tuple[str, ...]
    values: tuple[Any, ...] | None = None
    low: Real | None = None
    high: Real | None = None
    steps: Whole | None = None
    scale: Literal["linear", "log"] = "linear"
    whole: bool = False  # round to whole numbers

    @model_validator(mode="after")
    def _check(self) -> Self:
        if not self.keys or len(set(self.keys)) < len(self.keys):
            raise ValueError("name each key of an axis once")
        if self.values is not None:
            if (self.low, self.high, self.steps) != (None, None, None):
                raise ValueError("an axis has values, or low and high; drop one of them")
            if not self.values:
                raise ValueError("values must not be empty")
            wrong = [value for value in self.values if len(self.keys) > 1 and not _fits(value, self.keys)]
            if wrong:
                count = len(self.keys)
                raise ValueError(
                    f"with {count} keys each value is a list of 1 to {count}, or a table of them, unlike {wrong[0]!r}"
                )
            names = [str(stop.get(NAME)) for stop in map(self._point, self.values)] if NAME in self.keys else []
            if len(set(names)) < len(names):
                raise ValueError("give each stop of an axis a name of its own")
        elif self.low is None or self.high is None or self.low > self.high:
            raise ValueError("an axis needs values = [...], or low and high with low <= high")
        elif self.scale == "log" and self.low <= 0:
            raise ValueError("a log scale needs low above 0")
        elif len(self.keys) > 1:
            raise ValueError("several keys need values = [[...], ...]; a range is for one key")
        return self

    @property
    def keys(self) -> tuple[str, ...]:
        """List the keys, one or several."""
        return (self.key,) if isinstance(self.key, str) else self.key

    @property
    def shown(self) -> tuple[str, ...]:
        """List the keys that tables show: the name alone where there is one."""
        return (NAME,) if NAME in self.keys else self.keys

    def stops(self) -> list[dict[str, Any]]:
        """List what the axis sets, stop by stop. Errors: ScenarioError for a range without steps, or too many whole ones."""
        if self.values is not None:
            return [self._point(value) for value in self.values]
        if self.steps is None:
            raise ScenarioError(f'axes: {self.keys[0]} has low and high but no steps; state steps, or combine = "latin"')
        values = [self.at(k / max(self.steps - 1, 1)) for k in range(self.steps)]
        if len(set(values)) < len(values):
            raise ScenarioError(f"axes: {self.keys[0]} has no {self.steps} different whole numbers; use fewer steps")
        return [self._point(value) for value in values]

    def at(self, share: float) -> Any:
        """Give the value at a share (0 to 1) of the way along the range, or of the list of values."""
        if self.values is not None:
            return self.values[min(int(share * len(self.values)), len(self.values) - 1)]
        assert self.low is not None
        assert self.high is not None
        low, high = (math.log(self.low), math.log(self.high)) if self.scale == "log" else (self.low, self.high)
        value = low + share * (high - low)
        value = math.exp(value) if self.scale == "log" else value
        return round(value) if self.whole else float(f"{value:.{DIGITS}g}")

    def _point(self, value: Any) -> dict[str, Any]:
        if len(self.keys) > 1 and isinstance(value, Mapping):
            return {key: value[key] for key in self.keys if key in value}
        return dict(zip(self.keys, value if len(self.keys) > 1 else (value,), strict=False))

    def drawn(self, share: float) -> dict[str, Any]:
        """Give what the axis sets at a share (0 to 1) of its way."""
        return self._point(self.at(share))


def _fits(value: Any, keys: Sequence[str]) -> bool:
    if isinstance(value, Mapping):
        return bool(value) and set(value) <= set(keys)
    return isinstance(value, Sequence) and not isinstance(value, str) and 1 <= len(value) <= len(keys)


def points(axes: Sequence[Axis], combine: Combine, samples: int | None) -> list[dict[str, Any]]:
    """List the points that axes span: key -> value, the last axis changing fastest.

    grid: every value with every other; zip: first with first, second with second; latin: `samples` draws that visit each of
    as many equal shares of each axis once (the design does not depend on the seed of the trials).

    Errors: ScenarioError for axes that cannot be combined so.
    """
    if combine == "latin":
        if samples is None:
            raise ScenarioError('samples: missing; combine = "latin" needs a number of samples')
        from scipy.stats import qmc

        shares = qmc.LatinHypercube(d=len(axes), rng=np.random.default_rng(0)).random(samples)
        return [_joined(axis.drawn(share) for axis, share in zip(axes, row, strict=True)) for row in shares.tolist()]
    if samples is not None:
        raise ScenarioError('samples: only for combine = "latin"; drop it')
    stops = [axis.stops() for axis in axes]
    if combine == "grid":
        return [_joined(each) for each in itertools.product(*stops)]
    if len({len(each) for each in stops}) > 1:
        lengths = ", ".join(f"{'/'.join(axis.keys)} {len(each)}" for axis, each in zip(axes, stops, strict=True))
        raise ScenarioError(f'axes: combine = "zip" needs axes of one length, not {lengths}')
    return [_joined(each) for each in zip(*stops, strict=True)]


def _joined(settings: Any) -> dict[str, Any]:
    return {key: value for each in settings for key, value in each.items()}


def label(value: Any) -> str:
    """Write an axis's value as tables show it."""
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        return json.dumps(value)
    return str(value)
