"""Say in one line what is wrong with a scenario: the key's path, the value, and what is allowed."""

from typing import Any, get_args

from pydantic import BaseModel, ValidationError

from tiswarm.system.words import did_you_mean, safe, shortened


class ScenarioError(ValueError):
    """A scenario that cannot be run; the message is one line that names the mend, and safe to print."""

    def __init__(self, message: str) -> None:
        super().__init__(safe(message))


def explained(error: ValidationError, model: type[BaseModel]) -> str:
    """Put the first complaint of pydantic into our words."""
    first = error.errors()[0]
    cause = first.get("ctx", {}).get("error")
    if isinstance(cause, ScenarioError):
        return str(cause)
    names = [{"low": "0", "high": "1"}.get(str(each), str(each)) for each in first["loc"]]
    if "weights" in names:  # what follows a weight's name says which type of number was tried
        names = names[: names.index("weights") + 2]
    path = ".".join(names) or "scenario"
    if first["type"] == "extra_forbidden":
        return f"{path}: unknown key; {did_you_mean(names[-1], _keys(model, names[:-1]))}"
    if first["type"] == "missing":
        return f"{path}: missing; it has no default"
    value = _short(first["input"])
    return f"{path}: {value} is not allowed; {_allowed(first)}"


def _allowed(complaint: Any) -> str:
    limits = complaint.get("ctx", {})
    match complaint["type"]:
        case "greater_than_equal":
            return f"use {limits['ge']:g} or more"
        case "less_than_equal":
            return f"use {limits['le']:g} or less"
        case "finite_number":
            return "use a finite number"
        case "float_type":
            return "use a number"
        case "int_type":
            return "use a whole number"
        case "string_type":
            return "use a text in quotes"
        case "literal_error":
            return f"use {limits['expected']}"
        case "value_error":
            return str(limits["error"])
        case "too_short" | "too_long":
            return "use two numbers, or three in a deep world" if "tuple" in complaint["msg"].lower() else complaint["msg"]
        case "dict_type" | "model_type" | "model_attributes_type":
            return "use a table"
        case _:
            return complaint["msg"][0].lower() + complaint["msg"][1:]


def _short(value: Any) -> str:
    return shortened(repr(value), 60)


def _keys(model: Any, path: list[str]) -> list[str]:
    """List the keys that a table of the scenario may have."""
    for name in path:
        field = getattr(model, "model_fields", {}).get(name)
        inner = get_args(field.annotation)[0] if field and get_args(field.annotation) else field and field.annotation
        model = model if name.isdecimal() else inner
    return [field.alias or name for name, field in getattr(model, "model_fields", {}).items()]
