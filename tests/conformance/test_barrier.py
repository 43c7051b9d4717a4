"""What must hold of barrier certificates: against SciPy, at all times, and where they have nothing to say."""

import numpy as np
import pytest
from scipy.optimize import nnls

import tiswarm
from tiswarm.dynamics.specialisation import Specialisation
from tiswarm.dynamics.table import ParameterTable
from tiswarm.engine.trials import joint_solution
from tiswarm.engine.trials.session import Session
from tiswarm.measures import recorded
from tiswarm.simd import runtime

RADIUS, GAIN, DT = 0.15, 100.0, 0.033
FORMS = ("joint", "shared")
# Robots who do what their velocity says, on points instead of wheels.
FREE = {f"prey.{name}": 0 for name in ("cohesion", "alignment", "separation", "min_speed")}
POINTS = {
    **FREE,
    "world.turn_factor": 0,
    "prey.drive": "point",
    "measures.names": ["least-distance", "stalled"],
    "coverage.cell": 0,
}
# All of them to one point, as fast as they may.
CROWDING = {**POINTS, "prey.strategy": "baseline", "prey.cohesion": 30, "prey.perception": 10, "world.ticks": 500}
SIDE = 1.4


def _safe(form, changes):
    return tiswarm.load("sanitation/arena-safe", {"barrier.form": form, **changes})


def _corrected(form, count, places, **changes):
    """Draw states of so many robots, and give places, commands and corrected velocities: [state, robot, dim]."""
    here = {
        "world.size": [SIDE, SIDE],
        "prey.spawn.region": [[0.08, 0.08], [SIDE - 0.08, SIDE - 0.08]],
        "prey.spawn.apart": 0.151,
    }
    session = Session(_safe(form, {**POINTS, **here, "prey.count": count, **changes}), places, {})
    session.begin(np.arange(places), np.arange(places), seed=count)
    rows = session.blocks.layout.rows
    place, command = session.rows("prey", rows.place), session.rows("prey", rows.motion)
    session.step()
    return place, command, session.rows("prey", rows.motion)


def _pairs(place, half=1.0):
    """Give A and b of A u <= b over all pairs: [pair, robot, dim], and of all walls: [wall, robot, dim]."""
    count = len(place)
    rows, bounds = [], []
    for i in range(count):
        for j in range(i):
            away = place[i] - place[j]
            off = away @ away - RADIUS**2
            row = np.zeros((count, 2))
            row[i], row[j] = -2 * away, 2 * away
            rows.append(row)
            bounds.append(half * GAIN * off**3)
        for axis in range(2):
            for side in (-1, 1):
                row = np.zeros((count, 2))
                row[i, axis] = side
                rows.append(row)
                bounds.append(0.4 * GAIN * ((place[i, axis] if side < 0 else SIDE - place[i, axis]) - RADIUS / 2) ** 3)
    return np.array(rows).reshape(len(rows), -1), np.array(bounds)


@pytest.mark.parametrize("counts", [range(2, 9), range(9, 15), range(15, 21)], ids=str)
def test_joint_commands_are_those_next_to_the_given_ones(counts, f64):
    """Ten thousand states: no bound is exceeded by 1e-7, and forces that SciPy finds prove the objective."""
    seen = 0
    for count in counts:
        states = _corrected("joint", count, 527)
        for place, command, velocity in zip(*states, strict=True):
            rows, bounds = _pairs(place)
            slack = bounds - rows @ velocity.ravel()
            assert slack.min() > -1e-7
            change = command.ravel() - velocity.ravel()
            objective = change @ change
            if objective < 1e-18:
                continue
            near = slack < 1e-7
            forces, _ = nnls(rows[near].T, change)
            push = rows[near].T @ forces
            least = 2 * forces @ (rows[near] @ command.ravel() - bounds[near]) - push @ push  # of the objective: weak duality
            assert objective <= least * (1 + 1e-6) + 1e-16
            seen += 1
    assert seen > 100 * len(counts)


