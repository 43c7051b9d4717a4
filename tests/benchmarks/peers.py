"""The community's flocking benchmark on this machine in one run: tiswarm, Numba, SciPy with NumPy, and Mesa.

Usage: pip install -e ".[peers]"; python tests/benchmarks/peers.py         (five minutes; writes out/benchmarks/peers.csv)

"small": 200 birds, 100 × 100 m, periodic, sight 5 m; "large": 400 birds, 150 × 150 m, sight 15 m; and swarms of 12.6
neighbours. Speed 1, cohesion 0.03, separation 0.015 below 1 m, matching 0.05. tiswarm, Numba and SciPy compute the same move,
checked against all pairs first. Mesa's own model moves one bird after another, each of which sees those that have moved
already, and holds all speeds at 1; the others move all at once and cap speeds. Best of several runs, steps after warming up.
"""

import csv
import importlib.util
import math
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numba
import numpy as np
from scipy.spatial import cKDTree

import tiswarm
from tiswarm.engine.swarms.simulation import Swarm
from tiswarm.scenario.model import validated
from tiswarm.system.machine import machine

OUT = Path("out/benchmarks/peers.csv")
COHESION, SEPARATION, MATCHING, SPACING, SPEED = 0.03, 0.015, 0.05, 1.0, 1.0
CASES = {"small": (200, 100.0, 5.0), "large": (400, 150.0, 15.0)} | {
    f"{count:,}": (count, math.sqrt(count * math.pi * 25 / 12.6), 5.0) for count in (10_000, 100_000, 1_000_000)
}
SECONDS = 5.0
MESA_MOST = 400
"""Mesa compares each bird with all others: 10⁴ birds take minutes a step."""

Move = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


def start(count: int, side: float) -> tuple[np.ndarray, np.ndarray]:
    """Spread birds evenly, heading anywhere."""
    rng = np.random.default_rng(0)
    angle = rng.uniform(0, 2 * math.pi, count)
    return rng.random((count, 2)) * side, np.stack([np.cos(angle), np.sin(angle)], axis=1)


def steered(sums: np.ndarray, position: np.ndarray, velocity: np.ndarray, side: float) -> tuple[np.ndarray, np.ndarray]:
    """Make the move from each bird's sums over its neighbours: n, Σ away, Σ velocity, Σ away of the close, [7, bird]."""
    share = 1.0 / np.maximum(sums[0], 1.0)
    lone = sums[0] < 0.5
    course = np.empty_like(velocity)
    for k in range(2):
        pull = SEPARATION * sums[5 + k] - COHESION * (share * sums[1 + k] + lone * position[:, k])
        course[:, k] = velocity[:, k] + pull + MATCHING * (share * sums[3 + k] - velocity[:, k])
    course *= (SPEED / np.maximum(np.hypot(course[:, 0], course[:, 1]), SPEED))[:, None]
    return (position + course) % side, course


