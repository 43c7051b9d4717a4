"""How fast films are made: rasterising alone, the encoder alone, whole films, and matplotlib for scale.

    python tests/benchmarks/film.py [-o out/film-speed.csv] [--without-matplotlib]

Each figure is the best of several runs after a first one that warms up. Pictures are checked before they are timed.
"""

import argparse
import csv
import os
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

import render
import tiswarm
from render.composition import Composition
from render.encoder import encoder, format_of
from render.scene.scene import CROWDED
from render.style import Look
from tiswarm.records.recording import Recording, Swarm
from tiswarm.system.machine import machine

SIZE, HD = (1920, 1080), (1280, 720)
FPS = 60
READY, PIECE = 120, 12


def best(*works: Callable[[], object], runs: int = 3) -> list[float]:
    """Give the shortest time of several runs of each work [s]. They take turns, so that a busy machine slows all alike."""
    taken: list[list[float]] = [[] for _ in works]
    for run in range(runs + 1):
        for work, times in zip(works, taken, strict=True):
            start = time.perf_counter()
            work()
            if run:  # the first one warms up
                times.append(time.perf_counter() - start)
    return [min(times) for times in taken]


def chases(count: int) -> list[Recording]:
    """Record Delft chases."""
    scenario = tiswarm.load("delft/pronav-10", {"prey.strategy": "split-evasive"})
    return [tiswarm.record(scenario, trial=n, seed=1) for n in range(count)]


def crowd(agents: int, ticks: int = 12) -> Recording:
    """Make a recording of many agents that drift about, without a simulation."""
    rng = np.random.default_rng(5)
    start = rng.normal((50, 25), (16, 8), (agents, 2))
    velocity = np.broadcast_to(rng.normal(0, 0.5, (agents, 2)), (ticks + 1, agents, 2)).copy()
    position = start + np.arange(ticks + 1)[:, None, None] * velocity
    state, group = np.full((ticks + 1, agents), "calm"), np.full((ticks + 1, agents), -1, np.int32)
    swarm = Swarm(position, velocity, np.full(agents, "alive"), state, group)
    nobody = replace(
        swarm, position=position[:, :0], velocity=velocity[:, :0], fate=swarm.fate[:0], state=state[:, :0], group=group[:, :0]
    )
    return Recording(tiswarm.load("delft/pronav-0"), 5, 0, swarm, nobody, np.zeros((0, 2)), np.zeros(0))


class Passing:
    """The same crowd as a live simulation: no tick is kept."""

    def __init__(self, recording: Recording, ticks: int):
        self.scenario, self.seed, self.trial, self.ticks = recording.scenario, recording.seed, recording.trial, ticks
        self.obstacle_position, self.obstacle_radius = recording.obstacle_position, recording.obstacle_radius
        self._both = [self._start(swarm) for swarm in (recording.prey, recording.predators)]

    @staticmethod
    def _start(swarm: Swarm) -> Swarm:
        return Swarm(swarm.position[0].copy(), swarm.velocity[0], swarm.fate, swarm.state[0], swarm.group[0])

    def __iter__(self) -> Iterator[tuple[Swarm, Swarm]]:
        for _ in range(self.ticks + 1):
            yield self._both[0], self._both[1]
            self._both[0].position[:] += self._both[0].velocity


def filmed_live(agents: int, folder: Path, ticks: int = 20) -> float:
    """Give frames per second of a whole film of a live crowd, draft."""
    recording = crowd(agents, 1)

    def whole() -> None:
        render.film(Passing(recording, ticks), folder / "live.mp4", SIZE, FPS, quality="draft")

    return (ticks / 10 + 1) * FPS / best(whole, runs=2)[0]


