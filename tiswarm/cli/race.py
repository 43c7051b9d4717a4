"""Race: an arms race of 'tiswarm bench', told round by round and drawn."""

import importlib.util
import sys
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from tiswarm.cli.options import out
from tiswarm.learning.arms_race import SIDES, Race, Round
from tiswarm.learning.race_rules import Rules

SHOWN = 0.005
"""Shares of a mixture below this are not worth a line."""


def run(rules: Rules, folder: Path, seed: int | None, trials: int | None, fresh: bool, quiet: bool) -> None:
    """Run a race into a folder, and print its rounds as they end."""
    from tiswarm.system.owner import locked
    from tiswarm.system.progress import begin_work

    race = Race(rules, folder, seed, trials)
    begin_work()

    def finished(made: Round) -> None:
        if not quiet:
            sys.stderr.write(f"round {made.number}: value {made.solution.value:.4f}\n")

    with locked(folder):
        rounds = race.run(fresh, finished)
        if importlib.util.find_spec("matplotlib") is not None:
            _draw(rules, race, rounds)
        _film(race, rounds)
    print_rounds(rounds)
    if not quiet:
        out.print(f"{race.trials:,} trials a cell, seed {race.seed}; written to {folder}")


def print_rounds(rounds: list[Round]) -> None:
    """Print the value of each round, who plays what, and what both sides found against it."""
    heads = ("round", "value", "prey play", "predators play", "prey gain", "predators gain")
    table = Table(*heads, title="Rounds", title_justify="left")
    for each in rounds:
        gains = [_gain(each.best(side)) for side in SIDES]
        low, high = each.value
        mixtures = [_mixture(each.prey, each.solution.rows), _mixture(each.predators, each.solution.columns)]
        table.add_row(str(each.number), f"{each.solution.value:.4f} ({low:.4f} to {high:.4f})", *mixtures, *gains)
    out.print(table)
    for each in rounds:
        for answer in each.answers:
            if answer.accepted:
                words = ", ".join(
                    f"{path.rpartition('.')[2]} {_word(old)} to {_word(new)}" for path, (old, new) in answer.moved.items()
                )
                out.print(f"round {each.number}, {answer.side}: {answer.policy.name} from {answer.start}: {words}")


def _word(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def _gain(answer: Any) -> str:
    text = f"{answer.gain.mean:+.4f} ± {(answer.gain.high - answer.gain.low) / 2:.4f}"
    return text if answer.accepted else f"{text} (none)"


def _mixture(policies: tuple[Any, ...], shares: np.ndarray) -> str:
    played = sorted(zip(shares, policies, strict=True), key=lambda pair: -pair[0])
    return ", ".join(f"{policy.name} {share:.0%}" for share, policy in played if share >= SHOWN)


def _film(race: Race, rounds: list[Round]) -> None:
    """Film trial 0 of what both sides play most in each round, all rounds side by side."""
    import render
    import tiswarm

    recordings = []
    for each in rounds:
        prey = each.prey[int(np.argmax(each.solution.rows))]
        predators = each.predators[int(np.argmax(each.solution.columns))]
        scenario = race.scenario(prey, predators).replaced({"title": "What both sides play most, round by round"})
        recordings.append(tiswarm.record(scenario, 0, race.seed))
    labels = [f"round {each.number}" for each in rounds]
    subject = recordings if len(recordings) > 1 else recordings[0]
    render.film(subject, race.folder / "film.mp4", labels=labels if len(recordings) > 1 else None)


def _draw(rules: Rules, race: Race, rounds: list[Round]) -> None:
    """Draw the last pay-off matrix: framed rows and dotted cells are what both mixtures play."""
    from render.plots.heat import Heat, heat

    last = rounds[-1]
    rows, columns = last.solution.rows >= SHOWN, last.solution.columns >= SHOWN
    panel = Heat(
        "",
        [each.name for each in last.prey],
        [each.name for each in last.predators],
        last.payoff,
        last.away,
        np.repeat(rows[:, None], len(columns), axis=1),
        rows[:, None] & columns[None],
    )
    low, high = last.value
    note = f"round {last.number}, value {last.solution.value:.3f} ({low:.3f} to {high:.3f}); framed: the prey's mixture"
    heat([panel], race.folder / "payoff.png", rules.title, note, "share of prey that arrive", "prey", "predators")
