"""Runner: the process in which the simulation that is watched runs, at the pace that its reader chose."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing.connection import Connection
from typing import Any

import numpy as np

import tiswarm
from render.live.frame import Scene
from render.live.worker import Settings
from tiswarm.records.recording import FATES

FRAMES = 60.0
"""Frames a second that are enough: at twice the pace each shows two ticks, and so on."""

HOLD = 1.2
"""Seconds that the end of a trial is looked at before the next one begins."""

LATE = 0.25
"""Whoever is later than this [s] does not hurry to catch up."""

BODY = 1 / 40
"""Radius of an obstacle that is dropped into a world without any [share of its shorter side]."""


@dataclass(frozen=True)
class Job:
    """What a runner begins with. scenario: as JSON; rate: ticks a second; first: number of its first scene."""

    scenario: str
    seed: int
    trial: int
    playing: bool
    rate: float
    first: int


def run(pipe: Connection, settings: Settings, job: Job) -> None:
    """Run until the pipe is closed; see `Runner`."""
    settings.begin()
    Runner(pipe, job).run()


class Runner:
    """Runs trial after trial, hears what is to be changed, and tells what is to be seen.

    It tells ("scene", header), ("frame", bytes), ("ended", counts, seconds, heard at its start), ("note", words).
    """

    def __init__(self, pipe: Connection, job: Job) -> None:
        """Begin with the first trial."""
        self._pipe = pipe
        self._scenario = tiswarm.Scenario.from_json(job.scenario)
        self._seed, self._trial = job.seed, job.trial
        self._playing, self._rate = job.playing, job.rate
        self._number = job.first
        self._heard = 0
        self._due = self._ended = time.monotonic()
        self._told = False
        self._deeds: dict[str, Callable[..., None]] = {
            "play": self._play,
            "rate": self._pace,
            "step": self._step,
            "set": self._set,
            "anew": self._anew,
            "drop": self._drop,
        }
        self._begin()

    def run(self) -> None:
        """Run until told to end."""
        while True:
            if self._pipe.poll(self._wait()):
                name, *arguments = self._pipe.recv()
                if name == "end":
                    return
                try:
                    self._deeds[name](*arguments)
                except ValueError as error:
                    self._pipe.send(("note", str(error)))
            elif self._playing:
                self._advance()

    def _wait(self) -> float | None:
        """Say how long nothing need be done [s]; None: for as long as nobody says anything."""
        return max(self._due - time.monotonic(), 0) if self._playing else None

    def _begin(self) -> None:
        """Begin a trial."""
        simulation = tiswarm.Simulation(self._scenario, self._seed, self._trial)
        self._since = self._heard
        self._take(simulation, np.zeros(len(FATES), int), 0)

    def _take(self, simulation: tiswarm.Simulation, before: np.ndarray, earlier: int) -> None:
        """Show a simulation from now on."""
        self._number += 1
        self._scene = Scene(simulation, self._number, before, earlier)
        self._told = False
        self._pipe.send(("scene", self._scene.header()))
        self._show()

    def _show(self) -> None:
        self._pipe.send(("frame", self._scene.frame(self._heard)))

    def _advance(self) -> None:
        """Run a tick, or as many as one frame shows; after a trial, hold, and go on with the next one."""
        simulation, now = self._scene.simulation, time.monotonic()
        if simulation.ended:
            self._trial += 1
            self._begin()
            self._due = now + 1 / self._rate
            return
        ticks = max(int(self._rate / FRAMES), 1)
        self._run(ticks)
        self._due = max(self._due, now - LATE) + ticks / self._rate
        if simulation.ended:
            self._due = time.monotonic() + HOLD

    def _run(self, ticks: int) -> None:
        simulation = self._scene.simulation
        try:
            simulation.step(ticks)
        except (RuntimeError, ValueError) as error:  # a state that is not finite any more
            self._playing = False
            self._pipe.send(("halted", str(error)))
            return
        self._show()
        if simulation.ended and not self._told:
            self._told = True
            seconds = (self._scene.earlier + simulation.age) * simulation.scenario.world.dt
            self._pipe.send(("ended", self._scene.counts().tolist(), seconds, self._since))

    def _play(self, on: bool) -> None:
        self._playing = on
        self._due = time.monotonic()

    def _pace(self, rate: float) -> None:
        self._rate = rate
        self._due = time.monotonic()

    def _step(self) -> None:
        if self._scene.simulation.ended:
            self._trial += 1
            self._begin()
        else:
            self._run(1)

    def _set(self, changes: dict[str, Any], heard: int) -> None:
        """Change numbers, in this trial and in those that come."""
        self._scenario = self._scenario.replaced(changes)
        self._heard = heard
        if self._scene.simulation.ended:
            return
        try:
            self._scene.simulation.set(changes)
        except tiswarm.ScenarioError:  # it acts at the start only
            self._begin()
            return
        if not self._playing:
            self._show()

    def _anew(self, scenario: str, seed: int, trial: int, heard: int) -> None:
        """Begin another trial."""
        self._scenario = tiswarm.Scenario.from_json(scenario)
        self._seed, self._trial, self._heard = seed, trial, heard
        self._begin()
        self._due = time.monotonic()

    def _drop(self, kind: str, place: list[float]) -> None:
        """Take the trial up from where it is, with one obstacle or predator more; what agents remember is forgotten."""
        simulation = self._scene.simulation
        scenario = simulation.scenario
        if simulation.ended:
            raise ValueError("the trial is over; wait for the next one")
        if kind == "predator" and not scenario.predators.count:
            raise ValueError("there are no predators in this world; set their count first, then drop more")
        agents: dict[str, list[np.ndarray]] = {}
        for side in ("prey", "predators"):
            here = np.isfinite(simulation.position(side)[:, 0])
            agents[side] = [simulation.position(side)[here], simulation.velocity(side)[here]]
        where, radii = simulation.obstacles
        spot = np.array([place], float)
        if kind == "predator":
            agents["predators"] = [np.concatenate(both) for both in zip(agents["predators"], (spot, 0 * spot), strict=True)]
        else:
            radius = scenario.obstacles.radius[1] if len(radii) else BODY * min(scenario.world.size)
            where, radii = np.concatenate([where, spot]), np.append(radii, radius)
        (prey, pace), (hunters, chase) = agents["prey"], agents["predators"]
        start = tiswarm.Start(prey, pace, hunters, chase, where, radii)
        left = scenario.replaced({"world.ticks": simulation.max_ticks - simulation.age})
        before, earlier = self._scene.counts() * np.array([0, 1, 1, 1]), self._scene.earlier + simulation.age
        taken = tiswarm.Simulation(left, self._seed, self._trial, start)
        self._since = -1  # it is no trial of the scenario any more
        self._take(taken, before, earlier)
