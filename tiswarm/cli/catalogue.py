"""Catalogue: what there is to run, and what a scenario looks like written out."""

import sys
from typing import Annotated

import typer
from rich.markup import escape
from rich.table import Table

from tiswarm.cli.options import Sets, StrategyPath, WrongInput, load_scenario, out, with_common_options


@with_common_options
def presets(
    strategy_path: StrategyPath = None,
) -> None:
    """List presets, studies and strategies, with one line each."""
    from tiswarm.scenario import presets as shelf
    from tiswarm.strategies import registry

    for folder in strategy_path or []:
        registry.add_path(folder)
    table = Table(box=None, show_header=False, pad_edge=False)
    for name in shelf.presets():
        table.add_row(name, escape(shelf.title(name)))
    out.print(table)
    out.print("\nStudies, for 'tiswarm bench':")
    table = Table(box=None, show_header=False, pad_edge=False)
    for name in shelf.study_names():
        table.add_row(name, shelf.read_toml(shelf.preset_folder() / "studies" / f"{name}.toml").get("title", ""))
    out.print(table)
    for kind in registry.KINDS:
        key = "prey.avoidance" if kind == "avoidance" else f"{kind}.strategy"
        out.print(f"\n{kind.capitalize()}, for '--set {key}=...':")
        table = Table(box=None, show_header=False, pad_edge=False)
        for name, line in registry.described(kind).items():
            table.add_row(name, line)
        out.print(table)


@with_common_options
def show(
    preset: Annotated[
        str | None, typer.Argument(metavar="[PRESET]", help="A preset's name or the path of a TOML file.")
    ] = None,
    sets: Sets = None,
    schema: Annotated[bool, typer.Option("--schema", help="Print the JSON Schema of a scenario instead.")] = False,
    strategy_path: StrategyPath = None,
) -> None:
    """Print a scenario as TOML, defaults filled in."""
    import json

    from tiswarm.engine.choice import engine_of, reason_of
    from tiswarm.scenario.model import Scenario
    from tiswarm.strategies import registry

    for folder in strategy_path or []:
        registry.add_path(folder)
    if schema:
        sys.stdout.write(json.dumps(Scenario.model_json_schema(), indent=2) + "\n")
    elif preset is None:
        raise WrongInput("show: name a preset, for example 'tiswarm show delft/pronav-10', or use --schema")
    else:
        scenario = load_scenario(preset, sets)
        sys.stdout.write(f"# engine: {engine_of(scenario)} ({reason_of(scenario)})\n{scenario.to_toml()}")
