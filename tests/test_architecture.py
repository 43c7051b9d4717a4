"""The rules of the house: who may import whom, and that start-up stays light."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.quick

ROOT = Path(__file__).parents[1]
WITHOUT_TAICHI = ("system", "scenario", "strategies/registry.py", "strategies/lane_rules.py", "space/box.py", "space/cells.py")


def _ladder() -> list[str]:
    """Read the packages from CONTRIBUTING's table, lowest first."""
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    return re.findall(r"^\| `(\w+)/` \|", text, re.MULTILINE)


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


def _package(name: str, ladder: list[str]) -> str | None:
    """Give the package of a module's name, None for what stands beside the packages (the public names, the version)."""
    parts = name.split(".")
    if parts[0] == "render":
        return "render"
    return parts[1] if len(parts) > 1 and parts[1] in ladder else None


def test_every_package_has_its_place_in_contributing():
    packages = {folder.parent.name for folder in (ROOT / "tiswarm").glob("*/__init__.py")}
    ladder = _ladder()
    assert sorted(ladder) == sorted(packages | {"render"})
    assert ladder[-1] == "cli"


def test_the_table_says_what_each_package_says_of_itself():
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    for package in _ladder():
        folder = ROOT / package if package == "render" else ROOT / "tiswarm" / package
        first = ast.get_docstring(ast.parse((folder / "__init__.py").read_text(encoding="utf-8"))).splitlines()[0]
        assert f"| `{package}/` | {first.partition(': ')[2]} |" in text, package


def test_a_package_imports_only_from_those_above_it():
    ladder = _ladder()
    for file in [*(ROOT / "tiswarm").rglob("*.py"), *(ROOT / "render").rglob("*.py")]:
        own = _package(".".join(file.relative_to(ROOT).with_suffix("").parts), ladder)
        for name in _imports(file) if own else ():
            other = _package(name, ladder)
            if other is not None and other != own:
                assert ladder.index(other) < ladder.index(own), f"{file.relative_to(ROOT)} imports {name}"
                assert {own, other} != {"studies", "render"}, f"{file.relative_to(ROOT)} imports {name}"


def test_what_is_read_before_a_run_imports_no_taichi():
    for place in WITHOUT_TAICHI:
        path = ROOT / "tiswarm" / place
        for file in path.rglob("*.py") if path.is_dir() else [path]:
            tree = ast.parse(file.read_text(encoding="utf-8"))
            modules = [alias.name for node in tree.body if isinstance(node, ast.Import) for alias in node.names]
            modules += [node.module for node in tree.body if isinstance(node, ast.ImportFrom)]
            assert not any(name.split(".")[0] == "taichi" for name in modules), file


def test_listing_and_help_do_not_wait_for_taichi():
    code = "import sys; sys.argv = ['tiswarm', 'presets']\nimport tiswarm.cli\n"
    code += "try:\n    tiswarm.cli.main()\nexcept SystemExit:\n    pass\n"
    code += "import render; assert 'taichi' not in sys.modules and 'matplotlib' not in sys.modules"
    subprocess.run([sys.executable, "-c", code], check=True, capture_output=True)
