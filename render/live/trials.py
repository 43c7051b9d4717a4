"""Trials: the process that runs a thousand trials with the numbers of now while somebody watches one."""

import os
import time
from contextlib import suppress
from dataclasses import dataclass
from math import isfinite
from multiprocessing.connection import Connection
from typing import Any

import tiswarm
from render.live.worker import Settings
from tiswarm.engine.choice import engine_of

SIZES = (40, 200, 1000)
"""Trials of an estimate: a rough one at once, a finer one, and the one that counts."""

Rows = dict[str, tuple[float | None, float | None, float | None]]
"""Name of a measure -> mean, lower and upper end of its interval; None for what so few trials cannot tell."""

KINDER = 10
"""How much these trials stand back behind what is watched, as `nice` counts."""


@dataclass(frozen=True)
class Asked:
    """What to estimate. number: names the question; scenario: as JSON."""

    number: int
    scenario: str
    seed: int


def run(pipe: Connection, settings: Settings) -> None:
    """Answer each Asked by ("trials", number, trials, Rows, seconds), several times, unless another comes."""
    settings.begin()
    with suppress(AttributeError, OSError):
        os.nice(KINDER)
    while True:
        message = pipe.recv()
        while pipe.poll():
            message = pipe.recv()
        if message[0] == "end":
            return
        try:
            _answer(pipe, message[1])
        except (ValueError, RuntimeError) as error:
            pipe.send(("untried", message[1].number, str(error)))


def _answer(pipe: Connection, asked: Asked) -> None:
    """Estimate ever more finely, until the next question comes."""
    scenario = tiswarm.Scenario.from_json(asked.scenario)
    for count in SIZES:
        begun = time.monotonic()
        results = tiswarm.simulate(scenario, count, asked.seed)
        rows = {name: row(results.measure(name)) for name in shown(scenario)}
        pipe.send(("trials", asked.number, count, rows, time.monotonic() - begun))
        if pipe.poll():
            return


def row(values: Any) -> tuple[float | None, float | None, float | None]:
    """Give the mean of values [trial] and its 95 % interval."""
    told = tiswarm.Estimate.of(values)
    mean, low, high = (value if isfinite(value) else None for value in (told.mean, told.low, told.high))
    return mean, low, high


def refused(scenario: tiswarm.Scenario) -> str:
    """Say why a thousand trials of a scenario are not run, or nothing."""
    if engine_of(scenario) == "grid":
        return "swarms as large as this one take too long for a thousand trials beside it"
    return ""


def measured(scenario: tiswarm.Scenario) -> tiswarm.Scenario:
    """Let a scenario in which nobody arrives or dies measure something that its numbers change."""
    names = scenario.measures.names
    return scenario if len(shown(scenario)) > 1 else scenario.replaced({"measures.names": [*names, "polarisation"]})


def shown(scenario: tiswarm.Scenario) -> list[str]:
    """Name what is worth a row of the table."""
    hunted = scenario.predators.count > 0 and scenario.world.contact in ("deadly", "eaten")
    crashes = scenario.obstacles.count > 0 and scenario.obstacles.contact == "crash"
    rows = {"success": scenario.target.present, "captured": hunted, "crashed": crashes, "time": True}
    return [*(name for name, there in rows.items() if there), *scenario.measures.names]
