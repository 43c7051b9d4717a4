"""The caption beside the stage: its words and numbers keep off each other, however many there are."""

import pytest

import tiswarm
from render.captions.panel import CLOCK, ROW, Panel
from render.composition import Composition
from render.style import Look


@pytest.mark.parametrize("preset", ["lookout/printed", "lookout/aquarium"])
def test_numbers_keep_off_the_clock(preset, f32):
    recording = tiswarm.record(tiswarm.load(preset, {"world.ticks": 2}))
    panel = Composition(recording, (960, 540), Look(chart=()), yuv=False).caption
    assert isinstance(panel, Panel)
    last = panel._numbers_top + (len(panel._counters) * ROW + 12) * panel._unit
    assert last <= panel._box.bottom - (CLOCK + 16) * panel._unit
