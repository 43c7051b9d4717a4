"""Zero-sum: zero-sum games between prey, who choose rows, and predators, who choose columns; pay-offs go to the prey."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

RESAMPLES = 1000
"""Bootstrap resamples of a game's solution."""


@dataclass(frozen=True)
class Solution:
    """What both sides can hold each other to, and how: value; rows: [row] and columns: [column], shares that sum to 1."""

    value: float
    rows: np.ndarray
    columns: np.ndarray


def solve(payoff: np.ndarray) -> Solution:
    """Solve a zero-sum game by linear programming: [row, column], the row player's pay-off.

    Each side's mixture maximises what it gets against the other's best answer; both give the same value (von Neumann 1928).
    Where several mixtures do, the one is given that the solver ends at.
    """
    rows = _safest(payoff)
    columns = _safest(-payoff.T)
    return Solution(float((rows @ payoff).min()), rows, columns)


def _safest(payoff: np.ndarray) -> np.ndarray:
    """Give the mixture of rows whose worst column is best: maximise v with mixture @ payoff >= v."""
    from scipy.optimize import linprog

    rows, columns = payoff.shape
    found = linprog(
        c=np.append(np.zeros(rows), -1.0),
        A_ub=np.hstack([-payoff.T, np.ones((columns, 1))]),
        b_ub=np.zeros(columns),
        A_eq=np.append(np.ones(rows), 0.0)[None],
        b_eq=[1.0],
        bounds=[(0, None)] * rows + [(None, None)],
        method="highs",
    )
    if not found.success:
        raise RuntimeError(f"game: no solution ({found.message})")
    mixture = np.maximum(found.x[:rows], 0.0)
    return mixture / mixture.sum()


def best_responses(payoff: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mark the prey's best rows against each column, and the predators' best columns against each row: [row, column], bool."""
    return payoff == payoff.max(axis=0, keepdims=True), payoff == payoff.min(axis=1, keepdims=True)


def dominated(payoff: np.ndarray) -> list[np.ndarray | None]:
    """Find a mixture of other rows that is better than a row against every column, for each row; None where there is none.

    A single row that is better everywhere is given before a mixture; for columns, pass -payoff.T.
    """
    found: list[np.ndarray | None] = []
    for row in range(len(payoff)):
        gains = (payoff - payoff[row]).min(axis=1)
        if gains.max() > 0:
            found.append(np.eye(len(payoff))[int(gains.argmax())])
            continue
        others = np.delete(np.arange(len(payoff)), row)
        if not len(others):
            found.append(None)
            continue
        mixture = np.zeros(len(payoff))
        mixture[others] = _safest((payoff - payoff[row])[others])
        found.append(mixture if (mixture @ payoff - payoff[row]).min() > 1e-9 else None)
    return found


@dataclass(frozen=True)
class Spread:
    """Bootstrap intervals, 95 %, of a game's solution: (low, high) of its value, and [row or column, 2] of the shares.

    best: [row, column], the share of resamples in which a row is the prey's best response to a column.
    """

    value: tuple[float, float]
    rows: np.ndarray
    columns: np.ndarray
    best: np.ndarray


def bootstrap(trials: Sequence[Sequence[np.ndarray]], paired: bool, seed: int = 0, resamples: int = RESAMPLES) -> Spread:
    """Resample trials and solve each time: trials[row][column] is [trial], a trial's pay-off.

    paired: trials of one number share their luck in all cells and are drawn together; otherwise each cell is drawn on its own.
    """
    rng = np.random.default_rng(seed)
    shape = (len(trials), len(trials[0]))
    every = np.stack([cell for row in trials for cell in row])  # [cell, trial]
    count = every.shape[1]
    solutions, best = [], np.zeros(shape)
    for _ in range(resamples):
        if paired:
            means = every @ (rng.multinomial(count, np.full(count, 1 / count)) / count)
        else:
            means = np.array([rng.choice(cell, count).mean() for cell in every])
        payoff = means.reshape(shape)
        solutions.append(solve(payoff))
        best += best_responses(payoff)[0]
    rows, columns = (np.stack([getattr(each, side) for each in solutions]) for side in ("rows", "columns"))
    low, high = np.percentile([each.value for each in solutions], [2.5, 97.5])
    row_ends, column_ends = (np.percentile(shares, [2.5, 97.5], axis=0).T for shares in (rows, columns))
    return Spread((float(low), float(high)), row_ends, column_ends, best / resamples)
