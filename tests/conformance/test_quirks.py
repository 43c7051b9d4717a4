"""Each rule that the simulator of Lupau 2022 has and a reader of the printed equations would not expect, by hand."""

import math

import numpy as np
import pytest

import tiswarm
from tiswarm.engine.trials.trial import Single

pytestmark = pytest.mark.usefixtures("f64")

STILL = {f"{kind}.{name}": 0.0 for kind in ("prey", "predators") for name in ("cohesion", "separation", "alignment", "goal")}
"""No term of the common ones acts."""

TARGET = np.array([10.0, 25.0])


def _pairs(rows):
    return np.array(rows, float).reshape(-1, 2)


def _single(prey, predators=(), obstacles=(), strategy="baseline", avoidance="none", predator="centre", **overrides):
    """Start a trial from rows (x, y, vx, vy) of agents and (x, y, radius) of obstacles."""
    prey, predators = (np.array(rows, float).reshape(-1, 4) for rows in (prey, predators))
    obstacles = np.array(obstacles, float).reshape(-1, 3)
    start = tiswarm.Start(prey[:, :2], prey[:, 2:], predators[:, :2], predators[:, 2:], obstacles[:, :2], obstacles[:, 2])
    chosen = {"prey.strategy": strategy, "prey.avoidance": avoidance, "predators.strategy": predator}
    keys = {key.replace("__", "."): value for key, value in overrides.items()}
    return Single(tiswarm.load("delft/pronav-10", {**chosen, **STILL, **keys}), 0, 0, start)


def _stepped(*args, **kwargs):
    single = _single(*args, **kwargs)
    single.step()
    return single


FAR_PREDATOR = [(90, 45, 0, 0)]


def test_a_lone_agent_is_drawn_weakly_to_the_origin_and_damped():
    single = _stepped([(40, 20, 0.5, 0)], prey__cohesion=0.005, prey__alignment=0.05)
    expected = np.array([0.5, 0]) - 0.005 * np.array([40, 20]) - 0.05 * np.array([0.5, 0])
    np.testing.assert_allclose(single.velocity("prey")[0], expected, atol=1e-14)


def test_separation_pushes_apart_where_equation_5_would_attract():
    single = _stepped([(40, 20, 0, 0), (42, 20, 0, 0)], prey__separation=0.05)
    np.testing.assert_allclose(single.velocity("prey"), [[-0.1, 0], [0.1, 0]], atol=1e-14)


def test_alignment_is_the_difference_to_the_mean_velocity():
    single = _stepped([(40, 20, 0.2, 0), (45, 20, 0, 0.4)], prey__alignment=0.05)
    np.testing.assert_allclose(single.velocity("prey")[0], [0.2 - 0.05 * 0.2, 0.05 * 0.4], atol=1e-14)


@pytest.mark.parametrize(("gap", "felt"), [(3.0, True), (3.0 + 1e-9, False)])
def test_spacing_counts_its_own_edge(gap, felt):
    single = _stepped([(40, 20, 0, 0), (40 + gap, 20, 0, 0)], prey__separation=0.05)
    assert (single.velocity("prey")[0, 0] < 0) == felt


@pytest.mark.parametrize(("gap", "felt"), [(5.0, True), (5.0 + 1e-9, False)])
def test_perception_counts_its_own_edge(gap, felt):
    single = _stepped([(40, 20, 0, 0), (40 + gap, 20, 0, 1)], prey__alignment=0.05, prey__perception=5.0)
    assert (single.velocity("prey")[0, 1] > 0) == felt


def test_nothing_stops_an_agent_at_the_edge_of_the_map():
    single = _stepped([(0.2, 25, -1, 0), (99.9, 49.9, 1, 0)], target__position=[50.0, 10.0])
    np.testing.assert_allclose(single.position("prey"), [[-0.8, 25], [100.9, 49.9]])


def test_the_start_itself_is_not_judged():
    single = _single([(40, 20, 1, 0), (10, 25, 1, 0)], obstacles=[(40, 20, 1)])
    assert list(single.fate("prey")) == ["alive", "alive"]
    single.step()
    assert list(single.fate("prey")) == ["crashed", "arrived"]


