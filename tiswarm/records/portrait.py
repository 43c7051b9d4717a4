"""Portrait: a recording as a notebook shows it: all ways on the ground, and what became of whom."""

import numpy as np

from tiswarm.records.recording import FATES, Recording, Swarm
from tiswarm.scenario import picture
from tiswarm.system import card

MOST_AGENTS = 100
MOST_POINTS = 120
"""Ways that are drawn, and points of one: a notebook keeps what it shows."""


def portrait(recording: Recording) -> str:
    """Show a recording."""
    shapes = picture.ground(recording.scenario)
    for place, radius in zip(recording.obstacle_position, recording.obstacle_radius, strict=True):
        shapes.append(card.disc(place, radius, picture.OBSTACLES, 0.5))
    both = ((recording.predators, picture.PREDATORS), (recording.prey, picture.PREY))
    shapes += [way for swarm, hue in both for way in _ways(recording, swarm, hue)]
    places = np.concatenate([swarm.position[swarm.alive] for swarm, _ in both])
    corners = [(places.min(axis=0), places.max(axis=0))] if len(places) else []
    rows = [
        [kind, swarm.count, *(int((swarm.fate == fate).sum()) for fate in FATES)]
        for kind, swarm in (("prey", recording.prey), ("predators", recording.predators))
        if swarm.count
    ]
    told = f"{recording.scenario.title}: trial {recording.trial}, seed {recording.seed}, {recording.ticks:,} ticks"
    drawn = card.drawing(*picture.frame(recording.scenario, corners), shapes)
    return card.card(told, drawn, card.table(rows, ("", "agents", *FATES)))


def _ways(recording: Recording, swarm: Swarm, hue: str) -> list[str]:
    """Draw the ways of agents, cut where they cross a periodic edge, and a dot where each is last."""
    found = []
    for agent in range(min(swarm.count, MOST_AGENTS)):
        there = np.flatnonzero(swarm.alive[:, agent])
        if not len(there):
            continue
        path = swarm.position[there, agent]
        jumps = np.abs(np.diff(path, axis=0) - recording.shortest(np.diff(path, axis=0))).max(axis=1, initial=0) > 1e-9
        for piece in np.split(path, np.flatnonzero(jumps) + 1):
            found.append(card.line(piece[:: -(-len(piece) // MOST_POINTS)], hue))
        found.append(card.disc(path[-1], max(0.006 * max(recording.scenario.world.size), 1e-9), hue))
    return found
