"""Terms: what each part of a move adds to an agent's velocity, in both engines."""

import numpy as np
import pytest

import tiswarm
from tiswarm.records.recording import Recording
from tiswarm.strategies import registry


def assert_sums(recording: Recording) -> None:
    """Check that the terms of every move are its change of velocity, to 1e-12 m/s."""
    for swarm in (recording.prey, recording.predators):
        if not swarm.count:
            continue
        total = sum(swarm.terms.values())
        change = np.diff(swarm.velocity, axis=0)
        moved = np.isfinite(change)
        assert moved.any()
        assert np.abs(total[:-1] - change)[moved].max() <= 1e-12
        for values in swarm.terms.values():
            assert values.shape == swarm.velocity.shape
            assert (np.isfinite(values[:-1]) == moved).all()
            assert np.isnan(values[-1]).all()


# One kernel holds the code of all these.
JOINED = [
    *(
        ("delft/pronav-10", {"prey.strategy": name})
        for name in registry.names("prey")
        if name not in ("swallow", "lookout", "sweeper", "potential")
    ),
    *(("delft/avoidance-10", {"prey.avoidance": name}) for name in registry.names("avoidance")),
    *(("delft/pronav-10", {"predators.strategy": name}) for name in ("centre", "pronav", "cluster")),
]


def _cases() -> list[tuple[str, dict]]:
    worlds = [
        ("m20/hawk", {}),
        ("sanitation/arena", {}),
        ("sanitation/arena-safe", {}),
        ("sanitation/potential", {}),
        ("lookout/aquarium", {}),
    ]
    return [*JOINED, *worlds]


@pytest.mark.parametrize(
    ("preset", "changes"), _cases(), ids=lambda each: each if isinstance(each, str) else "-".join(each.values())
)
def test_terms_add_up_to_every_move(f64, share, preset, changes):
    if (preset, changes) in JOINED:
        share([tiswarm.load(*each) for each in JOINED], terms=True)
    assert_sums(tiswarm.record(tiswarm.load(preset, {**changes, "world.ticks": 60}), trial=1, terms=True))


IN_THE_OPEN = [{"prey.strategy": "explode-evasive"}, {"prey.strategy": "jump", "obstacles.count": 20}]
WALLED = {"world.boundary": "walls", "predators.spawn.region": [[0, 0], [9, 9]], "world.margin": 5, "world.turn_factor": 0.1}


@pytest.mark.parametrize("changes", [*IN_THE_OPEN, WALLED])
def test_large_swarms_have_the_same_terms(f64, share, changes):
    if changes in IN_THE_OPEN:
        share([tiswarm.load("delft/pronav-10", each) for each in IN_THE_OPEN], terms=True)
    scenario = tiswarm.load("delft/pronav-10", {**changes, "world.ticks": 40})
    by_pairs = tiswarm.record(scenario.replaced({"world.neighbours": "all-pairs"}), trial=2, terms=True)
    by_grid = tiswarm.record(scenario.replaced({"world.neighbours": "grid"}), trial=2, terms=True)
    assert_sums(by_grid)
    for kind in ("prey", "predators"):
        one, other = getattr(by_pairs, kind).terms, getattr(by_grid, kind).terms
        assert list(one) == list(other)
        for name, values in one.items():
            assert np.allclose(values, other[name], atol=1e-9, equal_nan=True), (kind, name)


def test_no_bit_of_a_path_depends_on_its_terms(f32):
    scenario = tiswarm.load("delft/pronav-10", {"prey.strategy": "split-evasive", "world.ticks": 80})
    for neighbours in ("all-pairs", "grid"):
        chosen = scenario.replaced({"world.neighbours": neighbours})
        plain, noted = tiswarm.record(chosen), tiswarm.record(chosen, terms=True)
        assert not plain.prey.terms
        assert noted.prey.terms
        for kind in ("prey", "predators"):
            for name in ("position", "velocity", "fate", "state", "group"):
                assert np.array_equal(
                    getattr(getattr(plain, kind), name), getattr(getattr(noted, kind), name), equal_nan=name[-1] in "ny"
                )


def test_terms_are_what_their_names_say(f64):
    scenario = tiswarm.load("delft/pronav-10", {"world.ticks": 30, "prey.perception": 100})
    recording = tiswarm.record(scenario, terms=True)
    prey, own = scenario.prey, recording.prey
    for tick in (0, 10, 25):
        here, rate = own.position[tick], own.velocity[tick]
        assert np.isfinite(here).all()
        away = here[:, None] - here[None]
        close = np.linalg.norm(away, axis=2) <= prey.spacing
        assert np.allclose(own.terms["separation"][tick], prey.separation * (away * close[..., None]).sum(axis=1))
        others = len(here) - 1
        centre = (here.sum(axis=0) - here) / others
        assert np.allclose(own.terms["cohesion"][tick], prey.cohesion * (centre - here))
        mean = (rate.sum(axis=0) - rate) / others
        assert np.allclose(own.terms["alignment"][tick], prey.alignment * (mean - rate))
        assert np.allclose(own.terms["goal"][tick], prey.goal * (np.array(scenario.target.position) - here))


def test_terms_are_saved_with_a_recording(f64, tmp_path):
    recording = tiswarm.record(tiswarm.load("delft/pronav-10", {"world.ticks": 5}), terms=True)
    loaded = tiswarm.Recording.load(recording.save(tmp_path / "trial.npz"))
    assert list(loaded.predators.terms) == list(recording.predators.terms)
    for name, values in recording.prey.terms.items():
        assert np.array_equal(loaded.prey.terms[name], values, equal_nan=True)