class TestFields:
    def test_outward(self):
        single = _stepped([(42, 21, 0, 0)], obstacles=[(40, 20, 0.5)], avoidance="outward", prey__max_speed=100.0)
        np.testing.assert_allclose(single.velocity("prey")[0], 10 * np.array([2, 1]) / 5, atol=1e-13)

    def test_spiral_turns_anticlockwise(self):
        single = _stepped([(42, 21, 0, 0)], obstacles=[(40, 20, 0.5)], avoidance="spiral", prey__max_speed=100.0)
        np.testing.assert_allclose(single.velocity("prey")[0], np.array([1, 3]) + 10 * np.array([2, 1]) / 5, atol=1e-13)

    @pytest.mark.parametrize(("side", "spiral"), [(2, (3, -1)), (-2, (-3, -1))])
    def test_directed_spiral_is_clockwise_around_obstacles_towards_the_target(self, side, spiral):
        """Equation 20 prints the two senses the other way round. The target lies at x = 10."""
        at = (40 + side, 21)
        single = _stepped([(*at, 0, 0)], obstacles=[(40, 20, 0.5)], avoidance="directed-spiral", prey__max_speed=100.0)
        r = np.array([side, 1.0])
        towards = float((TARGET - at) @ -r) > 0
        sense = np.array([r[0] + r[1], r[1] - r[0]]) if towards else np.array([r[0] - r[1], r[0] + r[1]])
        assert towards == (side > 0)
        assert tuple(sense) == spiral
        np.testing.assert_allclose(single.velocity("prey")[0], sense + 10 * r / 5, atol=1e-13)

    @pytest.mark.parametrize(("gap", "felt"), [(3.0, True), (3.0 + 1e-9, False)])
    def test_they_end_3_m_from_the_edge_whatever_the_perception(self, gap, felt):
        single = _stepped([(41.5 + gap, 20, 0, 0)], obstacles=[(40, 20, 1.5)], avoidance="outward", prey__perception=0.1)
        assert (single.velocity("prey")[0, 0] > 0) == felt


class TestTurn:
    COSINE, SINE = math.cos(0.15 * math.pi), math.sin(0.15 * math.pi)

    @pytest.mark.parametrize("heading", [(0.6, 0), (0, 0.6), (-0.6, 0), (0, -0.6)])
    def test_it_is_anticlockwise_whichever_side_the_obstacle_is_on(self, heading):
        """Equation 30 varies the sign."""
        for aside in (-0.4, 0.4):
            forward = np.array(heading) / 0.6
            centre = np.array([40, 20]) + 6 * forward + aside * np.array([-forward[1], forward[0]])
            single = _stepped([(40, 20, *heading)], obstacles=[(*centre, 1)], avoidance="steer-away")
            vx, vy = heading
            turned = [self.COSINE * vx - self.SINE * vy, self.SINE * vx + self.COSINE * vy]
            np.testing.assert_allclose(single.velocity("prey")[0], turned, atol=1e-14)

    def test_an_obstacle_right_behind_blocks_too(self):
        single = _stepped([(40, 20, 0.6, 0)], obstacles=[(34, 20, 1)], avoidance="steer-away")
        np.testing.assert_allclose(single.velocity("prey")[0], [0.6 * self.COSINE, 0.6 * self.SINE], atol=1e-14)

    def test_an_obstacle_aside_does_not_block(self):
        single = _stepped([(40, 20, 0.6, 0)], obstacles=[(46, 24, 1)], avoidance="steer-away")
        np.testing.assert_allclose(single.velocity("prey")[0], [0.6, 0], atol=1e-14)

    def test_many_obstacles_turn_it_only_once(self):
        single = _stepped([(40, 20, 0.6, 0)], obstacles=[(46, 20, 1), (50, 20, 1), (34, 20, 1)], avoidance="steer-away")
        np.testing.assert_allclose(single.velocity("prey")[0], [0.6 * self.COSINE, 0.6 * self.SINE], atol=1e-14)

    @pytest.mark.parametrize(("gap", "blocks"), [(30.0, True), (30.0 + 1e-9, False)])
    def test_it_looks_30_m_ahead_whatever_the_perception(self, gap, blocks):
        single = _stepped([(20, 20, 0.6, 0)], obstacles=[(21 + gap, 20, 1)], avoidance="steer-away", prey__perception=1.0)
        assert (single.velocity("prey")[0, 1] > 0) == blocks


