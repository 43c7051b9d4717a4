"""Single trials recorded from the thesis author's simulator in float64 (golden/, named by study, algorithm and seed)."""

from pathlib import Path

import numpy as np
import pytest

import tiswarm
from tiswarm.engine.trials.trial import Single

GOLDEN = Path(__file__).parent / "golden"
FILES = sorted(GOLDEN.glob("*.npz"))
FREE_TICKS = 80
"""A free run is chaotic: rounding grows to metres after some hundred ticks, though no rule differs."""

STUDIES = {
    "obstacle_avoidance_10": "delft/avoidance-10",
    "obstacle_avoidance_30": "delft/avoidance-30",
    "predator_avoidance_against_center_steering": "delft/centre-0",
    "predator_avoidance_against_center_steering_obstacles": "delft/centre-10",
    "predator_avoidance_against_png": "delft/pronav-0",
    "predator_avoidance_against_png_obstacles": "delft/pronav-10",
}
AVOIDANCES = {
    "baseline": "none",
    "outwards_field": "outward",
    "spiral_field": "spiral",
    "directed_spiral_field": "directed-spiral",
    "steer_away": "steer-away",
    "kitchensink": "kitchen-sink",
}
KINDS = {"prey": "prey", "predator": "predators"}


def _single(file: Path) -> tuple[Single, dict[str, np.ndarray]]:
    study, algorithm, _ = file.stem.split("__")
    golden = dict(np.load(file))
    about_avoidance = study.startswith("obstacle")
    key, value = (
        ("prey.avoidance", AVOIDANCES[algorithm]) if about_avoidance else ("prey.strategy", algorithm.replace("_", "-"))
    )
    start = tiswarm.Start(
        golden["prey_position"][0],
        golden["prey_velocity"][0],
        golden["predator_position"][0],
        golden["predator_velocity"][0],
        golden["obstacle_position"],
        golden["obstacle_radius"],
    )
    return Single(tiswarm.load(STUDIES[study], {key: value}), 0, 0, start), golden


def _largest_difference(ours: np.ndarray, theirs: np.ndarray) -> float:
    """Give the largest distance, once both agree on who is gone."""
    np.testing.assert_array_equal(np.isnan(ours), np.isnan(theirs))
    return float(np.nanmax(np.abs(ours - theirs), initial=0.0))


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_each_recorded_state_advances_by_one_tick_as_recorded(file, f64):
    single, golden = _single(file)
    for tick in range(int(golden["ticks"])):
        for name, kind in KINDS.items():
            single.place(kind, golden[f"{name}_position"][tick], golden[f"{name}_velocity"][tick])
        single.step()
        for name, kind in KINDS.items():
            for what in ("position", "velocity"):
                ours, theirs = getattr(single, what)(kind), golden[f"{name}_{what}"][tick + 1]
                assert _largest_difference(ours, theirs) < 1e-10, f"{kind} {what} after tick {tick}"
        assert (single.fate("prey") == "arrived").sum() == golden["reached"][tick + 1]
    assert single.ended
    assert single.age == golden["ticks"]


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_a_free_run_agrees_for_the_first_80_ticks(file, f64):
    single, golden = _single(file)
    for tick in range(min(FREE_TICKS, int(golden["ticks"]))):
        single.step()
        for name, kind in KINDS.items():
            assert _largest_difference(single.position(kind), golden[f"{name}_position"][tick + 1]) < 1e-6, (
                f"{kind} after tick {tick}"
            )


def test_the_golden_files_are_all_there():
    assert len(FILES) == 36
