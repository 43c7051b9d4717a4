"""Keys: the reference of a preset's keys, from the schema: what each is, its unit, what it may be and its default."""

import re
from typing import Any

from tiswarm.scenario.model import Scenario

INTRODUCTION = """# Preset keys

A preset is a TOML file of these tables; what it leaves out has the default. `--set KEY=VALUE` changes one on the command line,
`tiswarm.load(preset, {"KEY": value})` in Python, and a study's axes are keys, too. `tiswarm show --schema` prints all this as a
JSON Schema, which editors understand; `tiswarm show PRESET` prints a preset with everything filled in. Weights are the numbers
of a strategy: [Strategies](strategies.md).

Lengths are metres, times seconds; places and regions have two numbers an axis, three in space.
"""

UNIT = re.compile(r"^(m/s|rad/s|m|s)(?:[,;] |$)|\[([^\]]+)\]")


def page() -> str:
    """Write the page."""
    schema = Scenario.model_json_schema()
    tables = schema["$defs"]
    parts = [INTRODUCTION, "## The preset itself\n", _table(schema["properties"], tables, "", tables_too=False)]
    for name, about in schema["properties"].items():
        part = _referred(about)
        if part:
            parts += [
                f"## `[{name}]` {{ #{name} }}\n",
                tables[part]["description"] + "\n",
                _table(tables[part]["properties"], tables, f"{name}."),
            ]
    return "\n".join(parts)


def _table(keys: dict[str, Any], tables: dict[str, Any], prefix: str, *, tables_too: bool = True) -> str:
    rows = ["| key | what it is | unit | may be | default |", "|---|---|---|---|---|"]
    for key, about in keys.items():
        part = _referred(about)
        inner = tables[part].get("properties") if part else None
        if inner and tables_too:  # a table in a table, such as spawn
            preset = about.get("default", {})
            rows += [_row(f"{prefix}{key}.{each}", {**of, **_given(preset, each)}, tables) for each, of in inner.items()]
        elif not inner and key != "preset":
            rows.append(_row(f"{prefix}{key}", about, tables))
    return "\n".join(rows) + "\n"


def _given(preset: dict[str, Any], key: str) -> dict[str, Any]:
    return {"default": preset[key]} if key in preset else {}


def _row(key: str, about: dict[str, Any], tables: dict[str, Any]) -> str:
    told = about.get("description", "")
    found = UNIT.search(told)
    unit = (found.group(1) or found.group(2)) if found else ""
    words = re.sub(r"  +", " ", UNIT.sub("", told)).strip(" ,;").replace(" ;", ";").replace(" .", ".")
    default = about.get("default", "")
    written = "–" if default in ("", None) else f"`{_toml(default)}`"
    return f"| `{key}` | {words} | {unit} | {_allowed(about, tables)} | {written} |"


def _referred(about: dict[str, Any]) -> str:
    return str(about.get("$ref", "")).rpartition("/")[2]


def _toml(value: Any) -> str:
    if isinstance(value, dict) and set(value) == {"low", "high"}:
        return _toml([value["low"], value["high"]])
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_toml, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:g}" if isinstance(value, float) else f'"{value}"' if isinstance(value, str) else str(value)


def _allowed(about: dict[str, Any], tables: dict[str, Any]) -> str:
    """Say what a key may be."""
    part = _referred(about)
    if part:
        return "two corners" if part == "Box" else f"tables of {', '.join(f'`{key}`' for key in tables[part]['properties'])}"
    if "enum" in about:
        return ", ".join(f"`{each}`" for each in about["enum"])
    kind = about.get("type")
    if kind == "array":
        return _list(about, tables)
    if kind in ("number", "integer"):
        low, high = about.get("minimum"), about.get("maximum")
        whole = "a whole number" if kind == "integer" else "a number"
        return f"{whole}{_range(low, high)}"
    return {"boolean": "`true`, `false`", "string": "text", "object": "a table"}.get(str(kind), "")


def _list(about: dict[str, Any], tables: dict[str, Any]) -> str:
    if "items" in about:
        of = about["items"]
        least, most = about.get("minItems"), about.get("maxItems")
        many = f"{least} or {most} times " if least else "any of " if "enum" in of else "a list of "
        return many + _allowed(of, tables)
    each = about["prefixItems"]
    return f"{len(each)} times {_allowed(each[0], tables)}"


def _range(low: float | None, high: float | None) -> str:
    if low is None and high is None:
        return ""
    if high is None or high >= 1e6:
        return "" if low is None or low <= -1e6 else " above 0" if 0 < low <= 1e-6 else f", {low:g} or more"
    return f", {low:g} to {high:g}"