def test_shared_commands_are_those_next_to_the_given_ones(f64):
    """Each robot's own program, solved by trying all corners of its bounds."""
    for count in (2, 7, 20):
        for place, command, velocity in zip(*_corrected("shared", count, 60), strict=True):
            rows, bounds = _pairs(place, half=0.5)
            rows = rows.reshape(len(rows), count, 2)
            for i in range(count):
                own = np.abs(rows[:, i]).sum(axis=1) > 0
                lines, most = rows[own, i], bounds[own]
                assert (lines @ velocity[i] - most).max() < 1e-10
                alone = command[i] - ((lines @ command[i] - most) / (lines**2).sum(axis=1))[:, None] * lines
                first, second = np.triu_indices(len(lines), 1)
                both = np.stack([lines[first], lines[second]], axis=1)
                meets = np.abs(np.linalg.det(both)) > 1e-9
                corners = np.linalg.solve(both[meets], np.stack([most[first], most[second]], axis=1)[meets][..., None])[..., 0]
                tried = np.concatenate([[command[i]], alone, corners])
                tried = tried[(tried @ lines.T - most).max(axis=1) < 1e-10]
                best = np.linalg.norm(tried - command[i], axis=1).min()
                assert np.linalg.norm(velocity[i] - command[i]) == pytest.approx(best, abs=1e-9)


@pytest.mark.parametrize("form", FORMS)
def test_nobody_ever_comes_nearer_than_the_radius(form, f32):
    """Ticks of 2 to 20 robots who all press to one point; a million of them: `tests/benchmarks/barrier.py million`."""
    count = np.resize(np.arange(2, 21), 76)
    results = tiswarm.simulate(_safe(form, CROWDING), 76, weights={"prey.count": count})
    assert (results.ticks == 500).all()
    assert results.measures["least-distance"].min() > RADIUS - 1e-6
    assert results.measures["least-distance"].max() < RADIUS + 0.1


@pytest.mark.parametrize("form", FORMS)
def test_a_coarse_tick_is_as_safe_as_a_fine_one(form, f32):
    """Ticks of a second and a gain of a million: a bound in continuous time alone lets robots jump past each other."""
    coarse = {"world.dt": 1.0, "barrier.gain": 1e6, "world.ticks": 60, "prey.max_speed": 0.5}
    results = tiswarm.simulate(_safe(form, CROWDING | coarse), 24)
    assert results.measures["least-distance"].min() > RADIUS - 1e-6


@pytest.mark.parametrize("form", FORMS)
def test_robots_keep_half_the_radius_from_walls(form, f32):
    home = {"prey.strategy": "baseline", "target.present": True, "target.position": [9.0, -5.0], "prey.goal": 30}
    path = tiswarm.record(_safe(form, {**POINTS, **home, "world.ticks": 1500}))
    assert path.prey.position[:, :, 0].max() < 3.2 - RADIUS / 2 + 1e-6
    assert path.prey.position[:, :, 1].min() > RADIUS / 2 - 1e-6
    assert path.prey.position[-1, :, 0].mean() > 2.5


@pytest.mark.parametrize("form", FORMS)
def test_commands_that_no_bound_concerns_keep_every_bit(form, f64):
    """Of robots without neighbours or walls nearby no bit changes, whatever others in their trial do."""
    changes = {"world.size": [20, 20], "prey.spawn.region": [[1, 1], [19, 19]]}
    place, command, velocity = _corrected(form, 20, 64, **changes)
    _, _, free = _corrected(form, 20, 64, **changes, **{"prey.safety": "none"})
    away = np.linalg.norm(place[:, :, None] - place[:, None], axis=3) + 99 * np.eye(20)
    alone = away.min(axis=2) > 0.6
    assert alone.sum() > 1000
    np.testing.assert_array_equal(velocity[alone], free[alone])
    assert (np.abs(velocity - command)[~alone] > 1e-6).any()


@pytest.mark.parametrize("form", FORMS)
def test_robots_that_overlap_at_the_start_come_apart(form, f32):
    scenario = _safe(form, {**POINTS, "prey.spawn.apart": 0, "prey.spawn.region": [[1.3, 0.7], [1.9, 1.3]], "prey.count": 8})
    path = tiswarm.record(scenario.replaced({"world.ticks": 2000, "prey.spawn.velocity": [[0, 0], [0, 0]]}))
    assert np.isfinite(path.prey.position).all()
    least = recorded.least_distance(path)
    assert least[0] < 0.1
    assert least[-1] > least[0] + 0.02


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.anew
def test_no_bit_depends_on_company_or_threads(form):
    scenario = _safe(form, {"world.ticks": 300})
    found = []
    for threads, trials in ((1, 24), (2, 24), (2, 11)):
        tiswarm.init("f32", threads=threads)
        results = tiswarm.simulate(scenario, trials)
        found.append(np.stack([results.measures[name][:11] for name in ("coverage", "least-distance", "corrected")]))
    np.testing.assert_array_equal(found[0], found[1])
    np.testing.assert_array_equal(found[0], found[2])


