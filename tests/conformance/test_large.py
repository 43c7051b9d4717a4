"""Large swarms against trials of few agents: every strategy, avoidance and kind of world, 50 ticks in double precision."""

import numpy as np
import pytest

import tiswarm
from tiswarm.engine.swarms.simulation import Swarm
from tiswarm.engine.trials.trial import Single
from tiswarm.strategies import registry

TICKS = 50
NEAR = 1e-9  # sums run in another order, and that is all

# potential is chaotic at this dt and has a world of its own below; networks need all pairs
PREY = [name for name in registry.names("prey") if name not in ("potential", "neural")]
AVOIDANCES = ["none", "outward", "spiral", "directed-spiral", "steer-away", "kitchen-sink", "repel", "distance-perception"]
HUNTERS = ["centre", "pronav", "hawk"]
FEW = {"prey.count": 21, "predators.count": 11, "obstacles.count": 9, "world.neighbours": "all-pairs"}
CLOSE = {"predators.spawn.region": [[60, 25], [75, 35]], "prey.perception": 12, "obstacles.region": [[40, 10], [80, 45]]}


def compared(scenario, seed=7, trials=2):
    """Run trials both ways and compare them after every fifth tick; give how many prey were captured and crashed."""
    swarm = Swarm(scenario, seed, trials)
    singles = [Single(scenario, seed, trial) for trial in range(trials)]
    size = np.asarray(scenario.world.size)
    for tick in range(TICKS + 1):
        for trial, single in enumerate(singles):
            if single.ended or tick % 5:
                continue
            for kind in ("prey", "predators"):
                off = swarm.position(kind)[trial] - single.position(kind)
                if scenario.world.boundary == "periodic":
                    off -= size * np.round(off / size)
                rate = swarm.velocity(kind)[trial] - single.velocity(kind)
                gone = np.isnan(single.position(kind)[:, 0])
                assert np.array_equal(np.isnan(off[:, 0]), gone), (tick, kind)
                assert np.abs(off[~gone]).max(initial=0) <= NEAR, (tick, kind)
                assert np.abs(rate[~gone]).max(initial=0) <= NEAR, (tick, kind)
                assert np.array_equal(swarm.fate(kind)[trial], single.fate(kind)), (tick, kind)
        swarm.step()
        for single in singles:
            single.step()
    return swarm.counts[:, 2:].sum(axis=0)


@pytest.fixture
def every_strategy(share):
    base = tiswarm.load("delft/pronav-10", FEW | CLOSE)
    every = [base.replaced({"prey.strategy": name}) for name in PREY]
    every += [base.replaced({"prey.avoidance": name, "predators.avoidance": name}) for name in AVOIDANCES]
    every += [base.replaced({"predators.strategy": name}) for name in HUNTERS]
    share(every)
    return base


def test_every_strategy_and_avoidance(f64, every_strategy):
    ends = np.zeros(2, int)
    for name in PREY:
        ends += compared(every_strategy.replaced({"prey.strategy": name}))
    for n, name in enumerate(AVOIDANCES):
        ends += compared(every_strategy.replaced({"prey.avoidance": name, "predators.strategy": HUNTERS[n % 3]}))
    assert (ends > 0).all(), "nobody was captured, or nobody crashed: then nothing was compared"


# Everybody sees but ahead of them, and heeds the nearest of their mates alone.
PREY_SIGHT = {"prey.field_of_view": 200.0, "prey.nearest": 4}
ALL_SIGHT = PREY_SIGHT | {"predators.field_of_view": 120.0, "predators.nearest": 2}


@pytest.mark.parametrize(
    ("preset", "changes"),
    [
        ("delft/pronav-10", FEW | CLOSE | ALL_SIGHT | {"prey.strategy": "explode-evasive", "predators.strategy": "hawk"}),
        ("m20/hawk", ALL_SIGHT | {"prey.count": 30, "predators.count": 9}),
        ("lookout/aquarium", PREY_SIGHT | {"prey.count": 40, "prey.spawn.region": [[5, 5, 5], [25, 25, 25]]}),
        ("m20/hawk", {"prey.count": 30, "predators.count": 9, "world.contact": "eaten", "prey.radius": 0.3}),
        ("sanitation/potential", {"prey.count": 30}),
        ("sanitation/arena", {}),
        ("lookout/aquarium", {"prey.count": 40, "prey.spawn.region": [[5, 5, 5], [25, 25, 25]], "prey.goal": 0.1}),
    ],
)
def test_other_worlds(preset, changes, f64):
    plain = {"measures.names": [], "coverage.cell": 0}
    compared(tiswarm.load(preset, plain | changes))