class TestExplode:
    def test_it_starts_in_the_tick_after_the_first_sight_and_lasts_50_ticks(self):
        prey = [(40, 20, 0, 0), (41, 20, 0, 0)]
        single = _single(prey, [(65, 20, 0, 0)], strategy="explode", prey__max_speed=1e-3)
        moved = []
        for _ in range(55):
            before = single.position("prey")
            single.step()
            moved.append(np.abs(single.velocity("prey")[0]).max() > 0)
            single.place("prey", before, np.zeros((2, 2)))
        assert moved == [False] + [True] * 50 + [False] * 4

    def test_each_prey_explodes_for_itself_alone(self):
        single = _single([(40, 20, 0, 0), (9, 20, 0, 0)], [(65, 20, 0, 0)], strategy="explode", target__position=[90.0, 45.0])
        for _ in range(2):
            single.step()
        speed = np.linalg.norm(single.velocity("prey"), axis=1)
        assert speed[0] > 0
        assert speed[1] == 0

    def test_communicate_sets_off_the_whole_swarm(self):
        single = _single(
            [(40, 20, 0, 0), (9, 20, 0, 0)],
            [(65, 20, 0, 0)],
            strategy="explode",
            target__position=[90.0, 45.0],
            prey__weights={"communicate": 1},
        )
        for _ in range(2):
            single.step()
        assert (np.linalg.norm(single.velocity("prey"), axis=1) > 0).all()

    def test_it_flees_the_mean_of_all_prey_itself_included(self):
        single = _single([(40, 20, 0, 0), (44, 20, 0, 0)], [(65, 20, 0, 0)], strategy="explode", prey__max_speed=100.0)
        single.step()
        single.place("prey", _pairs([(40, 20), (44, 20)]), np.zeros((2, 2)))
        single.step()
        np.testing.assert_allclose(single.velocity("prey")[0], [20 * -2 / (4 + 0.05), 0], atol=1e-13)


class TestSplit:
    PREY = ((40, 20, 0, 0), (42, 20, 0, 0), (44, 20, 0, 0), (40, 24, 0, 0), (44, 24, 0, 0), (42, 28, 0, 0))

    def test_neighbours_have_the_same_parity(self):
        single = _stepped(self.PREY, strategy="split", prey__weights={"part": 0}, prey__cohesion=0.005)
        centre = np.array([(44 + 44) / 2, (20 + 24) / 2])
        np.testing.assert_allclose(single.velocity("prey")[0], 0.005 * (centre - [40, 20]), atol=1e-14)

    def test_odd_agents_flee_the_mean_of_agent_2s_neighbours_without_agent_2(self):
        single = _stepped(self.PREY, strategy="split", prey__max_speed=1e5)
        mean = np.array([(40 + 42) / 2, (24 + 28) / 2])
        np.testing.assert_allclose(single.velocity("prey")[0], 200 * (np.array([40, 20]) - mean), atol=1e-10)

    def test_even_agents_flee_the_mean_of_agent_1s_neighbours_without_agent_1(self):
        single = _stepped(self.PREY, strategy="split", prey__max_speed=1e5)
        mean = np.array([44, (20 + 24) / 2])
        np.testing.assert_allclose(single.velocity("prey")[3], 200 * (np.array([40, 24]) - mean), atol=1e-10)

    def test_the_references_perception_counts(self):
        far = [(40, 20, 0, 0), (75, 20, 0, 0), (44, 20, 0, 0), (40, 24, 0, 0)]
        single = _stepped(far, strategy="split")
        np.testing.assert_array_equal(single.velocity("prey")[0], [0, 0])  # agent 4 is 35 m from agent 2

    def test_only_those_within_50_m_of_the_agent_count(self):
        far = [(10, 5, 0, 0), (61, 5, 0, 0), (12, 5, 0, 0), (62, 5, 0, 0)]
        single = _stepped(far, strategy="split", target__position=[90.0, 45.0])
        np.testing.assert_array_equal(single.velocity("prey")[0], [0, 0])

    def test_a_dead_reference_gives_no_push(self):
        single = _single(self.PREY, strategy="split")
        position = _pairs([row[:2] for row in self.PREY])
        position[1] = np.nan
        single.place("prey", position, np.zeros((6, 2)))
        single.step()
        np.testing.assert_array_equal(single.velocity("prey")[0], [0, 0])
        assert np.abs(single.velocity("prey")[3]).max() > 0

    def test_the_push_acts_in_ticks_0_to_30(self):
        single = _single(self.PREY, strategy="split", prey__max_speed=1e-3)
        pushed = []
        for _ in range(33):
            single.step()
            pushed.append(np.abs(single.velocity("prey")[0]).max() > 0)
            single.place("prey", _pairs([row[:2] for row in self.PREY]), np.zeros((6, 2)))
        assert pushed == [True] * 31 + [False] * 2


