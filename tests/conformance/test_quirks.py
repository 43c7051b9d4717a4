"""Each rule of prey that the simulator of Lupau 2022 has and a reader of the printed equations would not expect, by hand."""

import math

import numpy as np
import pytest
import quirks
from quirks import FAR_PREDATOR, TARGET

pytestmark = pytest.mark.usefixtures("f64")


def test_a_lone_agent_is_drawn_weakly_to_the_origin_and_damped():
    single = quirks.stepped([(40, 20, 0.5, 0)], prey__cohesion=0.005, prey__alignment=0.05)
    expected = np.array([0.5, 0]) - 0.005 * np.array([40, 20]) - 0.05 * np.array([0.5, 0])
    np.testing.assert_allclose(single.velocity("prey")[0], expected, atol=1e-14)


def test_separation_pushes_apart_where_equation_5_would_attract():
    single = quirks.stepped([(40, 20, 0, 0), (42, 20, 0, 0)], prey__separation=0.05)
    np.testing.assert_allclose(single.velocity("prey"), [[-0.1, 0], [0.1, 0]], atol=1e-14)


def test_alignment_is_the_difference_to_the_mean_velocity():
    single = quirks.stepped([(40, 20, 0.2, 0), (45, 20, 0, 0.4)], prey__alignment=0.05)
    np.testing.assert_allclose(single.velocity("prey")[0], [0.2 - 0.05 * 0.2, 0.05 * 0.4], atol=1e-14)


@pytest.mark.parametrize(("gap", "felt"), [(3.0, True), (3.0 + 1e-9, False)])
def test_spacing_counts_its_own_edge(gap, felt):
    single = quirks.stepped([(40, 20, 0, 0), (40 + gap, 20, 0, 0)], prey__separation=0.05)
    assert (single.velocity("prey")[0, 0] < 0) == felt


@pytest.mark.parametrize(("gap", "felt"), [(5.0, True), (5.0 + 1e-9, False)])
def test_perception_counts_its_own_edge(gap, felt):
    single = quirks.stepped([(40, 20, 0, 0), (40 + gap, 20, 0, 1)], prey__alignment=0.05, prey__perception=5.0)
    assert (single.velocity("prey")[0, 1] > 0) == felt


def test_nothing_stops_an_agent_at_the_edge_of_the_map():
    single = quirks.stepped([(0.2, 25, -1, 0), (99.9, 49.9, 1, 0)], target__position=[50.0, 10.0])
    np.testing.assert_allclose(single.position("prey"), [[-0.8, 25], [100.9, 49.9]])


def test_the_start_itself_is_not_judged():
    single = quirks.single([(40, 20, 1, 0), (10, 25, 1, 0)], obstacles=[(40, 20, 1)])
    assert list(single.fate("prey")) == ["alive", "alive"]
    single.step()
    assert list(single.fate("prey")) == ["crashed", "arrived"]


class TestFields:
    def test_outward(self):
        single = quirks.stepped([(42, 21, 0, 0)], obstacles=[(40, 20, 0.5)], avoidance="outward", prey__max_speed=100.0)
        np.testing.assert_allclose(single.velocity("prey")[0], 10 * np.array([2, 1]) / 5, atol=1e-13)

    def test_spiral_turns_anticlockwise(self):
        single = quirks.stepped([(42, 21, 0, 0)], obstacles=[(40, 20, 0.5)], avoidance="spiral", prey__max_speed=100.0)
        np.testing.assert_allclose(single.velocity("prey")[0], np.array([1, 3]) + 10 * np.array([2, 1]) / 5, atol=1e-13)

    @pytest.mark.parametrize(("side", "spiral"), [(2, (3, -1)), (-2, (-3, -1))])
    def test_directed_spiral_is_clockwise_around_obstacles_towards_the_target(self, side, spiral):
        """Equation 20 prints the two senses the other way round. The target lies at x = 10."""
        at = (40 + side, 21)
        single = quirks.stepped([(*at, 0, 0)], obstacles=[(40, 20, 0.5)], avoidance="directed-spiral", prey__max_speed=100.0)
        r = np.array([side, 1.0])
        towards = float((TARGET - at) @ -r) > 0
        sense = np.array([r[0] + r[1], r[1] - r[0]]) if towards else np.array([r[0] - r[1], r[0] + r[1]])
        assert towards == (side > 0)
        assert tuple(sense) == spiral
        np.testing.assert_allclose(single.velocity("prey")[0], sense + 10 * r / 5, atol=1e-13)

    @pytest.mark.parametrize(("gap", "felt"), [(3.0, True), (3.0 + 1e-9, False)])
    def test_they_end_3_m_from_the_edge_whatever_the_perception(self, gap, felt):
        single = quirks.stepped([(41.5 + gap, 20, 0, 0)], obstacles=[(40, 20, 1.5)], avoidance="outward", prey__perception=0.1)
        assert (single.velocity("prey")[0, 0] > 0) == felt


