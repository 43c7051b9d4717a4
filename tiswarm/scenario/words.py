"""Words: what a scenario calls its agents, and titles that count them."""

import re
from collections.abc import Mapping
from typing import Any

from tiswarm.scenario.errors import ScenarioError
from tiswarm.scenario.parts import Part
from tiswarm.system.words import did_you_mean, grouped, plural, spelt

KINDS = ("prey", "predators", "obstacles")
"""What a title may count."""

_FIELD = re.compile(r"\{(\w+)(?:(\.\w*)|:([^{}|]*)\|([^{}|]*))?\}")
_CLAUSE = re.compile(r"\[((?:[^\[\]{}|]|\{[^{}]*\})*)(?:\|((?:[^\[\]{}|]|\{[^{}]*\})*))?\]")
_ESCAPED = {"{{": "\1", "}}": "\2", "[[": "\3", "]]": "\4"}
_ONE = "\0"  # stands for "a" or "an" until the word behind it is known


class Words(Part):
    """What films and pages call things: one of them, and several behind a stroke where that is irregular ("fish/fish")."""

    prey: str = "prey/prey"  # one of them, and several
    predators: str = "predator"  # as prey
    obstacles: str = "obstacle"  # as prey
    covered: str = "covered"  # what ground is where agents have been

    def noun(self, kind: str, count: int) -> str:
        """Give the word for so many agents or obstacles."""
        return plural(getattr(self, kind), count)


def titled(template: str, words: Words, counts: Mapping[str, int]) -> str:
    """Fill a title in. counts: how many there are of each of KINDS.

    "{prey.count}" is their number, spelt out where that is short, "{prey}" what they are called, "{prey:runs|run}" either word
    by whether they are one or more. "[...]" is left out when something that it counts is not there; "[...|...]" then says
    what is behind the stroke. "{{", "}}", "[[" and "]]" are single ones in such a title; one without a "{" is what it is.

    Errors: ScenarioError for an unknown field.
    """
    if "{" not in template:
        return template
    for twice, mark in _ESCAPED.items():
        template = template.replace(twice, mark)

    def clause(found: re.Match) -> str:
        there = all(counts.get(field[1], 1) for field in _FIELD.finditer(found[1]))
        return str(found[1]) if there else found[2] or ""

    def field(found: re.Match) -> str:
        kind, part, one, more = found.groups()
        if kind not in KINDS or part not in (None, ".count"):
            known = [form for name in KINDS for form in (f"{{{name}}}", f"{{{name}.count}}")]
            raise ScenarioError(f"title: unknown field '{found[0]}'; {did_you_mean(found[0], known)}")
        if one is not None:
            return str(one if counts[kind] == 1 else more)
        if part:
            return _ONE if counts[kind] == 1 else spelt(counts[kind])
        return words.noun(kind, counts[kind])

    line = _FIELD.sub(field, _CLAUSE.sub(clause, template))
    line = re.sub(f"{_ONE}( +[aeiou])", r"an\1", line, flags=re.IGNORECASE).replace(_ONE, "a")
    for twice, mark in _ESCAPED.items():
        line = line.replace(mark, twice[0])
    return line[:1].upper() + line[1:] if template[:1] in "{[" else line


def literal(title: str) -> str:
    """Write a title that comes from elsewhere, so that nothing in it is filled in."""
    return re.sub(r"([][{}])", r"\1\1", title) if "{" in title else title


def titled_table(table: Mapping[str, Any]) -> str:
    """Fill in the title of a preset's table whose other keys need not be checked, for lists of presets."""
    given = {kind: table.get(kind, {}).get("count", default) for kind, default in zip(KINDS, (6, 0, 0), strict=True)}
    return titled(str(table.get("title", "")), Words(**table.get("words", {})), given)


def named(changes: Mapping[str, Any]) -> list[str]:
    """Write which keys a scenario has other than its preset."""
    return [f"{path} = {_value(value)}" for path, value in changes.items()]


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return grouped(value)
    if isinstance(value, float):
        return f"{value:.4g}" if abs(value) < 10_000 else grouped(round(value))
    return str(value).replace("'", "")