class TestJump:
    def test_one_kick_an_encounter_into_the_first_quadrant_after_the_cap(self):
        single = _single([(40, 20, -1, 0)], [(60, 20, 0, 0)], strategy="jump", prey__goal=0.0)
        single.step()
        kick = single.velocity("prey")[0] - [-1, 0]
        assert np.linalg.norm(kick) == pytest.approx(3)
        assert (kick > 0).all()
        single.step()  # still in sight: no second kick, and the cap takes the speed back
        assert np.linalg.norm(single.velocity("prey")[0]) == pytest.approx(1)

    def test_it_kicks_again_after_nobody_was_in_sight(self):
        single = _single([(40, 20, 0, 0)], [(60, 20, 0, 0)], strategy="jump")
        near, far = _pairs([(60, 20)]), _pairs([(90, 45)])
        speeds = []
        for predator in (near, near, far, near):
            single.place("prey", _pairs([(40, 20)]), np.zeros((1, 2)))
            single.place("predators", predator, np.zeros((1, 2)))
            single.step()
            speeds.append(round(float(np.linalg.norm(single.velocity("prey")[0])), 6))
        assert speeds == [3, 0, 0, 3]

    def test_others_see_the_velocity_with_the_kick(self):
        single = _single([(40, 20, 0, 0), (8, 20, 0, 0)], [(65, 20, 0, 0)], strategy="jump", target__position=[90.0, 45.0])
        single.step()
        kicked = single.velocity("prey")[0]
        assert np.linalg.norm(kicked) == pytest.approx(3)
        aligned = _single(
            [(40, 20, *kicked), (42, 20, 0, 0)], FAR_PREDATOR, strategy="jump", prey__alignment=0.05, prey__perception=5.0
        )
        aligned.step()
        np.testing.assert_allclose(aligned.velocity("prey")[1], 0.05 * kicked, atol=1e-14)


class TestPredators:
    def test_they_see_prey_after_its_move_even_those_about_to_die(self):
        single = _stepped(
            [(40, 20, 1, 0), (60, 20, 1, 0)],
            [(50, 5, 0, 0)],
            obstacles=[(61.5, 20, 0.5)],
            predators__goal=0.1,
            predators__max_speed=100.0,
        )
        assert list(single.fate("prey")) == ["alive", "crashed"]
        np.testing.assert_allclose(single.velocity("predators")[0], 0.1 * (np.array([51, 20]) - [50, 5]), atol=1e-13)

    def test_obstacles_repel_by_distance_and_radius(self):
        single = _stepped([(90, 40, 0, 0)], [(44, 20, 0, 0)], obstacles=[(40, 20, 2)], predators__max_speed=100.0)
        np.testing.assert_allclose(single.velocity("predators")[0], [0.3 * 4 * (1 + 2 / 4), 0], atol=1e-13)

    @pytest.mark.parametrize(("gap", "felt"), [(5.0, True), (5.0 + 1e-9, False)])
    def test_obstacles_repel_up_to_5_m_from_their_edge(self, gap, felt):
        single = _stepped([(90, 40, 0, 0)], [(42 + gap, 20, 0, 0)], obstacles=[(40, 20, 2)])
        assert (single.velocity("predators")[0, 0] > 0) == felt

    def test_proportional_navigation_leads_the_prey(self):
        single = _stepped([(60, 25, -0.8, 0)], [(30, 5, 0, 0)], predator="pronav", predators__goal=0.1)
        quarry = np.array([59.2, 25])
        sight = (quarry - [30, 5]) / np.linalg.norm(quarry - [30, 5])
        closing = np.array([-0.8, 0])  # the whole velocity leads to the target, which lies at the same height
        sine = abs(closing[0] * sight[1] - closing[1] * sight[0])
        cosine = math.sqrt(1 - sine**2)
        led = [cosine * sight[0] - sine * sight[1], sine * sight[0] + cosine * sight[1]]
        np.testing.assert_allclose(single.velocity("predators")[0], 0.1 * np.array(led), atol=1e-14)

    def test_prey_at_rest_is_aimed_at_straight(self):
        single = _stepped([(60, 25, 0, 0)], [(30, 5, 0, 0)], predator="pronav", predators__goal=0.1)
        sight = np.array([30, 20]) / math.hypot(30, 20)
        np.testing.assert_allclose(single.velocity("predators")[0], 0.1 * sight, atol=1e-14)

    def test_prey_too_fast_to_lead_is_led_by_a_right_angle(self):
        """The author's code gives NaN here; jumps cause it in 2 % of trials."""
        single = _stepped([(60, 25, -4, 0)], [(56, 5, 0, 0)], predator="pronav", predators__goal=0.1, prey__max_speed=4.0)
        np.testing.assert_allclose(single.position("prey")[0], [56, 25])
        np.testing.assert_allclose(single.velocity("predators")[0], [-0.1, 0], atol=1e-14)