class TestTurn:
    COSINE, SINE = math.cos(0.15 * math.pi), math.sin(0.15 * math.pi)

    @pytest.mark.parametrize("heading", [(0.6, 0), (0, 0.6), (-0.6, 0), (0, -0.6)])
    def test_it_is_anticlockwise_whichever_side_the_obstacle_is_on(self, heading):
        """Equation 30 varies the sign."""
        for aside in (-0.4, 0.4):
            forward = np.array(heading) / 0.6
            centre = np.array([40, 20]) + 6 * forward + aside * np.array([-forward[1], forward[0]])
            single = quirks.stepped([(40, 20, *heading)], obstacles=[(*centre, 1)], avoidance="steer-away")
            vx, vy = heading
            turned = [self.COSINE * vx - self.SINE * vy, self.SINE * vx + self.COSINE * vy]
            np.testing.assert_allclose(single.velocity("prey")[0], turned, atol=1e-14)

    def test_an_obstacle_right_behind_blocks_too(self):
        single = quirks.stepped([(40, 20, 0.6, 0)], obstacles=[(34, 20, 1)], avoidance="steer-away")
        np.testing.assert_allclose(single.velocity("prey")[0], [0.6 * self.COSINE, 0.6 * self.SINE], atol=1e-14)

    def test_an_obstacle_aside_does_not_block(self):
        single = quirks.stepped([(40, 20, 0.6, 0)], obstacles=[(46, 24, 1)], avoidance="steer-away")
        np.testing.assert_allclose(single.velocity("prey")[0], [0.6, 0], atol=1e-14)

    def test_many_obstacles_turn_it_only_once(self):
        single = quirks.stepped([(40, 20, 0.6, 0)], obstacles=[(46, 20, 1), (50, 20, 1), (34, 20, 1)], avoidance="steer-away")
        np.testing.assert_allclose(single.velocity("prey")[0], [0.6 * self.COSINE, 0.6 * self.SINE], atol=1e-14)

    @pytest.mark.parametrize(("gap", "blocks"), [(30.0, True), (30.0 + 1e-9, False)])
    def test_it_looks_30_m_ahead_whatever_the_perception(self, gap, blocks):
        single = quirks.stepped([(20, 20, 0.6, 0)], obstacles=[(21 + gap, 20, 1)], avoidance="steer-away", prey__perception=1.0)
        assert (single.velocity("prey")[0, 1] > 0) == blocks


