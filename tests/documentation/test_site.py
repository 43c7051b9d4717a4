"""The site: built strictly, notebooks executed, complete, every link leads somewhere, and nothing is loaded from elsewhere."""

import os
import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urldefrag

import pytest

from tiswarm.scenario import presets

ROOT = Path(__file__).parents[2]
LOADING = {(tag, "src") for tag in ("script", "img", "video", "source", "iframe")} | {("link", "href"), ("use", "href")}
"""What a browser fetches by itself; an `a` only leads somewhere."""


class _Page(HTMLParser):
    """What a page loads, where it leads, and what may be led to."""

    def __init__(self, text):
        super().__init__()
        self.loads, self.leads, self.anchors = set(), set(), set()
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        held = dict(attrs)
        for name, value in attrs:
            if (tag, name) in LOADING and value and held.get("rel") != "canonical":
                self.loads.add(value)
            if (tag, name) == ("a", "href") and value:
                self.leads.add(value)
            if name in ("id", "name") and value:
                self.anchors.add(value)


def test_every_preset_has_a_frame_in_the_gallery():
    """Draw what is missing by: python docs/site/frames.py."""
    frames = {file.stem for file in (ROOT / "docs" / "gallery").glob("*.jpg")}
    assert frames == {name.replace("/", "-") for name in presets.presets()}


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    if os.environ.get("TISWARM_SITE") != "required":
        for module in ("material", "mkdocstrings", "jupytext", "nbclient", "ipykernel"):
            pytest.importorskip(module, reason='the site needs pip install -e ".[docs]"')
    folder = tmp_path_factory.mktemp("site")
    done = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "-d", str(folder)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
        timeout=400,
        env={**os.environ, "NO_MKDOCS_2_WARNING": "1"},
    )
    assert done.returncode == 0, done.stderr[-4000:]
    return folder


@pytest.fixture(scope="module")
def html(site):
    return {file: _Page(file.read_text(encoding="utf-8")) for file in site.rglob("*.html")}


def test_all_that_there_is_has_a_page(site, html):
    names = {file.relative_to(site).as_posix() for file in html}
    assert {f"tutorials/{file.stem}.html" for file in (ROOT / "docs" / "tutorials").glob("*.py")} <= names
    gallery = (site / "gallery.html").read_text(encoding="utf-8")
    assert all(f"gallery/{name.replace('/', '-')}.jpg" in gallery for name in presets.presets())
    assert 'id="tiswarm.simulate"' in (site / "reference" / "python.html").read_text(encoding="utf-8")
    assert "tiswarm tune" in (site / "reference" / "command-line.html").read_text(encoding="utf-8")


def test_tutorials_show_what_their_cells_gave(site):
    page = (site / "tutorials" / "first_film.html").read_text(encoding="utf-8")
    assert "impact_spread" in page
    assert page.count("<video") == 2
    assert (site / "tutorials" / "first_film-1.mp4").stat().st_size > 10_000
    assert "shell.py" not in page


def test_no_page_loads_anything_from_elsewhere(site, html):
    for file, page in html.items():
        for address in page.loads:
            assert not re.match(r"(\w+:)?//", address), f"{file.relative_to(site)} loads {address}"
    for file in site.rglob("*.css"):
        for address in re.findall(r"(?:url\(|@import )[\"']?([^\"')]+)", file.read_text(encoding="utf-8")):
            assert not re.match(r"(\w+:)?//", address), f"{file.relative_to(site)} loads {address}"


def test_every_link_within_the_site_leads_somewhere(site, html):
    for file, page in html.items():
        if file.name == "404.html":  # its links are absolute
            continue
        for address in page.leads | page.loads:
            if re.match(r"\w+:", address):
                continue
            path, anchor = urldefrag(unquote(address))
            target = (file.parent / path).resolve() if path else file
            assert target.exists(), f"{file.relative_to(site)} leads to {address}"
            if anchor and target in html and anchor != "__skip":
                assert anchor in html[target].anchors, f"{file.relative_to(site)} leads to {address}"


@pytest.mark.quick
@pytest.mark.parametrize("name", ["README.md", "CONTRIBUTING.md", "CHANGELOG.md"])
def test_links_of_pages_beside_the_docs_lead_to_files(name):
    for address in re.findall(r"\]\((?!\w+:)([^)#]+)[^)]*\)", (ROOT / name).read_text(encoding="utf-8")):
        assert (ROOT / address).exists(), f"{name} leads to {address}"
