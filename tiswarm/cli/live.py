"""Live: a page in which a simulation runs, and whose sliders turn it."""

import errno
import importlib.util
import webbrowser
from typing import Annotated

import typer

from tiswarm.cli.options import (
    Precision,
    Preset,
    Quiet,
    Seed,
    Sets,
    StrategyPath,
    Threads,
    WrongInput,
    load_scenario,
    out,
    prepare,
)

PORT = 8737


def live(
    preset: Preset,
    port: Annotated[
        int, typer.Option("--port", metavar="N", min=0, max=65_535, help="Port of the page; 0: any free one.")
    ] = PORT,
    trial: Annotated[int, typer.Option("--trial", metavar="K", min=0, help="Number of the trial to begin with.")] = 0,
    open_it: Annotated[bool, typer.Option("--open", help="Open the page in a browser.")] = False,
    sets: Sets = None,
    strategy_path: StrategyPath = None,
    seed: Seed = 0,
    threads: Threads = None,
    precision: Precision = "f32",
    quiet: Quiet = False,
) -> None:
    """Run a simulation in a page of this machine: turn its numbers, drop obstacles, see what a thousand trials say."""
    if importlib.util.find_spec("aiohttp") is None:
        raise WrongInput("live: aiohttp is not installed; pip install 'tiswarm[live]'")
    from render.live import serve
    from render.live.session import Begun
    from render.live.worker import Settings
    from tiswarm.simd.runtime import settings_of
    from tiswarm.simd.threads import check_threads

    prepare(seed, strategy_path)
    check_threads(settings_of(precision, threads).threads)  # type: ignore[arg-type] # Taichi starts in other processes
    begun = Begun(load_scenario(preset, sets), preset, tuple(sets or ()), seed, trial)

    def announce(address: str) -> None:
        out.print(address, markup=False)
        if not quiet:
            out.print("open this address in a browser of this machine; Ctrl-C ends it")
        out.file.flush()
        if open_it and not webbrowser.open(address):
            out.print("no browser was found; open the address yourself")

    try:
        serve(begun, Settings(precision, threads, tuple(each.resolve() for each in strategy_path or ())), port, announce)
    except OSError as error:
        if error.errno in (errno.EADDRINUSE, errno.EACCES):
            raise WrongInput(f"--port {port}: is taken; use another one, or --port 0 for any that is free") from None
        raise