class TestExplode:
    def test_it_starts_in_the_tick_after_the_first_sight_and_lasts_50_ticks(self):
        prey = [(40, 20, 0, 0), (41, 20, 0, 0)]
        single = quirks.single(prey, [(65, 20, 0, 0)], strategy="explode", prey__max_speed=1e-3)
        moved = []
        for _ in range(55):
            before = single.position("prey")
            single.step()
            moved.append(np.abs(single.velocity("prey")[0]).max() > 0)
            single.place("prey", before, np.zeros((2, 2)))
        assert moved == [False] + [True] * 50 + [False] * 4

    def test_each_prey_explodes_for_itself_alone(self):
        single = quirks.single(
            [(40, 20, 0, 0), (9, 20, 0, 0)], [(65, 20, 0, 0)], strategy="explode", target__position=[90.0, 45.0]
        )
        for _ in range(2):
            single.step()
        speed = np.linalg.norm(single.velocity("prey"), axis=1)
        assert speed[0] > 0
        assert speed[1] == 0

    def test_communicate_sets_off_the_whole_swarm(self):
        single = quirks.single(
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
        single = quirks.single([(40, 20, 0, 0), (44, 20, 0, 0)], [(65, 20, 0, 0)], strategy="explode", prey__max_speed=100.0)
        single.step()
        single.place("prey", quirks.pairs([(40, 20), (44, 20)]), np.zeros((2, 2)))
        single.step()
        np.testing.assert_allclose(single.velocity("prey")[0], [20 * -2 / (4 + 0.05), 0], atol=1e-13)


class TestSplit:
    PREY = ((40, 20, 0, 0), (42, 20, 0, 0), (44, 20, 0, 0), (40, 24, 0, 0), (44, 24, 0, 0), (42, 28, 0, 0))

    def test_neighbours_have_the_same_parity(self):
        single = quirks.stepped(self.PREY, strategy="split", prey__weights={"part": 0}, prey__cohesion=0.005)
        centre = np.array([(44 + 44) / 2, (20 + 24) / 2])
        np.testing.assert_allclose(single.velocity("prey")[0], 0.005 * (centre - [40, 20]), atol=1e-14)

    def test_odd_agents_flee_the_mean_of_agent_2s_neighbours_without_agent_2(self):
        single = quirks.stepped(self.PREY, strategy="split", prey__max_speed=1e5)
        mean = np.array([(40 + 42) / 2, (24 + 28) / 2])
        np.testing.assert_allclose(single.velocity("prey")[0], 200 * (np.array([40, 20]) - mean), atol=1e-10)

    def test_even_agents_flee_the_mean_of_agent_1s_neighbours_without_agent_1(self):
        single = quirks.stepped(self.PREY, strategy="split", prey__max_speed=1e5)
        mean = np.array([44, (20 + 24) / 2])
        np.testing.assert_allclose(single.velocity("prey")[3], 200 * (np.array([40, 24]) - mean), atol=1e-10)

    def test_the_references_perception_counts(self):
        far = [(40, 20, 0, 0), (75, 20, 0, 0), (44, 20, 0, 0), (40, 24, 0, 0)]
        single = quirks.stepped(far, strategy="split")
        np.testing.assert_array_equal(single.velocity("prey")[0], [0, 0])  # agent 4 is 35 m from agent 2

    def test_only_those_within_50_m_of_the_agent_count(self):
        far = [(10, 5, 0, 0), (61, 5, 0, 0), (12, 5, 0, 0), (62, 5, 0, 0)]
        single = quirks.stepped(far, strategy="split", target__position=[90.0, 45.0])
        np.testing.assert_array_equal(single.velocity("prey")[0], [0, 0])

    def test_a_dead_reference_gives_no_push(self):
        single = quirks.single(self.PREY, strategy="split")
        position = quirks.pairs([row[:2] for row in self.PREY])
        position[1] = np.nan
        single.place("prey", position, np.zeros((6, 2)))
        single.step()
        np.testing.assert_array_equal(single.velocity("prey")[0], [0, 0])
        assert np.abs(single.velocity("prey")[3]).max() > 0

    def test_the_push_acts_in_ticks_0_to_30(self):
        single = quirks.single(self.PREY, strategy="split", prey__max_speed=1e-3)
        pushed = []
        for _ in range(33):
            single.step()
            pushed.append(np.abs(single.velocity("prey")[0]).max() > 0)
            single.place("prey", quirks.pairs([row[:2] for row in self.PREY]), np.zeros((6, 2)))
        assert pushed == [True] * 31 + [False] * 2


class TestJump:
    def test_one_kick_an_encounter_into_the_first_quadrant_after_the_cap(self):
        single = quirks.single([(40, 20, -1, 0)], [(60, 20, 0, 0)], strategy="jump", prey__goal=0.0)
        single.step()
        kick = single.velocity("prey")[0] - [-1, 0]
        assert np.linalg.norm(kick) == pytest.approx(3)
        assert (kick > 0).all()
        single.step()  # still in sight: no second kick, and the cap takes the speed back
        assert np.linalg.norm(single.velocity("prey")[0]) == pytest.approx(1)

    def test_it_kicks_again_after_nobody_was_in_sight(self):
        single = quirks.single([(40, 20, 0, 0)], [(60, 20, 0, 0)], strategy="jump")
        near, far = quirks.pairs([(60, 20)]), quirks.pairs([(90, 45)])
        speeds = []
        for predator in (near, near, far, near):
            single.place("prey", quirks.pairs([(40, 20)]), np.zeros((1, 2)))
            single.place("predators", predator, np.zeros((1, 2)))
            single.step()
            speeds.append(round(float(np.linalg.norm(single.velocity("prey")[0])), 6))
        assert speeds == [3, 0, 0, 3]

    def test_others_see_the_velocity_with_the_kick(self):
        single = quirks.single(
            [(40, 20, 0, 0), (8, 20, 0, 0)], [(65, 20, 0, 0)], strategy="jump", target__position=[90.0, 45.0]
        )
        single.step()
        kicked = single.velocity("prey")[0]
        assert np.linalg.norm(kicked) == pytest.approx(3)
        aligned = quirks.single(
            [(40, 20, *kicked), (42, 20, 0, 0)], FAR_PREDATOR, strategy="jump", prey__alignment=0.05, prey__perception=5.0
        )
        aligned.step()
        np.testing.assert_allclose(aligned.velocity("prey")[1], 0.05 * kicked, atol=1e-14)
