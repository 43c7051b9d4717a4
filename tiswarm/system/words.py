"""Words: what is said to people in one line: which known word was meant."""

import difflib


def did_you_mean(word: str, known: list[str]) -> str:
    """Say which known word was probably meant."""
    close = difflib.get_close_matches(word, known, n=1, cutoff=0.5)
    return f"did you mean '{close[0]}'?" if close else f"known: {', '.join(known)}"
