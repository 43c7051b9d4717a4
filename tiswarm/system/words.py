"""Words: what is said to people in one line: safe to print, short, with the mend."""

import difflib
import errno
import os
import re

LONGEST_WORD = 240
LONGEST_LINE = 1200
"""Characters of one word and of one line that are shown whole."""

MENDS = {
    errno.ENOSPC: "make room, or write to another disc",
    errno.EDQUOT: "make room, or write to another disc",
    errno.EFBIG: "files may not grow that large here; write elsewhere, or raise the limit (ulimit -f)",
    errno.EACCES: "choose a place that you may use, or change its permissions",
    errno.EPERM: "choose a place that you may use, or change its permissions",
    errno.EROFS: "choose a place that can be written to",
    errno.ENOENT: "check the name",
    errno.ENOTDIR: "name a folder",
    errno.EISDIR: "name a file",
    errno.EEXIST: "choose another name",
    errno.ENOTEMPTY: "choose another name",
    errno.ENAMETOOLONG: "choose a shorter name",
    errno.ELOOP: "its symbolic links go in a circle; choose another name",
    errno.EMFILE: "too many files are open; raise the limit (ulimit -n)",
    errno.ENFILE: "too many files are open; close other programs",
    errno.ENOMEM: "run fewer trials or agents at once",
    errno.EAGAIN: "the system has no threads or processes left; use fewer --threads, or raise the limit (ulimit -u)",
    errno.EIO: "the disc or the network failed; try again, or write elsewhere",
}
"""What helps against an error of the system."""


def did_you_mean(word: str, known: list[str]) -> str:
    """Say which known word was probably meant."""
    close = difflib.get_close_matches(word[:LONGEST_WORD], known, n=1, cutoff=0.5)
    return f"did you mean '{close[0]}'?" if close else f"known: {', '.join(known)}"


def safe(text: str) -> str:
    """Give a text as one line that may be printed, whatever was typed into it.

    Space becomes single; control characters, escape sequences and what turns the direction of writing are shown as escapes;
    long words, such as a name of a thousand characters, and long lines lose their middle.
    """
    line = " ".join(shortened(word, LONGEST_WORD) for word in text.split(" ") if word)
    line = "".join(each if each.isprintable() else _escaped(each) for each in line)
    return shortened(line, LONGEST_LINE)


def shortened(text: str, most: int) -> str:
    """Cut the middle out of a text of more than `most` characters."""
    return text if len(text) <= most else f"{text[: 2 * most // 3]}…{text[-(most // 3) + 1 :]}"


def fault(error: OSError, name: str = "") -> str:
    """Say what an error of the system is about, what happened, and the mend; name: where it names no file."""
    told = error.filename if error.filename is not None else name
    place = os.fsdecode(told) if isinstance(told, str | bytes | os.PathLike) else str(told)
    return (f"{place}: " if place else "") + reason(error)


def reason(error: OSError) -> str:
    """Say what happened in an error of the system, and the mend."""
    happened = error.strerror or str(error) or type(error).__name__
    mend = "" if ";" in happened else MENDS.get(error.errno or 0, "")
    return happened[0].lower() + happened[1:] + (f"; {mend}" if mend else "")


SMALL = (
    *("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve", "thirteen"),
    *("fourteen", "fifteen", "sixteen", "seventeen", "eighteen", "nineteen"),
)
TENS = ("twenty", "thirty", "forty", "fifty", "sixty", "seventy", "eighty", "ninety")


def spelt(number: int) -> str:
    """Write a number in words where these are few, such as "fifty thousand", else in figures."""
    for size, name in ((1_000_000, "million"), (1000, "thousand"), (100, "hundred")):
        if number >= size:
            many, rest = divmod(number, size)
            if rest or many >= 1000:
                return grouped(number)
            return f"a {name}" if many == 1 else f"{spelt(many)} {name}"
    if number < len(SMALL):
        return SMALL[number]
    tens, ones = divmod(number, 10)
    return TENS[tens - 2] + (f"-{SMALL[ones]}" if ones else "")


def grouped(number: int) -> str:
    """Write a number with its thousands apart."""
    return f"{number:,}".replace(",", "\u00a0")


def plural(noun: str, count: int) -> str:
    """Give the English noun for so many; noun: of one, and of several behind a stroke where it is irregular ("fish/fish")."""
    one, stroke, more = noun.partition("/")
    if count == 1:
        return one
    if stroke:
        return more
    if re.search("(s|x|z|ch|sh)$", one):
        return one + "es"
    return one[:-1] + "ies" if re.search("[^aeiou]y$", one) else one + "s"


def _escaped(character: str) -> str:
    return " " if character in "\n\t" else character.encode("unicode_escape").decode("ascii")


def listed(words: list[str]) -> str:
    """Write words as a list: "1, 2 and 3"."""
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)
