"""Clustering predators of a trial that the thesis's author saved in 2022: each of their moves is one that ours may make."""

from pathlib import Path

import numpy as np

import tiswarm
from tiswarm.engine.trials.trial import Single

SAVED = Path(__file__).parent / "saved" / "cluster.npz"
SEEDS = 64
"""Draws of a centre for each move; one that is drawn in one fit of six is missed once in 100 000."""

STILL = {"world.contact": "none", "prey.avoidance": "none"} | {
    f"prey.{pull}": 0 for pull in ("cohesion", "separation", "alignment", "goal")
}
"""Prey that stay where they are put: predators see the prey after their move, so they are put there."""


def test_every_saved_move_is_towards_a_centre_among_mates_of_the_same_number(f64):
    saved = dict(np.load(SAVED))
    start = tiswarm.Start(
        saved["prey_position"][0],
        saved["prey_velocity"][0],
        saved["predator_position"][0],
        saved["predator_velocity"][0],
        saved["obstacle_position"],
        saved["obstacle_radius"],
    )
    scenario = tiswarm.load("delft/cluster-10", STILL)
    singles = [Single(scenario, seed, 0, start) for seed in range(SEEDS)]
    scores, moves = [], 0
    for tick in range(len(saved["prey_position"]) - 1):
        prey, after = saved["prey_position"][tick + 1], saved["predator_position"][tick + 1]
        if np.isnan(prey).sum() > np.isnan(saved["prey_position"][tick]).sum():
            continue  # where a prey died is not saved
        ours = []
        for single in singles:
            single.place("prey", prey, np.zeros_like(prey))
            single.place("predators", saved["predator_position"][tick], saved["predator_velocity"][tick])
            single.step()
            ours.append(single.position("predators"))
        away = np.linalg.norm(np.array(ours) - after, axis=2)
        moves += np.isfinite(after[:, 0]).sum()
        scores += [_score(away[:, j]) for j in np.flatnonzero((away < 1e-6).any(axis=0))]
    assert moves == 1079
    assert 1077 <= len(scores) <= 1079  # the other two are of fits that ended in a minimum of some place only
    share, expected, options = np.array(scores).T
    assert (options <= 3).mean() > 0.95  # one move for each centre, and so not by luck
    error = (share - expected).std() / np.sqrt(len(share))
    assert abs((share - expected).mean()) < 3 * error  # his predators choose rare centres as rarely as ours
    assert share.mean() > (1 / options).mean() + 10 * error  # and not one as often as the other


def _score(away):
    """Give how often we draw the move that was saved, how often any would be drawn twice by chance, and the number of moves."""
    _, counts = np.unique(np.round(away, 9), return_counts=True)
    return (away < 1e-6).mean(), (counts * (counts - 1)).sum() / (SEEDS * (SEEDS - 1)), len(counts)
