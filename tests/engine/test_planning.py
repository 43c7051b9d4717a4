"""Planned ways: shortest on the grid, round what is blocked, followed as the two rules say, and the same bits everywhere."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra

import tiswarm
from tiswarm.dynamics.specialisation import Specialisation
from tiswarm.dynamics.table import ParameterTable
from tiswarm.engine.trials.kernel import OUTCOMES
from tiswarm.engine.trials.trial import Single
from tiswarm.engine.trials.ways import Ways, planned
from tiswarm.simd import runtime

SMALL = {  # a map of 40 x 24 cells, half of it strewn with obstacles
    "world.size": [40, 24],
    "world.areas": [],
    "world.ticks": 300,
    "target.position": [4.2, 12.7],
    "obstacles.count": 14,
    "obstacles.region": [[8, 0], [30, 24]],
    "prey.spawn.region": [[32, 2], [38, 22]],
}
NONE = np.zeros((0, 2))


def _ways(scenario, trial):
    single = Single(scenario, 0, trial)
    single.step()
    return Ways.of(single), single


def _blocked(ways, obstacles, clearance=1.0):
    """Tell of each cell whether its centre is too near to an obstacle."""
    cells = np.stack(np.meshgrid(*(np.arange(n) for n in ways.step.shape[:2]), indexing="ij"), axis=-1)
    position, radius = obstacles
    away = np.linalg.norm(ways.centre(cells)[:, :, None] - position, axis=3)
    return (away <= radius + clearance).any(axis=2)


def _lengths(blocked, goal):
    """Give the length of the shortest way from each cell by SciPy's Dijkstra [cells], inf where there is none."""
    shape = blocked.shape
    number = np.arange(blocked.size).reshape(shape)
    sides = [(slice(None, -1), slice(1, None)), (slice(None), slice(None)), (slice(1, None), slice(None, -1))]
    rows, columns, lengths = [], [], []
    for across, up in ((1, 0), (0, 1), (1, 1), (1, -1)):
        own, other = zip(sides[0] if across else sides[1], sides[0] if up > 0 else sides[2] if up else sides[1], strict=True)
        free = ~(blocked[own] | blocked[other])
        rows.append(number[own][free])
        columns.append(number[other][free])
        lengths.append(np.full(free.sum(), np.hypot(across, up)))
    graph = coo_array((np.concatenate(lengths), (np.concatenate(rows), np.concatenate(columns))), (blocked.size,) * 2)
    return dijkstra(graph.tocsr(), directed=False, indices=number[tuple(goal)]).reshape(shape)


def test_on_a_thousand_maps_every_cell_leads_along_a_shortest_way(f32):
    scenario = tiswarm.load("delft/planned-10", SMALL)
    closed = 0
    for trial in range(1000):
        ways, single = _ways(scenario, trial)
        goal = ways.cell(scenario.target.position)
        blocked = _blocked(ways, single.obstacles())
        barred = blocked.copy()
        barred[tuple(goal)] = False
        lengths = _lengths(barred, goal)
        moves = ways.step.any(axis=2)
        reached = np.isfinite(lengths) & ~blocked
        reached[tuple(goal)] = False
        assert moves[reached].all()
        cells = np.argwhere(reached)
        after = cells + ways.step[reached]
        step = np.hypot(*ways.step[reached].T)
        np.testing.assert_allclose(lengths[reached], step + lengths[after[:, 0], after[:, 1]], atol=1e-9)
        assert not moves[np.isinf(lengths) & ~blocked].any()  # no way there: none is told
        closed += int((np.isinf(lengths) & ~blocked).any())
    assert closed > 20


def test_planned_ways_never_cross_a_blocked_cell_and_lead_out_of_one(f32):
    scenario = tiswarm.load("delft/planned-30")
    for trial in range(5):
        ways, single = _ways(scenario, trial)
        blocked = _blocked(ways, single.obstacles())
        for place in single.start:
            chain = ways.chain(place)
            assert (chain[-1] == ways.cell(scenario.target.position)).all()
            assert not blocked[tuple(chain[1:].T)].any()
        inside = np.argwhere(blocked)
        assert len(inside)
        for cell in inside[::7]:
            within = blocked[tuple(ways.chain(ways.centre(cell)).T)]
            assert not within[within.argmin() :].any()  # once out, never in again


