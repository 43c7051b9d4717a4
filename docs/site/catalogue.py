"""Catalogue: the reference of strategies: what each does, where it comes from and its weights."""

import re
from dataclasses import fields
from typing import Any

from tiswarm.scenario.described import comments
from tiswarm.strategies import registry

INTRODUCTION = """# Strategies

What `prey.strategy`, `predators.strategy` and the `avoidance` of both may be, with the weights that `[prey.weights]` and
`[predators.weights]` may set. [Contributing](../contributing.md#add-a-strategy) tells how to write one; so does a
[tutorial](../tutorials/own_strategy.md).
"""

TITLES = {"prey": "Prey", "predators": "Predators", "avoidance": "Avoidance of obstacles"}


def page() -> str:
    """Write the page."""
    parts = [INTRODUCTION]
    for kind in registry.KINDS:
        parts.append(f"## {TITLES[kind]}\n")
        for name, line in registry.described(kind).items():
            parts.append(_entry(kind, name, line))
    return "\n".join(parts)


def _entry(kind: registry.Kind, name: str, line: str) -> str:
    strategy = registry.load(kind, name)
    made_of = registry.parts(kind, name)
    about = (strategy.__doc__ or "").strip()
    text = [f"### `{name}` {{ #{kind}-{name} }}\n", line.partition(": ")[2] or line, ""]
    if about:
        text += [re.sub(r"\n[ ]+", "\n", about), ""]
    if len(made_of) > 1:
        text += ["Made of " + ", ".join(f"[`{part}`](#{kind}-{part})" for part in made_of) + ".", ""]
    else:
        text += _weights(strategy)
    return "\n".join(text)


def _weights(strategy: Any) -> list[str]:
    rows = []
    told = comments(strategy.Weights)
    for field in fields(strategy.Weights):
        words = told.get(field.name, "")
        unit = re.search(r"\[([^\]]+)\]", words)
        meaning = re.sub(r" *\[[^\]]+\]", "", words)
        default = f"{field.default:g}" if isinstance(field.default, float) else str(field.default)
        rows.append(f"| `{field.name}` | {meaning} | {unit.group(1) if unit else ''} | `{default}` |")
    return ["| weight | what it is | unit | default |", "|---|---|---|---|", *rows, ""] if rows else []
