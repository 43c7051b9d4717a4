"""Faces: which font draws which letter, and text in the order in which it is seen.

Aileron, whose plain English Pillow carries within itself, draws most, and looks the same on every machine; those in fonts/ draw
what it lacks, and a box stands for what no face has.
"""

import re
import unicodedata
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).with_name("fonts")
FILES = ("", "Aileron.ttf", "DejaVuSans.ttf", "NotoSansCJK.otf")
"""Faces in the order in which they are asked; the first is Pillow's own."""

MISSING = "\u25a1"
"""An empty square, for a letter that no face has."""

_AILERON = frozenset([*map(chr, range(0x20, 0x7F)), *"·…°’“”"])
_SCALE = (1.0, 1.0, 0.94, 1.0)  # that capitals of all faces look equally high
_RIGHT_TO_LEFT = re.compile("[\u0590-\u08ff\ufb1d-\ufdff\ufe70-\ufeff]")
_ARABIC = re.compile("[\u0600-\u06ff]")


@cache
def font(face: int, size: int) -> Any:
    """Load a face of FILES at a size [px]."""
    from PIL import ImageFont

    if not FILES[face]:
        return ImageFont.load_default(size)
    # Letters come shaped and in their order: Pillow's own shaping would do both once more, where it is there at all.
    basic = ImageFont.Layout.BASIC
    return ImageFont.truetype(FOLDER / FILES[face], max(round(size * _SCALE[face]), 1), layout_engine=basic)


@cache
def _has(face: int, letter: str) -> bool:
    if face == 0:
        return letter in _AILERON
    drawn, nothing = (font(face, 24).getmask(each) for each in (letter, "\uffff"))
    return drawn.size != nothing.size or bytes(drawn) != bytes(nothing)


@lru_cache(4096)
def seen(text: str) -> str:
    """Give a line of text as it is seen, from left to right: joined where its script joins, right-to-left text turned round.

    Control characters become spaces.
    """
    text = "".join(" " if unicodedata.category(letter) in ("Cc", "Zl", "Zp") else letter for letter in text)
    if not _RIGHT_TO_LEFT.search(text):
        return unicodedata.normalize("NFC", text)
    from bidi import get_display

    if _ARABIC.search(text):
        from arabic_reshaper import ArabicReshaper

        text = ArabicReshaper({"delete_harakat": False}).reshape(text)
    return str(get_display(unicodedata.normalize("NFC", text)))


@lru_cache(4096)
def runs(line: str) -> tuple[tuple[int, str], ...]:
    """Split a line, as it is seen, into pieces of one face each: (face, letters). Marks that show nothing are left out."""
    found: list[tuple[int, str]] = []
    for letter in line:
        if unicodedata.category(letter) in ("Cf", "Mn") and not any(_has(face, letter) for face in range(len(FILES))):
            continue
        able = [face for face in range(len(FILES)) if _has(face, letter)]
        face, drawn = (able[0], letter) if able else (FILES.index("DejaVuSans.ttf"), MISSING)
        if found and found[-1][0] == face:
            found[-1] = face, found[-1][1] + drawn
        else:
            found.append((face, drawn))
    return tuple(found)


def advance(line: str, size: int) -> float:
    """Measure a line, as it is seen [px]."""
    return float(sum(font(face, size).getlength(letters) for face, letters in runs(line)))


SHORT = 4
"""Letters, with the hyphen, that stay together with what follows: numbers such as 13-16-2, and 3-D."""


def breakable(text: str) -> list[str]:
    """Split text where a line may end: behind spaces and long words' hyphens, and between letters of scripts without spaces.

    What joins again with nothing between it is the text with single spaces.
    """
    pieces: list[str] = []
    for word in re.findall(r"[^ \t\n]+", text):  # a no-break space holds what it joins
        for letter in word:
            wide = unicodedata.east_asian_width(letter) in "WF" and unicodedata.category(letter)[0] != "P"
            before = pieces[-1] if pieces else " "
            if before.endswith(" ") or wide or (before.endswith("-") and len(before) > SHORT):
                pieces.append(letter)
            else:
                pieces[-1] += letter
        pieces[-1] += " "
    if pieces:
        pieces[-1] = pieces[-1].rstrip()
    return pieces
