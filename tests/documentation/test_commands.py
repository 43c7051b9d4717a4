"""What README and the pages tell people to type: every command and every key in it exists, and the light ones run."""

import ast
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
import typer.main

import render
import tiswarm
from tiswarm.cli.entry import app
from tiswarm.cli.options import assignment
from tiswarm.learning import keys
from tiswarm.scenario import presets
from tiswarm.studies.design import find_study

pytestmark = pytest.mark.quick

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
FENCE = re.compile(r"^```(\w*).*?\n(.*?)^```", re.MULTILINE | re.DOTALL)
INLINE = re.compile(r"`(tiswarm [^`]+)`")
LIGHT = ("presets", "show")
"""Verbs that take no time."""


def _typed():
    """List what pages say to type, in fences, with the page: continued lines joined, remarks cut."""
    found = set()
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        blocks = [body for language, body in FENCE.findall(text) if language in ("", "console", "sh")]
        for line in (line for body in blocks for line in body.replace("\\\n", " ").splitlines()):
            typed = re.sub(r"\s#.*$", "", line.removeprefix("$ ")).strip()
            found |= {
                (page.name, command) for command in re.split(r"\s+(?:&&|>|\|)\s+", typed) if command.startswith("tiswarm ")
            }
    return sorted(found)


TYPED = _typed()
MENTIONED = sorted({(page.name, command) for page in PAGES for command in INLINE.findall(page.read_text(encoding="utf-8"))})
FAULTS = {"prey.strategy=explod"}
"""What a page shows being refused."""


def _verb(command):
    """Give the words behind a verb, and the verb; None where only the program's own options follow."""
    words = shlex.split(command)[1:]
    line = typer.main.get_command(app)
    if words[0].startswith("-"):
        assert any(words[0] in each.opts for each in line.params) or words[0] == "--help", command
        return [], None
    assert words[0] in line.commands, command
    return words[1:], line.commands[words[0]]


def test_pages_tell_what_to_type():
    assert len(TYPED) > 40
    assert {command.split()[1] for _, command in TYPED} >= set(typer.main.get_command(app).commands)


@pytest.mark.parametrize(("page", "command"), TYPED, ids=lambda value: value)
def test_a_command_is_one_that_the_parser_takes(page, command):
    words, verb = _verb(command)
    if verb is not None and "--help" not in words:
        _check_scenario(verb.make_context(verb.name, list(words)).params)


@pytest.mark.parametrize(("page", "command"), MENTIONED, ids=lambda value: value)
def test_a_command_that_is_mentioned_has_known_options(page, command):
    words, verb = _verb(command.partition(" > ")[0])
    if verb is not None:
        known = {option for each in verb.params for option in each.opts} | {"--help"}
        assert {word.partition("=")[0] for word in words if word.startswith("-")} <= known, command
        if not any(re.search(r"\.\.\.|[A-Z]{2}", word) for word in words):  # else it says what may stand there
            _check_scenario(verb.make_context(verb.name, list(words), resilient_parsing=True).params)


def _check_scenario(given):
    """Load what a command names, with what it sets, unless it is a file of the reader's."""
    named = given.get("preset") or given.get("source") or given.get("name") or ""
    if given.get("study"):
        assert given["study"].endswith(".toml") or find_study(given["study"]).is_file()
    known = named in presets.presets() or f"demo/{named}" in presets.presets()
    assert known or not named or "." in named, f"no preset {named}"
    if known:
        sets = [each for each in given.get("sets") or [] if each not in FAULTS]
        scenario = tiswarm.load(named, dict(assignment(each) for each in sets))
        if given.get("over"):
            keys.arms([scenario], dict(keys.read(each) for each in given["over"]), given.get("network") or "")
    for name in (given.get("versus") or "").split(","):
        if name and known:
            tiswarm.load(named, {"prey.strategy": name})


@pytest.mark.parametrize("command", sorted({command for _, command in TYPED if command.split()[1] in LIGHT}))
def test_a_light_command_runs(command, tmp_path):
    for name in re.findall(r"\S+\.toml", command):
        (tmp_path / name).write_text('base = "delft/pronav-10"\n')
    done = subprocess.run(
        [sys.executable, "-m", *shlex.split(command)], cwd=tmp_path, capture_output=True, text=True, check=False, timeout=60
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout


FENCED = [(page.name, *fence) for page in PAGES for fence in FENCE.findall(page.read_text(encoding="utf-8"))]
SNIPPETS = sorted({(page, body) for page, language, body in FENCED if language == "python"})


@pytest.mark.parametrize(("page", "code"), SNIPPETS, ids=[f"{page}-{k}" for k, (page, _) in enumerate(SNIPPETS)])
def test_python_in_pages_uses_names_that_there_are(page, code):
    for node in ast.walk(ast.parse(code)):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in ("tiswarm", "render"):
            assert hasattr({"tiswarm": tiswarm, "render": render}[node.value.id], node.attr), f"{page}: {ast.unparse(node)}"
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and ast.unparse(node.func) == "tiswarm.load":
            preset, *changes = [ast.literal_eval(each) for each in node.args]
            if not preset.endswith(".toml"):
                tiswarm.load(preset, *changes)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_presets_in_toml_load(page, tmp_path):
    for k, (language, body) in enumerate(FENCE.findall(page.read_text(encoding="utf-8"))):
        if language == "toml" and re.search(r"^base *=", body, re.MULTILINE) and "[[axes]]" not in body:
            file = tmp_path / f"{k}.toml"
            file.write_text(body, encoding="utf-8")
            tiswarm.load(file)
