"""Picture: a scenario as a notebook shows it: its world with target and places of start, and what it is made of."""

from collections.abc import Sequence
from typing import Any

from tiswarm.system import card

PREY, PREDATORS, TARGET, OBSTACLES = "#1f7fc4", "#d1495b", "#2a9d6f", "#8a8a8a"


def card_of(scenario: Any) -> str:
    """Show a scenario."""
    world, prey, predators, obstacles = scenario.world, scenario.prey, scenario.predators, scenario.obstacles
    rows: list[tuple[str, Any]] = [
        ("preset", scenario.preset or "–"),
        ("world", f"{' × '.join(f'{side:g}' for side in world.size)} m, {world.boundary}"),
        ("time", f"{world.ticks:,} ticks of {world.dt:g} s"),
        ("prey", _agents(prey)),
        ("predators", _agents(predators) if predators.count else "none"),
        ("obstacles", f"{obstacles.count} of {_range(obstacles.radius)} m" if obstacles.count else "none"),
    ]
    return card.card(scenario.title, drawing_of(scenario), card.table(rows))


def drawing_of(scenario: Any) -> str:
    """Draw a scenario's world: where obstacles lie and agents start, and the target."""
    prey, predators = scenario.prey, scenario.predators
    shapes = ground(scenario)
    if scenario.obstacles.count:
        shapes.append(card.box(scenario.obstacles.region.low, scenario.obstacles.region.high, OBSTACLES, 0.08))
    starts = [(prey.spawn.region, PREY)] + ([(predators.spawn.region, PREDATORS)] if predators.count else [])
    shapes += [card.box(region.low, region.high, hue) for region, hue in starts]
    corners = [(region.low, region.high) for region, _ in starts]
    return card.drawing(*frame(scenario, corners), shapes)


def ground(scenario: Any) -> list[str]:
    """Draw what stands in a world: its edge, and the target."""
    shapes = [card.box((0, 0), scenario.world.size, OBSTACLES, 0.03)]
    if scenario.target.present:
        shapes.append(card.disc(scenario.target.position, scenario.target.radius, TARGET, 0.35))
    return shapes


def frame(scenario: Any, corners: Sequence[tuple[Sequence[float], Sequence[float]]]) -> tuple[list[float], list[float]]:
    """Give the lower and the upper corner of what is drawn: the world and further boxes, with some air around."""
    lows, highs = [(0.0, 0.0)], [tuple(scenario.world.size[:2])]
    for low, high in corners:
        lows.append((low[0], low[1]))
        highs.append((high[0], high[1]))
    low = [min(each[k] for each in lows) for k in (0, 1)]
    high = [max(each[k] for each in highs) for k in (0, 1)]
    air = 0.03 * max(high[0] - low[0], high[1] - low[1])
    return [each - air for each in low], [each + air for each in high]


def _agents(agents: Any) -> str:
    return f"{agents.count:,} {agents.strategy}" + (f", avoidance {agents.avoidance}" if agents.avoidance != "none" else "")


def _range(ends: tuple[float, float]) -> str:
    return f"{ends[0]:g}" if ends[0] == ends[1] else f"{ends[0]:g} to {ends[1]:g}"
