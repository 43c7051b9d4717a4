"""Parts: what scenarios are built of: numbers within bounds, frozen tables, boxes; and all of it as a preset writes it."""

from collections.abc import Sequence
from typing import Annotated, Any, Literal, NoReturn, Self

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from tiswarm.scenario.described import description

MOST_AGENTS = 4_000_000

LIMIT = 1e6
"""Largest magnitude of any length, speed or weight: products of a few of them still fit into single precision."""

MOST_NEAREST = 30
"""Most mates of `nearest`: a kernel has a place for each."""

Real = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=-LIMIT, le=LIMIT)]
NotNegative = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=0, le=LIMIT)]
Positive = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=1e-6, le=LIMIT)]
Count = Annotated[int, Field(strict=True, ge=0, le=MOST_AGENTS)]
Point = Annotated[tuple[Real, ...], Field(min_length=2, max_length=3)]
Number = Annotated[Real, BeforeValidator(lambda value: float(value) if isinstance(value, bool) else value)]


def _nearest(value: Any) -> Any:
    if value == "all" or (type(value) is int and 1 <= value <= MOST_NEAREST):
        return value
    raise ValueError(f"use a whole number from 1 to {MOST_NEAREST}, or 'all'")


Nearest = Annotated[int | Literal["all"], BeforeValidator(_nearest)]
Degrees = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=1, le=360)]


class Weights(dict[str, float | str]):
    """A dictionary that never changes, so that a scenario is what it was when it was checked."""

    def _refuse(self, *_: Any, **__: Any) -> NoReturn:
        raise TypeError("weights are frozen; use scenario.replaced({'prey.weights.NAME': number})")

    __setitem__ = __delitem__ = update = setdefault = pop = popitem = clear = __ior__ = _refuse

    def __hash__(self) -> int:  # type: ignore[override]
        return hash(tuple(sorted(self.items())))

    def __reduce__(self) -> tuple[Any, ...]:
        return Weights, (dict(self),)


class Part(BaseModel):
    """A frozen part of a scenario that knows no keys but its own."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: Any, handler: Any) -> dict[str, Any]:
        """Let the schema say what each key is."""
        schema: dict[str, Any] = handler.resolve_ref_schema(handler(core_schema))
        for key, about in schema.get("properties", {}).items():
            told = description(cls, key)
            if told:
                about.setdefault("description", told)
        return schema


def _ordered(low: Sequence[float], high: Sequence[float], what: str) -> None:
    if any(a > b for a, b in zip(low, high, strict=False)):
        raise ValueError(f"{what} must run from a lower to an upper corner, [[x0, y0], [x1, y1]] with x0 <= x1 and y0 <= y1")
    if len(low) != len(high):
        raise ValueError(f"{what} has corners of {len(low)} and {len(high)} numbers")


class Box(Part):
    """An axis-parallel rectangle or cuboid, written as its two corners [[x0, y0], [x1, y1]]."""

    low: Point
    high: Point

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: Any, handler: Any) -> dict[str, Any]:
        corner = {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 3}
        return {"title": "Box", "description": cls.__doc__, "type": "array", "items": corner, "minItems": 2, "maxItems": 2}

    @model_validator(mode="before")
    @classmethod
    def _from_corners(cls, value: Any) -> Any:
        if isinstance(value, Sequence) and not isinstance(value, str):
            if len(value) != 2:
                raise ValueError("a region is two corners, [[x0, y0], [x1, y1]]")
            return {"low": value[0], "high": value[1]}
        return value

    @model_validator(mode="after")
    def _check(self) -> Self:
        _ordered(self.low, self.high, "a region")
        return self


def plain(value: Any) -> Any:
    """Turn parts into the lists and tables that a preset writes."""
    if isinstance(value, Box):
        return [list(value.low), list(value.high)]
    if isinstance(value, Part):
        return {field.alias or key: plain(getattr(value, key)) for key, field in type(value).model_fields.items()}
    if isinstance(value, Weights):
        return dict(value)
    if isinstance(value, tuple):
        return [plain(each) for each in value]
    return value


def is_number(path: str, value: Any) -> bool:
    """Tell whether a leaf is a number that a kernel may read."""
    return isinstance(value, int | float) and not isinstance(value, bool) and not path.startswith(("showcase.", "world.areas."))


def leaves(value: Any, path: str = "") -> list[tuple[str, Any]]:
    """List what a table holds: paths such as "world.size.0", and values."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else None
    if items is None:
        return [(path, value)]
    return [leaf for key, each in items for leaf in leaves(each, f"{path}.{key}" if path else str(key))]
