"""Session: what is watched, what its readers have turned, and what they are told: the same for all who look."""

import json
import secrets
import shlex
from asyncio import AbstractEventLoop
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

import tiswarm
from render.live import runner, trials
from render.live.frame import CLOUDED
from render.live.table import Table
from render.live.worker import Message, Settings, Worker
from tiswarm.dynamics.specialisation import Specialisation
from tiswarm.engine.choice import engine_of
from tiswarm.scenario.knobs import Knob, knobs, number, whole
from tiswarm.scenario.parts import leaves, plain
from tiswarm.simd.philox import seed_words

PACE = 10.0
"""Ticks a second at speed 1, as in films and pages."""

RATES = 1.0, 400.0
"""Ticks a second, at least and at most."""

SCENES = 1 << 16
"""Numbers of scenes that one runner may use."""


@dataclass(frozen=True)
class Begun:
    """What `tiswarm live` was asked for. preset: as it was named; sets: KEY=VALUE each."""

    scenario: tiswarm.Scenario
    preset: str
    sets: tuple[str, ...] = ()
    seed: int = 0
    trial: int = 0


class Session:
    """Heeds what readers do, and tells them what is: `tell(kind, words)`, `show(frame)`.

    Of each kind of telling only the newest matters, so that whoever comes late or is slow needs no others.
    """

    def __init__(
        self,
        begun: Begun,
        settings: Settings,
        loop: AbstractEventLoop,
        tell: Callable[[str, dict[str, Any]], None],
        show: Callable[[bytes], None],
    ) -> None:
        """Start both processes."""
        self._begun, self._settings, self._loop = begun, settings, loop
        self._tell, self._show = tell, show
        self.scenario = begun.scenario
        self._seed, self._trial = begun.seed, begun.trial
        self._playing, self._rate = True, PACE
        self._serial = 0
        self._scenes = 0
        self._coming: Worker | None = None
        self._next: tiswarm.Scenario | None = None
        self._since: list[dict[str, Any]] = []
        self._runner = self._start(self.scenario)
        self._table = Table(Worker(trials.run, [settings], self._soon), loop, tell)
        self._acts: dict[str, Callable[[dict[str, Any]], None]] = {
            "play": self._play,
            "step": lambda _: self._runner.send("step"),
            "speed": self._speed,
            "restart": self._restart,
            "set": self._set,
            "drop": self._drop,
        }
        self._tell_knobs()
        self._tell_state()
        self._table.settle(self.scenario, self._seed, self._serial)

    def close(self) -> None:
        """End all processes."""
        self._table.close()
        workers = [each for each in (self._runner, self._coming, self._table.worker) if each is not None]
        for worker in workers:
            worker.end()
        for worker in workers:
            worker.close()

    def do(self, message: Any) -> None:
        """Heed what a reader does. Errors: ValueError for what cannot be."""
        act = self._acts.get(str(message.get("act"))) if isinstance(message, dict) else None
        if act is None:
            raise ValueError("that is no act of this page; load it anew")
        act(message)

    def _start(self, scenario: tiswarm.Scenario) -> Worker:
        """Start a runner."""
        job = runner.Job(scenario.to_json(), self._seed, self._trial, self._playing, self._rate, self._scenes * SCENES)
        self._scenes += 1
        return Worker(runner.run, [self._settings, job], self._soon)

    def _soon(self, worker: Worker, message: Message) -> None:
        """Hear a process, in the thread of the loop."""
        if not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._hear, worker, message)

    def _hear(self, worker: Worker, message: Message) -> None:
        name, *said = message
        if worker is self._coming:
            self._arrive(name, said)
        if worker is self._runner:
            if name == "frame":
                self._show(said[0])
            elif name == "scene":
                self._trial = said[0]["trial"]
                self._tell("scene", said[0])
                self._tell_state()
                self._tell_values()  # the film is of another trial
            elif name == "ended":
                counts, seconds, serial = said
                if serial == self._serial:
                    self._table.count(counts, seconds)
            elif name == "halted":
                self._playing = False
                self._tell_state()
            if name in ("note", "halted", "failed", "gone"):
                self._note(said[0] if said else "the simulation has ended; start tiswarm live again")
        if worker is self._table.worker and name in ("trials", "untried", "failed", "gone"):
            self._table.estimated(name, said)

    def _note(self, words: str) -> None:
        self._tell("note", {"words": words})

    # What readers do.

    def _changed(self) -> None:
        """Note that from here on trials are others."""
        self._serial += 1
        self._table.settle(self.scenario, self._seed, self._serial)

    def _play(self, message: dict[str, Any]) -> None:
        self._playing = bool(message.get("on"))
        self._runner.send("play", self._playing)
        self._tell_state()

    def _speed(self, message: dict[str, Any]) -> None:
        self._rate = min(max(PACE * number(message.get("speed")), RATES[0]), RATES[1])
        self._runner.send("rate", self._rate)
        self._tell_state()

    def _restart(self, message: dict[str, Any]) -> None:
        """Begin anew: with the seed that is named, or with one that nobody has seen."""
        seed = secrets.randbelow(2**31) if message.get("seed") is None else whole(message["seed"])
        seed_words(seed)
        self._seed, self._trial = seed, 0
        self._anew()

    def _anew(self) -> None:
        self._changed()
        self._runner.send("anew", self.scenario.to_json(), self._seed, self._trial, self._serial)
        self._tell_state()

    def _set(self, message: dict[str, Any]) -> None:
        """Turn a knob."""
        knob = self._knobs.get(str(message.get("path")))
        if knob is None:
            raise ValueError(f"{str(message.get('path'))[:80]!r} cannot be turned here; load the page anew")
        changes = {knob.path: knob.checked(message.get("value"))}
        coming = (self._next or self.scenario).replaced(changes)
        if _structure(coming) != _structure(self._next or self.scenario):
            self._build(coming)
            return
        if self._next is not None and not (knob.path in self.scenario.numbers() and knob.anew is False):
            self._build(coming)  # what waits for the kernel has another start
            return
        self.scenario = self.scenario.replaced(changes)
        if self._next is not None:
            self._next = coming
            self._since.append(changes)
        if knob.anew:
            self._anew()
            self._tell_knobs()
        else:
            self._changed()
            self._runner.send("set", changes, self._serial)
            self._tell_values()

    def _drop(self, message: dict[str, Any]) -> None:
        kind, place = message.get("kind"), message.get("place")
        if kind not in ("obstacle", "predator") or not isinstance(place, list) or len(place) != 2:
            raise ValueError("only obstacles and predators can be dropped, at two numbers of metres")
        if self.scenario.world.dim != 2:
            raise ValueError("things can be dropped into flat worlds only")
        self._runner.send("drop", kind, [number(each) for each in place])

    # Another structure: its kernel is compiled in a process of its own, while the old one runs on.

    def _build(self, scenario: tiswarm.Scenario) -> None:
        if self._coming is not None:
            self._coming.leave()
        self._next, self._since = scenario, []
        self._coming = self._start(scenario)
        self._tell_knobs()
        self._tell_state()

    def _arrive(self, name: str, said: list[Any]) -> None:
        """Hear a runner that is to take over: its first scene says that it is ready."""
        assert self._coming is not None
        assert self._next is not None
        if name in ("failed", "gone"):
            self._coming.leave()
            self._coming, self._next = None, None
            self._note(said[0] if said else "the new simulation has ended before it began")
            self._tell_knobs()
            self._tell_state()
        elif name == "scene":
            old, self._runner, self.scenario = self._runner, self._coming, self._next
            self._coming, self._next = None, None
            old.leave()
            self._runner.send("rate", self._rate)
            self._runner.send("play", self._playing)
            self._changed()
            for changes in [*self._since, {}]:
                self._runner.send("set", changes, self._serial)
            self._tell_knobs()

    # What readers are told.

    @property
    def _knobs(self) -> dict[str, Knob]:
        return {each.path: each for each in knobs(self._next or self.scenario, self._begun.scenario)}

    def _tell_knobs(self) -> None:
        self._tell("knobs", {"knobs": [asdict(each) for each in self._knobs.values()]})
        self._tell_values()

    def _tell_values(self) -> None:
        """Tell the numbers of now, and those that the drawing needs."""
        scenario = self.scenario
        sizes = {
            kind: {key: getattr(getattr(scenario, kind), key) for key in ("radius", "perception")}
            for kind in ("prey", "predators")
        }
        target = list(scenario.target.position) if scenario.target.present else None
        values = {each.path: each.value for each in self._knobs.values()}
        self._tell("values", {"values": values, "serial": self._serial, "sizes": sizes, "target": target, "film": self.film()})

    def _tell_state(self) -> None:
        building = None
        if self._next is not None:
            building = ", ".join(f"{path}={value}" for path, value in _different(self.scenario, self._next).items())
        told = {"playing": self._playing, "speed": self._rate / PACE, "seed": self._seed, "trial": self._trial}
        self._tell("state", told | {"building": building})

    def film(self) -> str:
        """Write the command that films the trial with the numbers of now."""
        words = ["tiswarm", "film", self._begun.preset]
        for each in self._begun.sets:
            words += ["--set", each]
        for path, value in _different(self._begun.scenario, self.scenario).items():
            words += ["--set", f"{path}={value if isinstance(value, str) else json.dumps(value)}"]
        return shlex.join([*words, "--seed", str(self._seed), "--trial", str(self._trial)])


def _structure(scenario: tiswarm.Scenario) -> tuple[Any, ...]:
    """Name what a kernel is compiled for."""
    return engine_of(scenario), Specialisation.of([scenario], scenario.predators.count), scenario.prey.count > CLOUDED


def _different(one: tiswarm.Scenario, other: tiswarm.Scenario) -> dict[str, Any]:
    """Find what of a scenario differs from another one: path -> value."""
    before = dict(leaves(plain(one)))
    return {path: value for path, value in leaves(plain(other)) if before.get(path, ...) != value}