class TestContact:
    def test_one_predator_takes_two_prey_at_once(self):
        single = _stepped([(40, 20, 0, 0), (41, 20, 0, 0), (60, 20, 0, 0)], [(40.5, 20, 0, 0)])
        assert list(single.fate("prey")) == ["captured", "captured", "alive"]
        assert list(single.fate("predators")) == ["captured"]

    @pytest.mark.parametrize(("gap", "fate"), [(0.75, "alive"), (0.75 - 1e-9, "captured")])
    def test_capture_needs_less_than_the_sum_of_radii(self, gap, fate):
        single = _stepped([(40, 20, 0, 0), (60, 20, 0, 0)], [(40 + gap, 20, 0, 0)])
        assert single.fate("prey")[0] == fate

    @pytest.mark.parametrize(("gap", "fate"), [(1.5, "alive"), (1.5 - 1e-9, "crashed")])
    def test_a_crash_needs_less_than_the_sum_of_radii(self, gap, fate):
        single = _stepped([(40 + gap, 20, 0, 0), (60, 20, 0, 0)], obstacles=[(40, 20, 1)])
        assert single.fate("prey")[0] == fate

    @pytest.mark.parametrize(("gap", "fate"), [(3.5, "arrived"), (3.5 + 1e-9, "alive")])
    def test_prey_arrives_wholly_inside_the_target(self, gap, fate):
        single = _stepped([(10 + gap, 25, 0, 0), (60, 20, 0, 0)])
        assert single.fate("prey")[0] == fate

    @pytest.mark.parametrize(("gap", "fate"), [(4.0, "crashed"), (4.0 + 1e-9, "alive")])
    def test_the_target_kills_predators(self, gap, fate):
        single = _stepped([(60, 20, 0, 0)], [(10 + gap, 25, 0, 0)])
        assert single.fate("predators")[0] == fate

    def test_prey_that_crashes_takes_no_predator_along(self):
        single = _stepped(
            [(40, 20, 0, 0), (60, 20, 0, 0)], [(40.5, 20, 0, 0)], obstacles=[(38.9, 20, 1)], predators__avoidance="none"
        )
        assert single.fate("prey")[0] == "crashed"
        assert single.fate("predators")[0] == "alive"

    def test_prey_that_is_taken_does_not_arrive(self):
        single = _stepped([(13.4, 25, 0, 0), (60, 20, 0, 0)], [(14.1, 25, 0, 0)])
        assert list(single.fate("prey")) == ["captured", "alive"]

    def test_a_trial_ends_when_no_prey_is_alive(self):
        single = _stepped([(40, 20, 0, 0)], [(40.5, 20, 0, 0)])
        assert single.ended
        assert single.age == 1

    def test_a_trial_ends_at_its_last_tick(self):
        single = _single([(40, 20, 0, 0)], world__ticks=3)
        for _ in range(3):
            assert not single.ended
            single.step()
        assert single.ended
