"""Pay-offs: a study's cells read as a game between prey and predators, and what its solution says."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tiswarm.records.results import Estimate
from tiswarm.studies import zero_sum
from tiswarm.studies.axes import label
from tiswarm.studies.report import Report, Row

COMPUTED = (
    "value and mixtures: linear programming on the means (HiGHS); intervals: percentiles of {resamples} bootstrap resamples of "
    "trials, {how}, each solved anew; dominated: another row, or a mixture of others, is better against every column"
)

SHOWN = 0.005
"""Shares of a mixture below this are not worth a line."""


@dataclass(frozen=True)
class Contest:
    """A game and its solution: rows are what prey may choose, columns what predators may; pay-offs are the prey's.

    cells: [row][column]; payoff: [row, column], means; best: the same as marks, of the prey's best answer to a column and of
    the predators' best answer to a row; dominators: a mixture [row] for each row that is dominated, else None.
    """

    measure: str
    rows: list[str]
    columns: list[str]
    cells: list[list[Row]]
    payoff: np.ndarray
    solution: zero_sum.Solution
    spread: zero_sum.Spread
    best: tuple[np.ndarray, np.ndarray]
    row_dominators: list[np.ndarray | None]
    column_dominators: list[np.ndarray | None]
    paired: bool

    def estimate(self, row: int, column: int) -> Estimate:
        """Estimate a pay-off."""
        return self.cells[row][column].estimate(self.measure)

    @property
    def value(self) -> dict[str, float]:
        """Give the game's value with its interval."""
        low, high = self.spread.value
        return {"mean": self.solution.value, "low": low, "high": high}

    @property
    def computed(self) -> str:
        """Say what the numbers are."""
        how = "drawn together for all cells, since trials of one number share their luck" if self.paired else "cell by cell"
        return COMPUTED.format(resamples=zero_sum.RESAMPLES, how=how)

    def dominator(self, side: str, k: int) -> str:
        """Name what dominates a row or column, or nothing."""
        names, found = (self.rows, self.row_dominators) if side == "rows" else (self.columns, self.column_dominators)
        mixture = found[k]
        if mixture is None:
            return ""
        return " + ".join(
            f"{share:.0%} {names[j]}" if share < 1 else names[j] for j, share in enumerate(mixture) if share >= SHOWN
        )

    def to_json(self) -> str:
        """Write the game and its solution as JSON."""
        told: dict[str, Any] = {"measure": self.measure, "computed": self.computed, "value": self.value}
        told |= {"prey": _mixture(self.rows, self.solution.rows, self.spread.rows)}
        told |= {"predators": _mixture(self.columns, self.solution.columns, self.spread.columns)}
        told["best_responses"] = {
            "prey": {
                name: {self.rows[r]: self.spread.best[r, c] for r in np.flatnonzero(self.best[0][:, c])}
                for c, name in enumerate(self.columns)
            },
            "predators": {name: [self.columns[c] for c in np.flatnonzero(self.best[1][r])] for r, name in enumerate(self.rows)},
        }
        told["dominated"] = {
            side: {name: by for k, name in enumerate(names) if (by := self.dominator(side, k))}
            for side, names in (("rows", self.rows), ("columns", self.columns))
        }
        means = self.payoff.tolist()
        told["payoff"] = {row: dict(zip(self.columns, each, strict=True)) for row, each in zip(self.rows, means, strict=True)}
        return json.dumps(told, indent=2) + "\n"


def _mixture(names: Sequence[str], shares: np.ndarray, ends: np.ndarray) -> dict[str, dict[str, float]]:
    return {
        name: {"share": float(share), "low": float(low), "high": float(high)}
        for name, share, (low, high) in zip(names, shares, ends, strict=True)
    }


def contest(report: Report) -> Contest | None:
    """Solve the game that a study is, None when it is none."""
    rules = report.study.game
    if rules is None:
        return None

    def side(row: Row, keys: Sequence[str]) -> str:
        return "/".join(label(row.cell.point[key]) for key in keys if key in row.cell.point)

    places = {(side(row, rules.prey), side(row, rules.predators)): row for row in report.rows}
    rows, columns = (list(dict.fromkeys(place[k] for place in places)) for k in (0, 1))
    if len(places) < len(rows) * len(columns):
        raise ValueError(
            f"game: {len(places)} cells do not fill {len(rows)} rows by {len(columns)} columns; combine axes as a grid"
        )
    cells = [[places[row, column] for column in columns] for row in rows]
    payoff = np.array([[cell.estimate(rules.payoff).mean for cell in each] for each in cells])
    paired = not report.study.independent
    spread = zero_sum.bootstrap([[cell.values(rules.payoff) for cell in each] for each in cells], paired, report.seed)
    return Contest(
        rules.payoff,
        rows,
        columns,
        cells,
        payoff,
        zero_sum.solve(payoff),
        spread,
        zero_sum.best_responses(payoff),
        zero_sum.dominated(payoff),
        zero_sum.dominated(-payoff.T),
        paired,
    )