def _told(recording):
    """Give the pulls of a recording's goal in units of prey.goal: [tick, agent, 2]."""
    return recording.prey.terms["goal"][:-1] / recording.scenario.prey.goal


def _unit(way):
    return way / np.linalg.norm(way, axis=-1, keepdims=True)


@pytest.mark.parametrize("trial", [0, 3])
def test_by_the_field_prey_aim_at_the_centre_of_the_next_cell(f64, trial):
    scenario = tiswarm.load("delft/planned-10", SMALL)
    recording, (ways, _) = tiswarm.record(scenario, trial, terms=True), _ways(scenario, trial)
    place = recording.prey.position[:-1]
    here = np.isfinite(_told(recording)[..., 0])
    cell = ways.cell(np.nan_to_num(place))
    step = ways.step[cell[..., 0], cell[..., 1]]
    assert step[here].any(axis=1).all()  # they arrive before the target's cell
    np.testing.assert_allclose(_told(recording)[here], _unit(ways.centre(cell + step) - place)[here], atol=1e-9)


@pytest.mark.parametrize("trial", [0, 3])
def test_by_its_list_each_prey_aims_behind_the_nearest_point_of_it_the_last_excluded(f64, trial):
    scenario = tiswarm.load("delft/planned-list", {**SMALL, "prey.goal": 0.5})
    recording, (ways, _) = tiswarm.record(scenario, trial, terms=True), _ways(scenario, trial)
    for agent, start in enumerate(recording.prey.position[0]):
        points = ways.centre(ways.chain(start))
        for tick, place in enumerate(recording.prey.position[:-1, agent]):
            if np.isfinite(_told(recording)[tick, agent, 0]):
                nearest = np.linalg.norm(points[:-1] - place, axis=1).argmin()
                np.testing.assert_allclose(_told(recording)[tick, agent], _unit(points[nearest + 1] - place), atol=1e-9)


@pytest.mark.parametrize("plan", ["field", "list"])
def test_a_start_that_is_closed_in_goes_straight_and_the_recording_says_so(f32, plan, tmp_path):
    ring = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    wall = np.array([30, 12]) + 5 * np.stack([np.cos(ring), np.sin(ring)], axis=1)
    start = tiswarm.Start(np.array([[30.2, 12.1], [37.0, 5.0]]), np.zeros((2, 2)), NONE, NONE, wall, np.full(16, 0.4))
    changes = {**SMALL, "planning.plan": plan, "prey.avoidance": "none", "prey.goal": 0.5, "prey.cohesion": 0, "world.ticks": 2}
    recording = tiswarm.record(tiswarm.load("delft/planned-10", changes), start=start)
    lone, free = recording.prey.velocity[1]
    np.testing.assert_allclose(_unit(lone), _unit(np.array(SMALL["target.position"]) - start.prey_position[0]), atol=1e-5)
    assert np.linalg.norm(free) > 0
    assert recording.notes == ("prey 1 found no way to the target and went straight: obstacles close its start in",)
    assert tiswarm.Recording.load(recording.save(tmp_path / "trial.npz")).notes == recording.notes


@pytest.mark.parametrize("plan", ["field", "list"])
@pytest.mark.anew
def test_planned_trials_have_the_same_bits_in_any_batch_and_at_any_number_of_threads(plan):
    scenario = tiswarm.load("delft/planned-10", {**SMALL, "planning.plan": plan})
    tiswarm.init("f32", 1)
    whole = tiswarm.simulate(scenario, 60, seed=3)
    for threads, count in ((3, 41),):
        tiswarm.init("f32", threads)
        other = tiswarm.simulate(scenario, count, seed=3)
        for name in OUTCOMES:
            np.testing.assert_array_equal(getattr(other, name), getattr(whole, name)[:count])
    for trial in (0, 5, 59):
        alone = tiswarm.record(scenario, trial, seed=3)
        assert alone.ticks == whole.ticks[trial]
        assert (alone.prey.fate == "arrived").sum() == whole.arrived[trial]
    tiswarm.init("f32")


