"""Language: what captions say and how they write numbers, from one small table a language (languages/)."""

import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any

from tiswarm.scenario import presets
from tiswarm.scenario.changes import changes
from tiswarm.scenario.errors import ScenarioError
from tiswarm.scenario.model import Scenario
from tiswarm.scenario.words import KINDS, named
from tiswarm.system.words import grouped, listed

FOLDER = Path(__file__).with_name("languages")
NAMES = tuple(sorted(file.stem for file in FOLDER.glob("*.toml")))
"""The languages that there are, by their codes of ISO 639-1."""

_COUNTED = re.compile(r"\{(\w+)\}")
_FROM_THE_RIGHT = "\N{RIGHT-TO-LEFT MARK}"


@dataclass(frozen=True)
class Language:
    """What captions say in a language. English writes numbers as the rest of tiswarm does, others as the Unicode CLDR says.

    code: of ISO 639-1. table: sections of phrases. A phrase is a text with {fields}, or one text for each of CLDR's plural
    categories that the language has ("one", "few", ...).
    """

    code: str
    table: Mapping[str, Mapping[str, Any]]

    def say(self, phrase: str, count: int | None = None, **fields: str) -> str:
        """Say a phrase, such as "lines.after". count: chooses the plural, and is the field {count}. fields: the others."""
        section, _, key = phrase.partition(".")
        found = self.table[section][key]
        if isinstance(found, Mapping):
            found = found.get(self._category(count or 0), found["other"])
        return str(found.format(count="" if count is None else self.whole(count), **fields))

    def word(self, section: str, name: str) -> str:
        """Say a word that scenarios may choose themselves: one that the table does not have stays as it is."""
        return str(self.table.get(section, {}).get(name, name))

    def noun(self, scenario: Scenario, kind: str, count: int) -> str:
        """Call one agent or obstacle, or several, without their number. kind: of KINDS."""
        forms = self._forms(scenario, kind)
        return str(forms["single" if count == 1 else "several"]) if forms else scenario.words.noun(kind, count)

    def counted(self, scenario: Scenario, kind: str, count: int) -> str:
        """Count agents or obstacles: "6 prey"."""
        forms = self._forms(scenario, kind)
        if not forms:
            return f"{self.whole(count)} {scenario.words.noun(kind, count)}"
        return str(forms.get(self._category(count), forms["other"]).format(count=self.whole(count)))

    def title(self, scenario: Scenario) -> str:
        """Give a scenario's title: in this language where the table has its preset's, and that is still true of it."""
        found = self.table.get("titles", {}).get(scenario.preset)
        if not found or not self._holds(found, scenario):
            return scenario.title
        return str(found.format(**{kind: self.counted(scenario, kind, getattr(scenario, kind).count) for kind in KINDS}))

    def changed(self, scenario: Scenario, most: int = 3) -> str:
        """Say which keys a scenario has other than its preset, in a line: the first few, and how many more."""
        found = named(changes(scenario))
        more = [self.say("lines.more", len(found) - most)] * (len(found) > most)
        return self.say("lines.with", changes=", ".join(found[:most] + more)) if found else ""

    def whole(self, number: int) -> str:
        """Write a whole number with its thousands apart."""
        return grouped(number) if self._locale is None else self._written(number, "#,##0")

    def decimal(self, value: float, digits: int) -> str:
        """Write a number with so many digits behind its point."""
        if self._locale is None:
            return f"{value:.{digits}f}".replace("-", "\N{MINUS SIGN}")
        return ("\N{MINUS SIGN}" if value < 0 else "") + self._written(abs(value), f"0.{'0' * digits}" if digits else "0")

    def short(self, value: float) -> str:
        """Write a round number with no more digits than it has."""
        plain = f"{value:g}"
        if self._locale is None or "e" in plain:
            return plain
        return self.decimal(float(plain), len(plain.partition(".")[2]))

    def listed(self, words: Sequence[str]) -> str:
        """Write words as a list: "1, 2 and 3"."""
        if self._locale is None:
            return listed(list(words))
        from babel.lists import format_list

        return str(format_list(list(words), locale=self._locale))

    def length(self, metres: float) -> str:
        """Write a round length with its unit."""
        unit, scale = ("km", 1e-3) if metres >= 1000 else ("m", 1) if metres >= 0.1 else ("cm", 100)
        return f"{self.short(metres * scale)} {self.unit(unit)}"

    def unit(self, name: str) -> str:
        """Write a unit."""
        return self.word("units", name)

    def clauses(self, sentences: Sequence[str]) -> str:
        """Join sentences without their full stops by semicolons, where their first words may be small."""
        first, *others = sentences
        if self.table["grammar"]["small"] == "yes":
            others = [each[:1].lower() + each[1:] for each in others]
        return self.table["grammar"]["semicolon"].join([first, *others])

    @property
    def rightward(self) -> bool:
        """Tell whether lines run from left to right."""
        return self.table["grammar"]["from"] == "left"

    def line(self, text: str) -> str:
        """Mark a line that runs from the right as such, whatever its first word is."""
        return text if self.rightward else _FROM_THE_RIGHT + text

    @cached_property
    def _locale(self) -> Any:
        if self.code == "en":
            return None
        from babel import Locale

        return Locale.parse(self.code)

    def _written(self, number: float, pattern: str) -> str:
        from babel.numbers import format_decimal

        # Digits are what they are everywhere in a film, so separators must be those that go with them.
        return str(format_decimal(number, format=pattern, locale=self._locale, numbering_system="latn"))

    def _category(self, count: int) -> str:
        if self._locale is None:
            return "one" if count == 1 else "other"
        return str(self._locale.plural_form(count))

    def _forms(self, scenario: Scenario, kind: str) -> Mapping[str, str] | None:
        return self.table.get("nouns", {}).get(getattr(scenario.words, kind).partition("/")[0])

    @staticmethod
    def _holds(title: str, scenario: Scenario) -> bool:
        """Tell whether a title is true: it names kinds that are there, and what it does not count is as in its preset."""
        try:
            base = presets.load(scenario.preset)
        except ScenarioError:
            return False
        named = set(_COUNTED.findall(title))
        same = all(getattr(scenario, kind).count == getattr(base, kind).count for kind in KINDS if kind not in named)
        there = all(getattr(scenario, kind).count > 0 for kind in named)
        return same and there and scenario.template == base.template and scenario.words == base.words


@cache
def language_named(code: str) -> Language:
    """Give a language by its code. Errors: ValueError."""
    if code not in NAMES:
        raise ValueError(f"language: unknown {code!r}; use one of {', '.join(NAMES)}")
    return Language(code, tomllib.loads((FOLDER / f"{code}.toml").read_text(encoding="utf-8")))
