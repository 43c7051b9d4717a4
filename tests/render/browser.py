"""A real browser for tests: Debian's Chromium, steered by Selenium."""

import io
import os
import shutil
import time
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--hide-scrollbars",
)

WITHOUT_WEBGL = """
const given = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
  return kind === "webgl2" ? null : given.call(this, kind, ...more);
};
"""


def missing() -> str | None:
    """Say what a browser test needs and does not find."""
    try:
        import selenium  # noqa: F401
    except ImportError:
        return "Selenium is not installed: pip install selenium"
    absent = [name for name in ("chromium", "chromedriver") if shutil.which(name) is None]
    return f"no {' and no '.join(absent)} found: apt-get install chromium chromium-driver" if absent else None


class Browser:
    """A window that pages are opened in."""

    def __init__(self, folder: Path):
        """Start the browser; `folder` holds its profile."""
        from selenium import webdriver
        from selenium.webdriver.chrome.service import Service

        options = webdriver.ChromeOptions()
        options.binary_location = shutil.which("chromium")
        for flag in (*FLAGS, f"--user-data-dir={folder}"):
            options.add_argument(flag)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.driver = webdriver.Chrome(options=options, service=Service(shutil.which("chromedriver")))
        self._blind = None
        self.look()

    def look(self, width: int = 1280, height: int = 900, *, theme: str = "dark", calm: bool = True, webgl: bool = True) -> None:
        """Choose the window's size and what its reader prefers. calm: reduced motion."""
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        features = {"prefers-color-scheme": theme, "prefers-reduced-motion": "reduce" if calm else "no-preference"}
        self.ask("Emulation.setEmulatedMedia", features=[{"name": k, "value": v} for k, v in features.items()])
        if self._blind is not None:
            self.ask("Page.removeScriptToEvaluateOnNewDocument", identifier=self._blind)
            self._blind = None
        if not webgl:
            self._blind = self.ask("Page.addScriptToEvaluateOnNewDocument", source=WITHOUT_WEBGL)["identifier"]

    def ask(self, command: str, **arguments):
        """Ask the browser itself for something, by the protocol of its developers' tools."""
        return self.driver.execute_cdp_cmd(command, arguments)

    def open(self, path: Path, where: str = "") -> None:
        """Open a page and wait until it is there."""
        self.driver.get("about:blank")
        self.complaints()
        self.driver.get(path.as_uri() + where)
        self.until("return document.body.dataset.ready === 'true' || document.body.dataset.view === 'failed'")

    def visit(self, address: str) -> None:
        """Open the page of a simulation that runs, and wait until it is shown."""
        self.driver.get("about:blank")
        self.complaints()
        self.driver.get(address)
        self.until("return document.body.dataset.ready === 'true'", seconds=60)
        self.run("tiswarm.scene = () => tiswarm.stage.scenes[0].recording")

    def run(self, script: str, *arguments):
        """Run a script in the page and give what it returns."""
        return self.driver.execute_script(script, *arguments)

    def until(self, script: str, *arguments, seconds: float = 30) -> None:
        """Wait until a script returns something true."""
        last = time.monotonic() + seconds
        while not self.run(script, *arguments):
            if time.monotonic() > last:
                raise AssertionError(f"never came true: {script}")
            time.sleep(0.02)

    def drawn(self) -> None:
        """Wait until what was asked for is on the screen."""
        self.until("return !tiswarm.stage.stale")
        self.driver.execute_async_script("requestAnimationFrame(() => requestAnimationFrame(arguments[0]))")

    def press(self, *keys: str) -> None:
        """Press keys, wherever the focus is."""
        from selenium.webdriver import ActionChains

        ActionChains(self.driver).send_keys(*keys).perform()

    def point(self, x: float, y: float) -> None:
        """Move the pointer to a place on the stage."""
        from selenium.webdriver import ActionChains

        canvas = self.find("stage")
        box = canvas.rect
        across, down = round(x - box["width"] / 2), round(y - box["height"] / 2)
        ActionChains(self.driver, duration=0).move_to_element_with_offset(canvas, across, down).perform()

    def click(self, x: float, y: float) -> None:
        """Click on a place on the stage."""
        from selenium.webdriver import ActionChains

        self.point(x, y)
        ActionChains(self.driver, duration=0).click().perform()

    def drag(self, start: np.ndarray, end: np.ndarray) -> None:
        """Drag from one place on the stage to another."""
        from selenium.webdriver import ActionChains

        self.point(*start)
        dx, dy = (round(each) for each in end - start)
        ActionChains(self.driver, duration=50).click_and_hold().move_by_offset(dx, dy).release().perform()

    def find(self, name: str):
        """Find a part of the page."""
        return self.driver.find_element("id", name)

    def text(self, name: str) -> str:
        """Give the words of a part of the page."""
        return self.run("return document.getElementById(arguments[0]).textContent", name)

    def picture(self) -> np.ndarray:
        """Give what the stage shows: [y, x, channel], 0 to 255."""
        self.drawn()
        box = self.run(
            "const b = document.getElementById('stage').getBoundingClientRect(); return [b.x, b.y, b.width, b.height]"
        )
        shot = Image.open(io.BytesIO(self.driver.get_screenshot_as_png())).convert("RGB")
        x, y, width, height = (round(each) for each in box)
        return np.asarray(shot)[y : y + height, x : x + width].astype(int)

    def complaints(self) -> list[str]:
        """Give what the page has written to the console since last asked: errors, and warnings of its own."""
        logs = self.driver.get_log("browser")
        return [each["message"] for each in logs if "GPU stall due to ReadPixels" not in each["message"]]


def started(folder: Path) -> Browser:
    """Start a browser, or skip the test with the reason; where CI asks for one, its absence is a failure."""
    reason = missing()
    if reason and os.environ.get("TISWARM_BROWSER") == "required":
        pytest.fail(reason)
    if reason:
        pytest.skip(reason)
    return Browser(folder)


def shade(code: str) -> np.ndarray:
    return np.array([int(code[n : n + 2], 16) for n in (1, 3, 5)])


def pixels(window, spots: np.ndarray, scene: int = 0) -> np.ndarray:
    """Map metres to pixels of the stage by what the camera says of itself: [point, 2]."""
    script = "const {middle, centre, scale} = tiswarm.stage.scenes[arguments[0]].lens; return [middle, centre, scale]"
    middle, centre, scale = window.run(script, scene)
    return np.array(middle) + (spots - centre) * np.array([scale, -scale])


def assert_agents(window, recording, tick: int, theme) -> None:
    """Check that each agent's colour is where the recording says, and not where it says for another tick."""
    picture = window.picture()
    hues = [shade(theme.prey[group]) for group in recording.prey.group[tick]]
    for place, hue in zip(recording.prey.position[tick], hues, strict=True):
        x, y = np.round(pixels(window, place)).astype(int)
        assert np.abs(picture[y, x] - hue).max() <= 12, (tick, x, y)
    for place in recording.predators.position[tick]:
        x, y = np.round(pixels(window, place)).astype(int)
        assert np.abs(picture[y, x] - shade(theme.predator)).max() <= 12, (tick, x, y)
