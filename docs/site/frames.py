"""Frames: draw a frame for each preset of the gallery that has none, or for those that are named.

python docs/site/frames.py [PRESET...]
"""

import sys

import gallery
from PIL import Image

import render
import tiswarm
from tiswarm.engine.choice import engine_of
from tiswarm.scenario import presets

SIZE = (960, 540)

MOMENTS = {"demo/million": 30.0}
"""Ticks after which large swarms are drawn, where half of a trial would be long."""


def draw(name: str) -> None:
    """Draw one preset's frame: the liveliest moment of the trial that its film shows."""
    scenario = tiswarm.load(name)
    large = engine_of(scenario) == "grid"
    moment = MOMENTS.get(name, min(scenario.world.ticks / 2, 200.0)) if large else None
    begin = tiswarm.Simulation if large else tiswarm.record
    subject = begin(scenario, seed=scenario.showcase.seed, trial=scenario.showcase.trial)
    target = gallery.frame_of(name)
    target.parent.mkdir(exist_ok=True)
    render.poster(subject, target, SIZE, time=moment)
    with Image.open(target) as image:
        image.save(target, quality=82, optimize=True)


if __name__ == "__main__":
    wanted = sys.argv[1:] or [each for each in presets.presets() if not gallery.frame_of(each).is_file()]
    for each in wanted:
        draw(each)
        print(gallery.frame_of(each))
