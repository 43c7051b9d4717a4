"""Deadlocks: prey that keep moving and get nowhere, in a recording; of the same trial traps.py finds the same in the kernel."""

from dataclasses import dataclass

import numpy as np

from tiswarm.records.recording import Recording


@dataclass(frozen=True)
class Deadlocks:
    """Who was trapped so far.

    time: [tick, prey], for how many ticks, 0 for who never was; spin: [tick, prey], Σ (x - c) × step meanwhile, positive when
    it goes around c anticlockwise, and most: [tick, prey], Σ |x - c| |step|, what that would be on a smooth circle, m²;
    zeros in a deep world.
    """

    time: np.ndarray
    spin: np.ndarray
    most: np.ndarray


def deadlocks(recording: Recording) -> Deadlocks:
    """Follow each prey's window, which begins anew whenever the prey is more than measures.within from where it began.

    It is trapped in a state when its window is measures.window ticks old or older and its path, step by step, has been at
    least measures.path for every measures.window ticks of the window's age; then it has been trapped since the window began.
    So whoever circles where the circle's diameter is at most measures.within is trapped, and so is who jumps to and fro
    there; whoever stands still or creeps is not (its path is too short), nor who flies past, walks along a wall or circles
    more widely (it leaves its window's disc), nor who is gone before a window is old enough.

    c is the mean of a window's places so far. Turns of the course would not tell a circle from a hop to and fro, whose turns
    are by half a circle each and may all fall on one side of it.
    """
    measures, prey = recording.scenario.measures, recording.prey
    position, flat = prey.position, recording.dim == 2
    anchor, total = position[0].copy(), np.zeros_like(position[0])
    held, path, counted, own_spin, own_most = np.zeros((5, prey.count))
    time, spin, most = np.zeros((3, *prey.alive.shape))
    for tick in range(1, recording.ticks + 1):
        here = prey.alive[tick]
        step = recording.shortest(position[tick] - position[tick - 1])
        away = recording.shortest(position[tick] - anchor)
        off = here & ((away**2).sum(axis=-1) > measures.within**2)
        held += here
        length = np.sqrt((step**2).sum(axis=-1))
        path += np.where(here, length, 0.0)
        if flat:
            total += np.where(here[:, None], away, 0.0)
            arm = away - total / (held + 1)[:, None]
            own_spin += np.where(here, arm[:, 0] * step[:, 1] - arm[:, 1] * step[:, 0], 0.0)
            own_most += np.where(here, np.sqrt((arm**2).sum(axis=-1)) * length, 0.0)
        anchor[off] = position[tick, off]
        for each in (held, path, counted, total, own_spin, own_most):
            each[off] = 0
        stuck = here & (held >= measures.window) & (path * measures.window >= measures.path * held)
        time[tick] = time[tick - 1] + np.where(stuck, held - counted, 0)
        spin[tick] = spin[tick - 1] + np.where(stuck, own_spin, 0)
        most[tick] = most[tick - 1] + np.where(stuck, own_most, 0)
        counted[stuck] = held[stuck]
        own_spin[stuck] = own_most[stuck] = 0
    return Deadlocks(time, spin, most)


def trapped(recording: Recording) -> np.ndarray:
    """Give the share of the prey that started which have ever been trapped: [tick], 0 to 1."""
    return (deadlocks(recording).time > 0).mean(axis=1)


def trapped_time(recording: Recording) -> np.ndarray:
    """Give how long prey have been trapped, the mean over all that started: [tick], s."""
    return deadlocks(recording).time.mean(axis=1) * recording.scenario.world.dt


def trapped_milling(recording: Recording) -> np.ndarray:
    """Give how far trapped prey circle, Σ (x - c) × step/Σ |x - c| |step|: [tick], NaN before anybody is trapped.

    1: anticlockwise on a smooth circle, 0.87 on a hexagon, 0.5 on a triangle; less than 0: clockwise; 0: to and fro, or as
    often one way as the other. Errors: ValueError for a deep world.
    """
    if recording.dim != 2:
        raise ValueError("trapped-milling: only in a flat world does one circle left or right; leave it out")
    found = deadlocks(recording)
    spin, most = found.spin.sum(axis=1), found.most.sum(axis=1)
    return np.divide(spin, most, out=np.full(len(spin), np.nan), where=most > 0)
