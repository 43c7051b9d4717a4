"""Speed: how fast this machine is, and how far from README's figures."""

import json
import sys
from collections.abc import Mapping
from typing import Annotated

import typer
from rich.table import Table

from tiswarm.cli.options import Precision, Quiet, Seed, Threads, out, start
from tiswarm.version import __version__


def speed(
    as_json: Annotated[bool, typer.Option("--json", help="Print the figures as JSON on standard output.")] = False,
    seed: Seed = 0,
    threads: Threads = None,
    precision: Precision = "f32",
    quiet: Quiet = False,
) -> None:
    """Measure this machine's throughput, with the work stated, beside README's figures."""
    from tiswarm.engine.throughput import PUBLISHED_ON, WORK, measure
    from tiswarm.simd import runtime
    from tiswarm.system.machine import processor, vector_bits

    start(seed, threads, precision)
    machine = {
        "processor": processor(),
        "threads": runtime.start().threads,
        "vector_bits": vector_bits(),
        "precision": precision,
    }
    timings = {}
    for work in WORK:
        if not quiet and sys.stderr.isatty():
            sys.stderr.write(f"\rmeasuring {work.title} ...\033[K\r")
        timings[work] = measure(work, seed)
    if as_json:
        figures = [
            {
                "work": work.title,
                "trials": work.trials,
                "rate": round(timing.rate),
                "published": work.published,
                "share": round(timing.rate / work.published, 3),
                "first_call_s": round(timing.first_call, 2),
            }
            for work, timing in timings.items()
        ]
        told = {"tiswarm": __version__, "machine": machine, "published_on": PUBLISHED_ON, "figures": figures}
        sys.stdout.write(json.dumps(told, indent=2) + "\n")
        return
    table = Table(title=_line(machine), title_justify="left", caption=f"README: {_line(PUBLISHED_ON)}", caption_justify="left")
    for head in ("work", "trials", "trials/s", "README's", "share", "first call [s]"):
        table.add_column(head, justify="left" if head == "work" else "right")
    for work, timing in timings.items():
        rates = f"{timing.rate:,.0f}", f"{work.published:,}", f"{timing.rate / work.published:.2f}"
        table.add_row(work.title, f"{work.trials:,}", *rates, f"{timing.first_call:.1f}")
    out.print(table)


def _line(machine: Mapping[str, object]) -> str:
    """Say what a machine is, in a line."""
    return "{processor}, {threads} threads, vectors of {vector_bits} bits, {precision}".format_map(machine)