@pytest.mark.anew
def test_a_solution_that_takes_too_long_is_slowed_down_instead(monkeypatch):
    """With one sweep instead of thousands velocities are not the nearest, and bounds hold all the same."""
    monkeypatch.setattr(joint_solution, "SWEEPS", 1)
    tiswarm.init("f64", threads=1)  # kernels of its own
    least = tiswarm.simulate(_safe("joint", CROWDING), 40).measures["least-distance"]
    tiswarm.init("f64")
    assert least.min() > RADIUS - 1e-6


def test_the_measures_are_those_of_a_recording(f64):
    scenario = _safe("joint", {"world.ticks": 200, "measures.after": 50})
    results = tiswarm.simulate(scenario, 2)
    for trial in range(2):
        path = tiswarm.record(scenario, trial, terms=True)
        for name in ("least-distance", "corrected", "stalled", "coverage"):
            assert recorded.measured(path, name) == pytest.approx(results.measures[name][trial], abs=1e-9), name
    with pytest.raises(ValueError, match="terms=True"):
        recorded.corrected(tiswarm.record(scenario))


def test_robots_that_press_to_one_point_end_in_a_deadlock_that_is_counted(f32):
    late = {"world.ticks": 4000, "measures.after": 3000}
    assert tiswarm.simulate(_safe("shared", CROWDING | late), 8).measures["stalled"].mean() > 0.9
    assert tiswarm.simulate(_safe("shared", {"world.ticks": 1000}), 8).measures["stalled"].max() == 0.0  # they sweep on


def test_numbers_of_certificates_differ_from_trial_to_trial(f32):
    numbers = {
        "barrier.radius": [0.12, 0.15, 0.2],
        "barrier.gain": [10.0, 100.0, 1000.0],
        "prey.spawn.apart": [0.22, 0.25, 0.3],
    }
    scenario = _safe("joint", {"world.ticks": 200})
    mixed = tiswarm.simulate(scenario, 3, weights={key: np.array(each) for key, each in numbers.items()})
    for trial in range(3):
        alone = scenario.replaced({key: each[trial] for key, each in numbers.items()})
        assert mixed.measures["least-distance"][trial] == tiswarm.simulate(alone, 3).measures["least-distance"][trial]


def test_robots_begin_apart(f32):
    path = tiswarm.record(_safe("joint", {"world.ticks": 1}))
    assert recorded.least_distance(path)[0] > 0.26
    crowded = tiswarm.record(_safe("joint", {"world.ticks": 1, "prey.spawn.apart": 3.0}))  # no room: as far as can be
    assert np.isfinite(crowded.prey.position).all()


def test_without_certificates_nothing_of_them_is_in_a_kernel(f32):
    layout = ParameterTable(Specialisation.of([tiswarm.load("sanitation/arena")], 0), runtime.types().lanes)
    assert not [path for path in layout.paths if path.startswith("barrier.") or path.endswith(".apart")]
    assert layout.board.fixed == 0
    assert layout.rows.corrected == -1


EDGELESS = {"world.margin": 0, "world.turn_factor": 0}


@pytest.mark.quick
@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({**EDGELESS, "world.boundary": "periodic", "world.wrap_sight": False}, "world.wrap_sight"),
        ({**EDGELESS, "world.boundary": "disc", "prey.spawn.region": [[1.2, 0.6], [2, 1.4]]}, "mirrors"),
        ({"world.scheme": "verlet"}, "'euler'"),
        ({"prey.count": 33}, "'shared'"),
        ({"barrier.radius": 1.0}, "lower it"),
        ({"barrier.form": "own"}, "'joint' or 'shared'"),
        ({"barrier.gain": 0}, "barrier.gain"),
        ({"prey.safety": "yes"}, "'none' or 'barrier'"),
        ({"prey.spawn.shape": "ball"}, "prey.spawn.apart"),
    ],
)
def test_contradictions_are_refused_in_one_line(changes, told):
    with pytest.raises(tiswarm.ScenarioError) as error:
        tiswarm.load("sanitation/arena-safe", changes)
    assert told in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.quick
def test_a_grid_of_neighbours_says_that_it_has_no_certificates():
    with pytest.raises(tiswarm.ScenarioError, match=r"prey.safety.*'barrier'.*all-pairs"):
        tiswarm.simulate(tiswarm.load("sanitation/arena-safe", {"world.neighbours": "grid"}), 1)
