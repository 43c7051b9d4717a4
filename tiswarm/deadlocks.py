"""Deadlocks: prey that keep moving and get nowhere, in a recording; of the same trial traps.py finds the same in the kernel."""

from dataclasses import dataclass

import numpy as np

from tiswarm.recording import Recording


@dataclass(frozen=True)
class Deadlocks:
    """Who was trapped so far.

    time: [tick, prey], for how many ticks, 0 for who never was; turn, turned: [tick, prey], how far its course turned
    anticlockwise meanwhile, and how far in all, rad; zeros in a deep world.
    """

    time: np.ndarray
    turn: np.ndarray
    turned: np.ndarray


def deadlocks(recording: Recording) -> Deadlocks:
    """Follow each prey's window, which begins anew whenever the prey is more than measures.within from where it began.

    It is trapped in a state when its window is measures.window ticks old or older and its path, step by step, has been at
    least measures.path for every measures.window ticks of the window's age; then it has been trapped since the window began.
    So whoever circles where the circle's diameter is at most measures.within is trapped, and so is who jumps to and fro
    there; whoever stands still or creeps is not (its path is too short), nor who flies past, walks along a wall or circles
    more widely (it leaves its window's disc), nor who is gone before a window is old enough.

    Turns are between steps of one window, each -π to π; who reverses its course turns by π, anticlockwise.
    """
    measures, prey = recording.scenario.measures, recording.prey
    position, flat = prey.position, recording.dim == 2
    anchor, step = position[0].copy(), np.zeros_like(position[0])
    held, path, counted, own_turn, own_turned = np.zeros((5, prey.count))
    time, turn, turned = np.zeros((3, *prey.alive.shape))
    for tick in range(1, recording.ticks + 1):
        here = prey.alive[tick]
        before, step = step, recording.shortest(position[tick] - position[tick - 1])
        away = recording.shortest(position[tick] - anchor)
        off = here & ((away**2).sum(axis=-1) > measures.within**2)
        held += here
        path += np.where(here, np.sqrt((step**2).sum(axis=-1)), 0.0)
        if flat:
            angle = np.arctan2(before[:, 0] * step[:, 1] - before[:, 1] * step[:, 0], (before * step).sum(axis=-1))
            angle = np.where(here & (held > 1), angle, 0.0)
            own_turn += angle
            own_turned += np.abs(angle)
        anchor[off] = position[tick, off]
        for each in (held, path, counted, own_turn, own_turned):
            each[off] = 0
        stuck = here & (held >= measures.window) & (path * measures.window >= measures.path * held)
        time[tick] = time[tick - 1] + np.where(stuck, held - counted, 0)
        turn[tick] = turn[tick - 1] + np.where(stuck, own_turn, 0)
        turned[tick] = turned[tick - 1] + np.where(stuck, own_turned, 0)
        counted[stuck] = held[stuck]
        own_turn[stuck] = own_turned[stuck] = 0
    return Deadlocks(time, turn, turned)


def trapped(recording: Recording) -> np.ndarray:
    """Give the share of the prey that started which have ever been trapped: [tick], 0 to 1."""
    return (deadlocks(recording).time > 0).mean(axis=1)


def trapped_time(recording: Recording) -> np.ndarray:
    """Give how long prey have been trapped, the mean over all that started: [tick], s."""
    return deadlocks(recording).time.mean(axis=1) * recording.scenario.world.dt


def trapped_turn(recording: Recording) -> np.ndarray:
    """Give how far trapped prey turn one way, Σ turns/Σ |turns|: [tick], NaN before any turn.

    1: all turns are anticlockwise, as on a circle; -1: clockwise; 0: to and fro alike. Errors: ValueError for a deep world.
    """
    if recording.dim != 2:
        raise ValueError("trapped-turn: only in a flat world do courses turn left or right; leave it out")
    found = deadlocks(recording)
    turn, turned = found.turn.sum(axis=1), found.turned.sum(axis=1)
    return np.divide(turn, turned, out=np.full(len(turn), np.nan), where=turned > 0)
