"""What a live page takes: frames a second, and the time from a slider to the frame that heeds it.

    python tests/benchmarks/live.py [--browser]

Frames are counted by a reader without a browser, which checks that their ticks go up, and which times how long a number takes
from its being sent to the frame that heeds it; `--browser` times a slider in Chromium,
from its event to the frame that heeds it, and to the picture of it, and how long the page takes to lay out a frame. Without a
graphics card the browser draws on the processor, which is most of what the last of these times take.
"""

import sys
import tempfile
import time
from pathlib import Path
from statistics import median

sys.path.insert(0, str(Path(__file__).parents[1] / "render"))
from browser import Browser
from live_server import Live

import tiswarm

SECONDS = 8.0
SLIDES = 40

HAWK = ("prey.count=200", "world.ticks=100000")

TIMED = """const [value, done] = arguments, page = tiswarm.page, before = page.heard;
const slider = document.getElementById('knob-prey.weights.fear'), shown = page.shown;
const begin = performance.now(); let heard = 0;
page.shown = (frame) => { shown.call(page, frame); if (!heard && frame.heard > before) heard = performance.now() - begin; };
slider.value = value; slider.dispatchEvent(new Event('input'));
const look = () => {
  if (!heard) { requestAnimationFrame(look); return; }
  delete page.shown; requestAnimationFrame(() => setTimeout(() => done([heard, performance.now() - begin])));
};
requestAnimationFrame(look);"""


def frames(server: Live, speed: float) -> tuple[float, float]:
    """Give frames and ticks a second."""

    async def deed(reader):
        await reader.say(act="speed", speed=speed)
        await reader.until(lambda r: r.known.get("state", {}).get("speed") == speed and r.frame)
        scene, first, count, begin = reader.frame["scene"], reader.frame["tick"], reader.frames, time.perf_counter()
        tick = first
        while time.perf_counter() - begin < SECONDS:
            await reader.next()
            assert reader.frame["scene"] == scene
            assert reader.frame["tick"] >= tick
            tick = reader.frame["tick"]
        took = time.perf_counter() - begin
        return (reader.frames - count) / took, (tick - first) / took

    return server.read(deed)


def answers(server: Live, knob: str, value: float) -> list[float]:
    """Give the times from a number's being sent to the frame that heeds it [s]. It stays what it was, but for its last digits.

    Otherwise what is measured next is another swarm: one without separation crowds together, and its ticks take thrice as long.
    """

    async def deed(reader):
        took = []
        for n in range(SLIDES):
            begin, before = time.perf_counter(), reader.frame["heard"] if reader.frame else 0
            await reader.say(act="set", path=knob, value=value * (1 + 1e-6 * (n + 1)))
            await reader.until(lambda r, before=before: r.frame is not None and r.frame["heard"] > before)
            took.append(time.perf_counter() - begin)
        return took

    return server.read(deed)


def sliders(server: Live, speed: float) -> None:
    """Time a slider, from its event."""
    with tempfile.TemporaryDirectory() as folder:
        browser = Browser(Path(folder))
        try:
            browser.look(1280, 900, calm=False)
            browser.visit(server.address)
            browser.run("tiswarm.clock.pace(arguments[0])", speed)
            browser.until("return tiswarm.page.state.speed === arguments[0]", speed)
            browser.driver.set_script_timeout(20)
            took = [browser.driver.execute_async_script(TIMED, 2 + n / 10) for n in range(SLIDES)]
            heard, drawn = zip(*took, strict=True)
            layout = browser.run("return tiswarm.stage.took")
            told = f"slider to frame {median(heard):.0f} ms (most {max(heard):.0f}), to picture {median(drawn):.0f} ms"
            print(f"  speed {speed:g}: {told}, a frame is laid out in {1000 * median(layout):.1f} ms")
        finally:
            browser.driver.quit()


def main() -> None:
    """Measure both swarms."""
    for preset, sets in (("m20/hawk", HAWK), ("demo/murmuration", ("world.ticks=100000",))):
        server, separation = Live(preset, sets=sets), tiswarm.load(preset).prey.separation
        try:
            server.read(lambda reader: reader.until(lambda r: r.frame is not None))
            for speed in (1, 5, 10):
                print("{}, speed {}: {:.0f} frames/s, {:.0f} ticks/s".format(preset, speed, *frames(server, speed)), flush=True)
                took = answers(server, "prey.separation", separation)
                print(f"  number to frame {1000 * median(took):.0f} ms (most {1000 * max(took):.0f})", flush=True)
            if "--browser" in sys.argv and preset == "m20/hawk":
                for speed in (1, 5, 10):
                    sliders(server, speed)
        finally:
            server.interrupt()


main()
