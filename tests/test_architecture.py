"""The rules of the house: who may import whom, and that start-up stays light."""

import ast
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]

# Each file imports only from files above it (CONTRIBUTING, "The house").
ORDER = [
    "files",
    "registry",
    "explain",
    "fit",
    "scenario",
    "start",
    "presets",
    "neighbours",
    "runtime",
    "lanes",
    "rng",
    "launch",
    "cells",
    "places",
    "walks",
    "sorting",
    "grid",
    "flocking",
    "partition",
    "exchange",
    "clustering",
    "yardstick",
    "avoidance",
    "prey",
    "predators",
    "layout",
    "spawn",
    "observe",
    "traps",
    "measure",
    "contact",
    "sense",
    "step",
    "drive",
    "move",
    "trials",
    "carry",
    "visit",
    "stride",
    "verdict",
    "seeds",
    "progress",
    "results",
    "recording",
    "states",
    "crowds",
    "swarm",
    "batch",
    "deadlocks",
    "metrics",
    "single",
    "axes",
    "designs",
    "ledger",
    "intervals",
    "game",
    "report",
    "contest",
    "studies",
    "sheets",
    "tables",
    "throughput",
    "cli",
    "__main__",
]


def _imports(file: Path) -> set[str]:
    """Name the modules of tiswarm and render that a file imports anywhere in it."""
    found = set()
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found.add(node.module)
            found |= {f"{node.module}.{alias.name}" for alias in node.names}
    return {name for name in found if name.split(".")[0] in ("tiswarm", "render")}


def _home(name: str) -> str | None:
    parts = name.split(".")
    return parts[1] if len(parts) > 1 and parts[1] in ORDER else None


def test_every_file_has_its_place_in_the_order():
    names = {file.stem for file in (ROOT / "tiswarm").glob("*.py")} | {
        file.parent.name for file in (ROOT / "tiswarm").glob("*/*.py")
    }
    assert names - {"__init__", "tiswarm"} == set(ORDER)


def test_each_file_imports_only_from_files_above_it():
    for file in (ROOT / "tiswarm").rglob("*.py"):
        own = file.stem if file.parent.name == "tiswarm" else file.parent.name
        if own == "__init__":
            continue
        for name in _imports(file):
            home = _home(name)
            if home is not None and home != own:
                assert ORDER.index(home) < ORDER.index(own), f"{file.name} imports {name}"


def test_only_the_command_line_knows_render():
    for file in (ROOT / "tiswarm").rglob("*.py"):
        if file.parent.name != "cli":
            assert not any(name.startswith("render") for name in _imports(file)), file


def test_render_knows_recordings_and_little_else():
    # lanes: what the compiler makes one instruction of is the same for pictures as for terms.
    allowed = {"recording", "metrics", "files", "runtime", "lanes", None}
    for file in (ROOT / "render").rglob("*.py"):
        homes = {_home(name) for name in _imports(file) if name.startswith("tiswarm")}
        assert homes <= allowed, file


def test_listing_and_help_do_not_wait_for_taichi():
    code = "import sys; sys.argv = ['tiswarm', 'presets']\nimport tiswarm.cli\n"
    code += "try:\n    tiswarm.cli.main()\nexcept SystemExit:\n    pass\n"
    code += "import render; assert 'taichi' not in sys.modules and 'matplotlib' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True, capture_output=True)
