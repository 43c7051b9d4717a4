"""Commands: the reference of the command line, from its own parser."""

from typing import Any

import typer.main

from tiswarm.cli.entry import app

INTRODUCTION = """# Command line

Every verb takes `--seed`, `--threads`, `--precision f32|f64`, `--quiet` and `--help`. Exit codes: 0; 2 for wrong input, 1 for a
fault of the machine (no space, no memory), both with one line on standard error; 130 after Ctrl-C. `tiswarm --version` tells
the versions of tiswarm, Taichi and ffmpeg.
"""


def page() -> str:
    """Write the page."""
    parts = [INTRODUCTION]
    for name, verb in typer.main.get_command(app).commands.items():  # type: ignore[attr-defined]
        usage = " ".join(_shown(each) for each in verb.params if each.param_type_name == "argument")
        parts += [
            f"## `tiswarm {name}`\n",
            f"```console\ntiswarm {name} {usage}".rstrip() + " [OPTIONS]\n```\n",
            f"{verb.help}\n",
        ]
        rows = [_row(each) for each in verb.params]
        parts += ["| | | default |", "|---|---|---|", *rows, ""]
    return "\n".join(parts)


def _shown(parameter: Any) -> str:
    return str(parameter.metavar or parameter.name.upper())


def _row(parameter: Any) -> str:
    flag = parameter.param_type_name == "argument"
    name = f"`{_shown(parameter)}`" if flag else ", ".join(f"`{each}`" for each in parameter.opts)
    value = f" `{parameter.metavar}`" if not flag and parameter.metavar else ""
    default = parameter.default
    plain = default is None or default is False or callable(default) or default == ""
    told = f"{name}{value}".replace("|", "\\|")
    return f"| {told} | {(parameter.help or '').replace('|', chr(92) + '|')} | {'' if plain else f'`{default}`'} |"