def test_clearance_may_differ_from_trial_to_trial_and_the_size_of_cells_may_not(f32):
    scenario = tiswarm.load("delft/planned-10", SMALL)
    clearance = np.array([0.5, 1.0, 2.0, 1.0])
    mixed = tiswarm.simulate(scenario, 4, weights={"planning.clearance": clearance})
    for trial, own in enumerate(clearance):
        alone = tiswarm.record(scenario.replaced({"planning.clearance": own}), trial)
        assert alone.ticks == mixed.ticks[trial]
    with pytest.raises(tiswarm.ScenarioError, match="same for all trials"):
        tiswarm.simulate(scenario, 4, weights={"planning.cell": np.ones(4)})


def test_planning_beats_the_straight_line_and_cures_deadlocks_between_obstacles(f32):
    by_line = tiswarm.load("delft/planned-30", {"prey.goal_by": "line", "prey.goal": 0.1})
    measured = {"measures.names": ["trapped"]}
    line, path = (tiswarm.simulate(each.replaced(measured), 100) for each in (by_line, tiswarm.load("delft/planned-30")))
    assert line.success.mean() < 0.8
    assert path.success.mean() > 0.99
    assert line.measures["trapped"].mean() > 0.05
    assert path.measures["trapped"].mean() < 0.005


def test_an_overlay_shows_the_field_of_ways_or_the_lists(f32):
    scenario = tiswarm.load("delft/planned-10", SMALL)
    points, arrows = planned(tiswarm.record(scenario.replaced({"world.ticks": 2})))
    assert len(points) == 40 * 24
    np.testing.assert_allclose(np.linalg.norm(arrows, axis=1)[np.abs(arrows).sum(axis=1) > 0], 1)
    listed = tiswarm.record(scenario.replaced({"world.ticks": 2, "planning.plan": "list"}))
    points, arrows = planned(listed)
    assert len(points) < 6 * 64
    assert (np.linalg.norm(points[0] - listed.prey.position[0, 0]) < 1).all()
    with pytest.raises(ValueError, match="goal_by"):
        planned(tiswarm.record(scenario.replaced({"world.ticks": 2, "prey.goal_by": "line"})))


def test_a_plan_does_not_change_under_way(f32):
    simulation = tiswarm.Simulation(tiswarm.load("delft/planned-10", SMALL))
    simulation.step(2)
    for key in ("target.position", "planning.clearance"):
        with pytest.raises(tiswarm.ScenarioError, match="acts at the start only"):
            simulation.set({key: [9, 9] if "position" in key else 2.0})
    simulation.set({"prey.goal": 1.0})


@pytest.mark.quick
@pytest.mark.parametrize(
    ("overrides", "parts"),
    [
        ({"target.present": False}, ("prey.goal_by", "'path'", "target.present")),
        ({"world.boundary": "periodic"}, ("prey.goal_by", "'open' or 'walls'", "'periodic'", "'line'")),
        ({"world.boundary": "disc", "target.position": [40, 25]}, ("prey.goal_by", "'open' or 'walls'", "'disc'")),
        ({"planning.cell": 0.01}, ("planning.cell", "cells", "larger")),
        ({"planning.plan": "map"}, ("planning.plan", "'map'", "'field' or 'list'")),
        ({"planning.cell": 0}, ("planning.cell",)),
        ({"prey.goal_by": "star"}, ("prey.goal_by", "'star'", "'line' or 'path'")),
    ],
)
def test_what_cannot_be_planned_gets_one_line(overrides, parts):
    with pytest.raises(tiswarm.ScenarioError) as caught:
        tiswarm.load("delft/planned-10", {"prey.spawn.region": [[60, 20], [65, 25]], **overrides})
    message = str(caught.value)
    assert "\n" not in message
    for part in parts:
        assert part in message


@pytest.mark.quick
def test_large_swarms_say_that_they_cannot_plan():
    with pytest.raises(tiswarm.ScenarioError, match=r"prey.goal_by.*'path'.*all-pairs"):
        tiswarm.Simulation(tiswarm.load("delft/planned-10", {"world.neighbours": "grid"}))


def test_who_does_not_plan_has_the_kernel_without_it(f32):
    plain = Specialisation.of([tiswarm.load("delft/avoidance-10")], 0)
    layout = ParameterTable(plain, runtime.types().lanes)
    assert layout.board == SimpleNamespace(fixed=0, each=0)
    assert not [path for path in layout.paths if path.startswith("planning.")]
