"""Control frames: pictures that were looked at and found good, one for every theme, overlay and camera.

`PYTHONPATH=. python tests/render/test_control.py` draws them anew; look at them before you commit them. Frames this small carry
no type, whose outlines differ between versions of FreeType. The tolerance is for NumPy, whose exp and power differ in the last
bit from one kind of CPU to another, so that a value between two levels may fall to either side.
"""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import render
from render.composition import Composition
from render.style import Look
from tiswarm.records.recording import Recording

FOLDER = Path(__file__).parent / "control"
SIZE = (240, 136)
LOOKS: dict[str, dict[str, object]] = {
    **{f"theme-{name}": {"theme": name} for name in render.THEMES},
    **{f"overlay-{name}": {"overlay": (name,)} for name in render.OVERLAYS},
    "camera-follow": {"camera": "follow"},
    "camera-orbit": {"camera": "orbit"},
}


def picture(recording: Recording, look: dict[str, object]) -> np.ndarray:
    stage = Composition(recording, SIZE, Look(**look), yuv=False)  # type: ignore[arg-type]
    return stage.frame(5.3, stage.canvas.blank()).reshape(SIZE[1], SIZE[0], 3)


@pytest.mark.parametrize("name", LOOKS)
def test_pictures_are_the_control_frames(chase, name):
    with Image.open(FOLDER / f"{name}.png") as image:
        apart = np.abs(np.asarray(image).astype(int) - picture(chase, LOOKS[name]))
    assert apart.max() <= 2
    assert apart.mean() <= 0.02


if __name__ == "__main__":
    import conftest

    FOLDER.mkdir(exist_ok=True)
    for each, choices in LOOKS.items():
        Image.fromarray(picture(conftest.chase.__wrapped__(conftest.make.__wrapped__()), choices)).save(FOLDER / f"{each}.png")