def rasterised(subject: Recording | list[Recording], **look: object) -> float:
    """Give frames per second of rasterising to planar YUV, spread over the whole film."""
    stage = Composition(subject, SIZE, Look(**look), yuv=True)  # type: ignore[arg-type]
    moments = [moment for moment in stage.times(FPS) if moment < stage.scene.paths.last]
    pieces = min(READY // PIECE, max(len(moments) // PIECE, 1))
    starts = np.linspace(0, max(len(moments) - PIECE, 0), pieces).astype(int)
    moments = [moment for start in starts for moment in moments[start : start + PIECE]]
    out = stage.canvas.blank()
    drawn = {stage.frame(moment, out).tobytes() for moment in moments[::20]}
    assert len(drawn) == len(moments[::20]), "frames of different times must differ"

    def all_frames() -> None:
        for moment in moments:
            stage.frame(moment, out)

    return len(moments) / best(all_frames)[0]


def encoded(recording: Recording, quality: str, folder: Path) -> tuple[float, float]:
    """Give frames per second of a whole film, and of the same encoder fed with frames that were made before."""
    stage = Composition(recording, SIZE, Look(), yuv=True)
    moments = list(stage.times(FPS))[stage.length(FPS) // 3 :][:READY]
    ready = [stage.canvas.blank() for _ in moments]
    for moment, plate in zip(moments, ready, strict=True):
        stage.frame(moment, plate)
    path = folder / "film.mp4"
    form = format_of(path, quality)

    def whole() -> None:
        with encoder(path, SIZE, FPS, form, {}, stage.canvas.blank) as reel:
            for moment in moments:
                plate = reel.blank()
                stage.frame(moment, plate)
                reel.put(plate)

    def alone() -> None:
        with encoder(path, SIZE, FPS, form, {}, stage.canvas.blank) as reel:
            for plate in ready:
                reel.blank()
                reel.put(plate)

    film, swallowed = (len(moments) / seconds for seconds in best(whole, alone))
    assert path.stat().st_size > 10_000
    return film, swallowed


def filmed(recording: Recording, name: str, folder: Path, *, clear: bool, frames: int = 60) -> float:
    """Give frames per second of a film of a chase with or without a ground, 720p, good."""
    form = format_of(Path(name), "good", transparent=clear)
    stage = Composition(recording, HD, Look(transparent=clear), yuv=form.yuv and not clear)
    moments = list(stage.times(FPS))[stage.length(FPS) // 3 :][:frames]

    def whole() -> None:
        with (
            tempfile.TemporaryDirectory(dir=folder) as own,
            encoder(Path(own, name), HD, FPS, form, {}, stage.canvas.blank) as reel,
        ):
            for moment in moments:
                plate = reel.blank()
                stage.frame(moment, plate)
                reel.put(plate)

    return len(moments) / best(whole, runs=2)[0]


def matplotlib_film(recording: Recording, quality: str, folder: Path, frames: int = 40) -> float:
    """Give frames per second of the same chase by matplotlib's FFMpegWriter with the same encoder settings."""
    import imageio_ffmpeg
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt
    from matplotlib.animation import FFMpegWriter
    from matplotlib.collections import LineCollection
    from matplotlib.patches import Circle

    mpl.rcParams["animation.ffmpeg_path"] = imageio_ffmpeg.get_ffmpeg_exe()
    stage = Composition(recording, SIZE, Look(), yuv=True)
    paths = stage.scene.paths
    moments = list(stage.times(FPS))[stage.length(FPS) // 3 :][:frames]
    lines = [np.stack([paths.spots(time) for time in np.linspace(max(moment - 25, 0), moment, 50)]) for moment in moments]
    figure, axes = plt.subplots(figsize=(19.2, 10.8), dpi=100)
    axes.set(xlim=(-10, 110), ylim=(-10, 60), aspect="equal", title=recording.scenario.title)
    for centre, radius in zip(recording.obstacle_position, recording.obstacle_radius, strict=True):
        axes.add_patch(Circle(centre, radius, color="grey"))
    axes.add_patch(Circle(recording.scenario.target.position, recording.scenario.target.radius, color="green", alpha=0.4))
    dots = axes.scatter(np.zeros(paths.count), np.zeros(paths.count), c=np.where(paths.is_prey, "C0", "C1"), zorder=3)
    trails = axes.add_collection(LineCollection([], linewidths=2, alpha=0.5))
    clock = axes.text(0, 55, "")
    writer = FFMpegWriter(fps=FPS, codec="libx264", extra_args=[*format_of(Path("a.mp4"), quality).output[2:8]])
    start = time.perf_counter()
    with writer.saving(figure, str(folder / "matplotlib.mp4"), dpi=100):
        for moment, spots in zip(moments, lines, strict=True):
            dots.set_offsets(spots[-1])
            trails.set_segments(list(spots.transpose(1, 0, 2)))
            clock.set_text(f"{moment:.1f} s")
            writer.grab_frame()
    return len(moments) / (time.perf_counter() - start)


def main() -> None:
    """Measure, print, and write a table that names the machine."""
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("-o", "--output", type=Path, default=Path("out/film-speed.csv"))
    arguments.add_argument("--without-matplotlib", action="store_true")
    chosen = arguments.parse_args()
    where = f"{machine()}, {os.cpu_count()} cores"
    rows: list[tuple[str, float]] = []

    def note(what: str, rate: float) -> None:
        rows.append((what, rate))
        print(f"{what:<64} {rate:8.1f} frames/s", flush=True)

    trials = chases(16)
    chase = trials[0]
    note("rasterising, Delft chase with trails, 1080p", rasterised(chase))
    note("rasterising, 16 chases in a grid, 1080p", rasterised(trials))
    many = crowd(100_000)
    assert many.prey.count >= CROWDED
    note("rasterising, 100 000 agents as a heat map, 1080p", rasterised(many))
    note("rasterising, 19 000 agents one by one, 1080p", rasterised(crowd(19_000)))
    with tempfile.TemporaryDirectory() as name:
        for quality in render.QUALITIES:
            film, alone = encoded(chase, quality, Path(name))
            note(f"whole film, Delft chase, 1080p, {quality}", film)
            note(f"the same encoder with ready-made frames, 1080p, {quality}", alone)
        note("whole film, 100 000 agents that are simulated live, 1080p, draft", filmed_live(100_000, Path(name)))
        for kind, called in (("WebM", "chase.webm"), ("PNG", "chase")):
            for clear in (False, True):
                what = "without a ground" if clear else "with its ground"
                note(f"whole film, Delft chase {what}, 720p, good, {kind}", filmed(chase, called, Path(name), clear=clear))
        if not chosen.without_matplotlib:
            note("matplotlib's FFMpegWriter, the same chase, 1080p, good", matplotlib_film(chase, "good", Path(name)))
    chosen.output.parent.mkdir(parents=True, exist_ok=True)
    with chosen.output.open("w", newline="") as file:
        table = csv.writer(file)
        table.writerow(("what", "frames_per_second", "machine"))
        table.writerows((what, f"{rate:.2f}", where) for what, rate in rows)


if __name__ == "__main__":
    main()
