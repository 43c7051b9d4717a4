"""Story: what happens in a recording, in words, and as subtitles of its film for those who do not see the picture."""

import os
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from render.encoder import FilmError
from render.language import Language, language_named
from render.scene.trajectories import Trajectories
from render.style import look_of
from render.timeline import HOLD, Rate, times
from tiswarm.records.recording import Recording, Swarm
from tiswarm.space import box
from tiswarm.system.files import replacing
from tiswarm.system.words import reason

OPENING, CLOSING = 1.5, 2.0
"""How long a film's cards stay [s of film]."""

READING, TOGETHER = 2.5, 1.2
"""How long a line rests, and how close lines follow each other before they are told at once [s of film]."""

ENDS = {"captured": "caught", "arrived": "reach", "crashed": "crash"}
"""Fate -> the line that says so."""


@dataclass(frozen=True)
class Event:
    """What happened in a tick, the first without the agents that it took. agents: their numbers, prey first."""

    tick: int
    words: str
    agents: tuple[int, ...] = ()


def events(recording: Recording, words: Language | None = None) -> list[Event]:
    """Tell what became of agents, tick by tick. Agents have the numbers that the recording's arrays give them.

    words: the language, English when None.
    """
    words = words or language_named("en")
    told: list[tuple[int, Event]] = []
    for rank, kind in enumerate(("prey", "predators")):
        swarm: Swarm = getattr(recording, kind)
        gone = ends(swarm)
        for fate, line in ENDS.items():
            took = (swarm.fate == fate) & (kind == "prey" or fate == "crashed")
            for tick in np.unique(gone[took]):
                agents = np.flatnonzero(took & (gone == tick))
                captor = _captor(recording, agents, int(tick)) if fate == "captured" else None
                who = _named(recording, kind, agents, words)
                if captor is None:
                    told_so = words.say(f"lines.{line}", len(agents), who=who)
                else:
                    hunter = f"{words.noun(recording.scenario, 'predators', 1)} {captor}"
                    told_so = words.say("lines.caught-by", len(agents), who=who, captor=hunter)
                took_part = [
                    *(agents + rank * recording.prey.count),
                    *([] if captor is None else [captor + recording.prey.count]),
                ]
                event = Event(int(tick), told_so[:1].upper() + told_so[1:], tuple(map(int, took_part)))
                told.append((rank, event))
    return [each for _, each in sorted(told, key=lambda pair: (pair[1].tick, pair[0]))]


def ends(swarm: Swarm) -> np.ndarray:
    """Give the tick of the first state in which each agent is no more: [agent]; one past the last for those who stay."""
    return swarm.alive.sum(axis=0)


def _named(recording: Recording, kind: str, agents: np.ndarray, words: Language) -> str:
    """Call agents by their noun and numbers."""
    return f"{words.noun(recording.scenario, kind, len(agents))} {words.listed([str(agent) for agent in agents])}"


def _captor(recording: Recording, captives: np.ndarray, tick: int) -> int | None:
    """Find who caught a captive, where that is known: it died of it, too, and nobody else did in that tick."""
    hunters = recording.predators
    captors = np.flatnonzero((hunters.fate == "captured") & (ends(hunters) == tick))
    if len(captives) > 1 or len(captors) != 1:
        return None
    apart = recording.prey.position[tick - 1, captives[0]] - hunters.position[tick - 1, captors[0]]
    world = recording.scenario.world
    gap = np.linalg.norm(box.displacement(apart, box.period(world.size, world.boundary)))
    steps = sum(
        np.linalg.norm(swarm.velocity[tick - 1, who[0]]) for swarm, who in ((recording.prey, captives), (hunters, captors))
    )
    touch = recording.scenario.prey.radius + recording.scenario.predators.radius
    if gap > touch + steps * world.dt:
        return None
    return int(captors[0])


def outcome(recording: Recording, words: Language | None = None) -> str:
    """Say how it ended: how many of the prey met which end. words: as of `events`."""
    words = words or language_named("en")
    fates = recording.prey.fate
    counts = {fate: int((fates == fate).sum()) for fate in ("arrived", "captured", "crashed", "alive")}
    time = words.whole(round(recording.ticks * recording.scenario.world.dt))
    parts = [f"{words.whole(count)} {words.say(f'fates.{name}')}" for name, count in counts.items() if count]
    who = words.counted(recording.scenario, "prey", len(fates))
    return words.say("lines.outcome", time=time, who=who, ends=words.listed(parts))


def subtitles(recording: Recording, path: str | os.PathLike, fps: Rate = 60, **look: Any) -> Path:
    """Write the events of a recording's film as WebVTT subtitles. fps, look: as those of the film.

    Errors: ValueError or TypeError for a choice that is not possible; FilmError when the file cannot be written.
    """
    style, target = look_of(look), Path(path)
    words = style.wording
    shown = list(times(Trajectories([recording]), style.speed, fps, slow=style.slowed))
    begin, more = (OPENING, CLOSING) if style.cards else (0.0, 0.0)
    happened = [(begin + bisect_left(shown, each.tick) / float(fps), each.words + ".") for each in events(recording, words)]
    last = begin + len(shown) / float(fps)
    cues = _cues(
        [(0.0, words.title(recording.scenario) + "."), *happened, (last - HOLD, outcome(recording, words))], last + more
    )
    lines = [f"{_stamp(start)} --> {_stamp(end)}\n{words}\n" for start, end, words in cues]
    try:
        with replacing(target) as part:
            part.write_text("\n".join(["WEBVTT\n", *lines]), encoding="utf-8")
    except OSError as error:
        raise FilmError(f"{target}: cannot be written: {reason(error)}") from None
    return target


def _cues(told: Sequence[tuple[float, str]], last: float) -> list[tuple[float, float, str]]:
    """Give lines their time: each rests until the next begins or was long enough to read; close ones are told together."""
    groups: list[tuple[float, list[str]]] = []
    for start, words in told:
        if groups and start - groups[-1][0] < TOGETHER:
            groups[-1][1].append(words)
        else:
            groups.append((start, [words]))
    nexts = [start for start, _ in groups[1:]] + [last]
    return [
        (start, min(start + READING * len(words), following), "\n".join(words))
        for (start, words), following in zip(groups, nexts, strict=True)
    ]


def _stamp(seconds: float) -> str:
    whole, thousandths = divmod(round(1000 * seconds), 1000)
    return f"{whole // 3600:02}:{whole // 60 % 60:02}:{whole % 60:02}.{thousandths:03}"