def by_pairs(side: float, sight: float) -> Move:
    """Compare all pairs: the yardstick."""

    def move(position: np.ndarray, velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        away = position[:, None] - position[None]
        away -= side * np.round(away / side)
        distance = np.hypot(away[..., 0], away[..., 1])
        near = (distance <= sight) & ~np.eye(len(position), dtype=bool)
        close = near & (distance <= SPACING)
        total = [near.sum(1), *np.einsum("ij,ijk->ki", near, away), *(near @ velocity).T, *np.einsum("ij,ijk->ki", close, away)]
        return steered(np.array(total, np.float64), position, velocity, side)

    return move


def by_tree(side: float, sight: float) -> Move:
    """Find pairs in a k-d tree and sum them up by bincount, each pair once for both birds."""

    def move(position: np.ndarray, velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        count = len(position)
        pairs = cKDTree(position, boxsize=side).query_pairs(sight, output_type="ndarray")
        i, j = pairs[:, 0], pairs[:, 1]
        away = position[i] - position[j]
        away -= side * np.round(away / side)
        close = (away**2).sum(1) <= SPACING**2
        sums = [np.bincount(i, minlength=count) + np.bincount(j, minlength=count)]
        sums += [np.bincount(i, each, count) - np.bincount(j, each, count) for each in away.T]
        sums += [np.bincount(i, v[j], count) + np.bincount(j, v[i], count) for v in velocity.T]
        sums += [np.bincount(i[close], each, count) - np.bincount(j[close], each, count) for each in away[close].T]
        return steered(np.array(sums), position, velocity, side)

    return move


@numba.njit(fastmath=True, inline="always")
def _met(birds, begin, row, column, x, y, side, sight2, close2, cells):
    """Sum up over all birds in reach of a place, the one there included: n, Σ away, Σ velocity, Σ away of the close."""
    one, zero = np.float32(1.0), np.float32(0.0)
    n = ax = ay = ux = uy = sx = sy = zero
    for up in range(-1, 2):
        other = (row + up) % cells
        dy = np.float32(side) * np.float32((row + up) // cells)
        for part in range(3):
            low, high, dx = max(column - 1, 0), min(column + 1, cells - 1), zero
            if part == 0:
                if column > 0:
                    continue
                low, high, dx = cells - 1, cells - 1, -np.float32(side)
            elif part == 2:
                if column < cells - 1:
                    continue
                low, high, dx = 0, 0, np.float32(side)
            for j in range(begin[other * cells + low], begin[other * cells + high + 1]):
                away_x, away_y = x - birds[j, 0] - dx, y - birds[j, 1] - dy
                distance2 = away_x * away_x + away_y * away_y
                near = one if distance2 <= sight2 else zero
                close = one if distance2 <= close2 else zero
                n += near
                ax += near * away_x
                ay += near * away_y
                ux += near * birds[j, 2]
                uy += near * birds[j, 3]
                sx += close * away_x
                sy += close * away_y
    return n, ax, ay, ux, uy, sx, sy


@numba.njit(parallel=True, fastmath=True)
def _cell_move(p, v, side, sight, cells):
    """Move birds through a cell list: counting sort, copies in cell order, rows of cells as ranges, threads over rows."""
    count = len(p)
    scale = np.float32(cells / side)
    cell = np.empty(count, np.int32)
    for i in numba.prange(count):
        cell[i] = min(int(p[i, 1] * scale), cells - 1) * cells + min(int(p[i, 0] * scale), cells - 1)
    begin = np.zeros(cells * cells + 1, np.int32)
    for i in range(count):
        begin[cell[i] + 1] += 1
    begin = np.cumsum(begin).astype(np.int32)
    place = begin[:-1].copy()
    birds = np.empty((count, 4), np.float32)
    for i in range(count):
        to = place[cell[i]]
        place[cell[i]] = to + 1
        birds[to, 0], birds[to, 1], birds[to, 2], birds[to, 3] = p[i, 0], p[i, 1], v[i, 0], v[i, 1]
    new_p, new_v = np.empty_like(p), np.empty_like(v)
    sight2, close2 = np.float32(sight * sight), np.float32(SPACING * SPACING)
    one, zero = np.float32(1.0), np.float32(0.0)
    for row in numba.prange(cells):
        for column in range(cells):
            for i in range(begin[row * cells + column], begin[row * cells + column + 1]):
                x, y, vx, vy = birds[i, 0], birds[i, 1], birds[i, 2], birds[i, 3]
                n, ax, ay, ux, uy, sx, sy = _met(birds, begin, row, column, x, y, side, sight2, close2, cells)
                n, ux, uy = n - one, ux - vx, uy - vy
                share = one / max(n, one)
                lone = one if n < 0.5 else zero
                course_x = vx + SEPARATION * sx - COHESION * (share * ax + lone * x) + MATCHING * (share * ux - vx)
                course_y = vy + SEPARATION * sy - COHESION * (share * ay + lone * y) + MATCHING * (share * uy - vy)
                factor = SPEED / max(math.sqrt(course_x * course_x + course_y * course_y), SPEED)
                new_v[i, 0], new_v[i, 1] = course_x * factor, course_y * factor
                new_p[i, 0] = (x + new_v[i, 0]) % side
                new_p[i, 1] = (y + new_v[i, 1]) % side
    return new_p, new_v


def by_cells(side: float, sight: float) -> Move:
    """Use the Numba cell list. Birds stay in cell order, which is good for its caches."""
    cells = int(side / sight)
    return lambda p, v: _cell_move(np.asarray(p, np.float32), np.asarray(v, np.float32), side, sight, cells)


def swarm_of(count: int, side: float, sight: float) -> Swarm:
    """Give the same birds as one of our scenarios."""
    prey = {"perception": sight, "spacing": SPACING, "max_speed": SPEED}
    prey |= {"cohesion": COHESION, "separation": SEPARATION, "alignment": MATCHING}
    prey["spawn"] = {"region": [[0.0, 0.0], [side, side]]}
    world = {"size": [side, side], "boundary": "periodic", "contact": "none"}
    position, velocity = start(count, side)
    scenario = validated({"world": world, "target": {"present": False}, "prey": prey})
    return Swarm(scenario, start=(position[None], velocity[None]))


def mesa_step(count: int, side: float, sight: float) -> Callable[[], None] | None:
    """Give a step of Mesa's own flocking model, None without Mesa or with too many birds for it."""
    if count > MESA_MOST or importlib.util.find_spec("mesa") is None:
        return None
    from mesa.examples import BoidFlockers

    numbers = {"population_size": count, "width": side, "height": side, "speed": SPEED, "vision": sight}
    numbers |= {"separation": SPACING, "cohere": COHESION, "separate": SEPARATION, "match": MATCHING}
    try:
        model = BoidFlockers(**numbers)
    except TypeError:  # newer versions keep numbers in a scenario
        from mesa.examples.basic.boid_flockers.model import BoidsScenario

        model = BoidFlockers(scenario=BoidsScenario(**numbers))
    return model.step


def check() -> None:
    """Hold every version to the move that comparing all pairs gives; birds of a version may come in another order."""
    count, side, sight = CASES["large"]
    position, velocity = start(count, side)
    expected = by_pairs(side, sight)(position, velocity)[0]
    swarm = swarm_of(count, side, sight)
    swarm.step()
    places = {
        "tiswarm": swarm.position()[0],
        "SciPy": by_tree(side, sight)(position, velocity)[0],
        "Numba": by_cells(side, sight)(position, velocity)[0],
    }
    for name, found in places.items():
        worst = cKDTree(expected % side, boxsize=side).query(np.asarray(found, np.float64) % side)[0].max()
        assert worst < 1e-3, f"{name}: off by {worst} m"


def best_step(step: Callable[[], None], steps: int = 1) -> float:
    """Give the shortest time of many calls [s], each of which does so many steps, by the step."""
    step()
    best, ends, done = math.inf, time.perf_counter() + SECONDS, 0
    while time.perf_counter() < ends or done < 3:
        begun = time.perf_counter()
        step()
        best, done = min(best, time.perf_counter() - begun), done + 1
    return best / steps


def stepping(move: Move, count: int, side: float) -> Callable[[], None]:
    """Keep a state and move it."""
    state = [start(count, side)]

    def step() -> None:
        state[0] = move(*state[0])

    return step


def main() -> None:
    """Check, measure, print, write."""
    tiswarm.init("f32")
    check()
    rows = []
    for name, (count, side, sight) in CASES.items():
        steps = {
            "Numba cell list": stepping(by_cells(side, sight), count, side),
            "SciPy cKDTree": stepping(by_tree(side, sight), count, side),
            "Mesa": mesa_step(count, side, sight),
        }
        swarm, at_once = swarm_of(count, side, sight), max(1, 100_000 // count)
        times = {"tiswarm": best_step(partial(swarm.step, at_once), at_once)}
        times |= {peer: best_step(step) for peer, step in steps.items() if step is not None}
        for peer, seconds in times.items():
            rows.append((name, count, peer, round(seconds * 100, 5), round(seconds / times["tiswarm"], 1)))
            print(
                f"{name:>9}  {peer:16} 100 steps in {seconds * 100:9.4f} s  {seconds / times['tiswarm']:8.1f} × tiswarm",
                flush=True,
            )
    OUT.parent.mkdir(parents=True, exist_ok=True)
    with OUT.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["case", "birds", "peer", "100 steps [s]", "time / tiswarm's", "machine"])
        writer.writerows([*row, machine()] for row in rows)


if __name__ == "__main__":
    main()
