"""What the simulator of Lupau 2022 does with predators and contacts that a reader of the print would not expect, by hand."""

import math

import numpy as np
import pytest
import quirks

pytestmark = pytest.mark.usefixtures("f64")


class TestPredators:
    def test_they_see_prey_after_its_move_even_those_about_to_die(self):
        single = quirks.stepped(
            [(40, 20, 1, 0), (60, 20, 1, 0)],
            [(50, 5, 0, 0)],
            obstacles=[(61.5, 20, 0.5)],
            predators__goal=0.1,
            predators__max_speed=100.0,
        )
        assert list(single.fate("prey")) == ["alive", "crashed"]
        np.testing.assert_allclose(single.velocity("predators")[0], 0.1 * (np.array([51, 20]) - [50, 5]), atol=1e-13)

    def test_obstacles_repel_by_distance_and_radius(self):
        single = quirks.stepped([(90, 40, 0, 0)], [(44, 20, 0, 0)], obstacles=[(40, 20, 2)], predators__max_speed=100.0)
        np.testing.assert_allclose(single.velocity("predators")[0], [0.3 * 4 * (1 + 2 / 4), 0], atol=1e-13)

    @pytest.mark.parametrize(("gap", "felt"), [(5.0, True), (5.0 + 1e-9, False)])
    def test_obstacles_repel_up_to_5_m_from_their_edge(self, gap, felt):
        single = quirks.stepped([(90, 40, 0, 0)], [(42 + gap, 20, 0, 0)], obstacles=[(40, 20, 2)])
        assert (single.velocity("predators")[0, 0] > 0) == felt

    def test_proportional_navigation_leads_the_prey(self):
        single = quirks.stepped([(60, 25, -0.8, 0)], [(30, 5, 0, 0)], predator="pronav", predators__goal=0.1)
        quarry = np.array([59.2, 25])
        sight = (quarry - [30, 5]) / np.linalg.norm(quarry - [30, 5])
        closing = np.array([-0.8, 0])  # the whole velocity leads to the target, which lies at the same height
        sine = abs(closing[0] * sight[1] - closing[1] * sight[0])
        cosine = math.sqrt(1 - sine**2)
        led = [cosine * sight[0] - sine * sight[1], sine * sight[0] + cosine * sight[1]]
        np.testing.assert_allclose(single.velocity("predators")[0], 0.1 * np.array(led), atol=1e-14)

    def test_prey_at_rest_is_aimed_at_straight(self):
        single = quirks.stepped([(60, 25, 0, 0)], [(30, 5, 0, 0)], predator="pronav", predators__goal=0.1)
        sight = np.array([30, 20]) / math.hypot(30, 20)
        np.testing.assert_allclose(single.velocity("predators")[0], 0.1 * sight, atol=1e-14)

    def test_prey_too_fast_to_lead_is_led_by_a_right_angle(self):
        """The author's code gives NaN here; jumps cause it in 2 % of trials."""
        single = quirks.stepped([(60, 25, -4, 0)], [(56, 5, 0, 0)], predator="pronav", predators__goal=0.1, prey__max_speed=4.0)
        np.testing.assert_allclose(single.position("prey")[0], [56, 25])
        np.testing.assert_allclose(single.velocity("predators")[0], [-0.1, 0], atol=1e-14)


class TestContact:
    def test_one_predator_takes_two_prey_at_once(self):
        single = quirks.stepped([(40, 20, 0, 0), (41, 20, 0, 0), (60, 20, 0, 0)], [(40.5, 20, 0, 0)])
        assert list(single.fate("prey")) == ["captured", "captured", "alive"]
        assert list(single.fate("predators")) == ["captured"]

    @pytest.mark.parametrize(("gap", "fate"), [(0.75, "alive"), (0.75 - 1e-9, "captured")])
    def test_capture_needs_less_than_the_sum_of_radii(self, gap, fate):
        single = quirks.stepped([(40, 20, 0, 0), (60, 20, 0, 0)], [(40 + gap, 20, 0, 0)])
        assert single.fate("prey")[0] == fate

    @pytest.mark.parametrize(("gap", "fate"), [(1.5, "alive"), (1.5 - 1e-9, "crashed")])
    def test_a_crash_needs_less_than_the_sum_of_radii(self, gap, fate):
        single = quirks.stepped([(40 + gap, 20, 0, 0), (60, 20, 0, 0)], obstacles=[(40, 20, 1)])
        assert single.fate("prey")[0] == fate

    @pytest.mark.parametrize(("gap", "fate"), [(3.5, "arrived"), (3.5 + 1e-9, "alive")])
    def test_prey_arrives_wholly_inside_the_target(self, gap, fate):
        single = quirks.stepped([(10 + gap, 25, 0, 0), (60, 20, 0, 0)])
        assert single.fate("prey")[0] == fate

    @pytest.mark.parametrize(("gap", "fate"), [(4.0, "crashed"), (4.0 + 1e-9, "alive")])
    def test_the_target_kills_predators(self, gap, fate):
        single = quirks.stepped([(60, 20, 0, 0)], [(10 + gap, 25, 0, 0)])
        assert single.fate("predators")[0] == fate

    def test_prey_that_crashes_takes_no_predator_along(self):
        single = quirks.stepped(
            [(40, 20, 0, 0), (60, 20, 0, 0)], [(40.5, 20, 0, 0)], obstacles=[(38.9, 20, 1)], predators__avoidance="none"
        )
        assert single.fate("prey")[0] == "crashed"
        assert single.fate("predators")[0] == "alive"

    def test_prey_that_is_taken_does_not_arrive(self):
        single = quirks.stepped([(13.4, 25, 0, 0), (60, 20, 0, 0)], [(14.1, 25, 0, 0)])
        assert list(single.fate("prey")) == ["captured", "alive"]

    def test_a_trial_ends_when_no_prey_is_alive(self):
        single = quirks.stepped([(40, 20, 0, 0)], [(40.5, 20, 0, 0)])
        assert single.ended
        assert single.age == 1

    def test_a_trial_ends_at_its_last_tick(self):
        single = quirks.single([(40, 20, 0, 0)], world__ticks=3)
        for _ in range(3):
            assert not single.ended
            single.step()
        assert single.ended
