"""Worker: what a worker is told and does: it checks that its code is the client's, and runs a slice."""

import threading
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from tiswarm.engine.slices import Part, Span, run_spans
from tiswarm.engine.trials import kernel
from tiswarm.engine.trials.candidates import Candidates
from tiswarm.scenario.model import Scenario
from tiswarm.simd import backend, runtime
from tiswarm.simd.runtime import Precision
from tiswarm.strategies import registry
from tiswarm.studies.store import code_hash
from tiswarm.version import __version__

_one = threading.Lock()


class OtherCode(ValueError):
    """A worker has another state of the code than the client; the message names both."""


@dataclass(frozen=True)
class Task:
    """A slice as it travels: scenarios as JSON, their hashes, and what the client's code is.

    threads: of Taichi, the worker's own number when None; folders: where strategies of the user's are.
    """

    scenarios: tuple[str, ...]
    hashes: tuple[str, ...]
    spans: tuple[Span, ...]
    company: tuple[str, ...]
    counts: tuple[int, int, int]
    seed: int
    precision: Precision
    threads: int | None
    folders: tuple[str, ...]
    identity: str


@dataclass(frozen=True)
class Generation:
    """Candidates of one scenario, or some of their trials, as they travel: `bounds` to `networks` are those of `Candidates`.

    All else is as in `Task`.
    """

    scenario: str
    hash: str
    bounds: Mapping[str, tuple[float, float]]
    values: np.ndarray
    trials: np.ndarray
    networks: Mapping[str, np.ndarray] | None
    seed: int
    precision: Precision
    threads: int | None
    folders: tuple[str, ...]
    identity: str


def run(task: Task) -> list[Part]:
    """Run a task, one at a time in a process: it has one Taichi, which uses as many threads as the worker has.

    Errors: OtherCode; ValueError for scenarios that are others here (a network's file differs); as `run_spans`.
    """
    with _one:
        scenarios = _begun(task, task.company, task.scenarios, task.hashes)
        return run_spans(scenarios, task.spans, task.seed, _read(task.company), task.counts)


def run_candidates(task: Generation) -> Part:
    """Run candidates through trials; give what each came to: name -> [candidate * trial].

    Errors: OtherCode; ValueError as `run`; as `Candidates`.
    """
    with _one:
        [scenario] = _begun(task, (task.scenario,), (task.scenario,), (task.hash,))
        results = Candidates(scenario, task.bounds).run(task.values, task.trials, task.seed, task.networks)
        return {name: getattr(results, name) for name in kernel.OUTCOMES}, results.measures


def _begun(
    task: Task | Generation, company: tuple[str, ...], scenarios: tuple[str, ...], hashes: tuple[str, ...]
) -> Sequence[Scenario]:
    """Compare code and scenarios with the client's, start Taichi as it asks; give the scenarios. Errors: OtherCode."""
    own = identity(task.folders, company)
    if own != task.identity:
        raise OtherCode(difference(_address(), own, task.identity))
    found = [Scenario.from_json(text) for text in scenarios]
    for scenario, name in zip(found, hashes, strict=True):
        if scenario.hash() != name:
            raise OtherCode(f"worker {_address()} reads another file of a network; give all workers the client's files")
    runtime.init(task.precision, task.threads or _threads())
    return found


@cache
def identity(folders: tuple[str, ...], company: tuple[str, ...]) -> str:
    """Name the code that runs such scenarios in this process. Errors: ValueError without the user's strategies."""
    for folder in folders:
        registry.add_path(Path(folder))
    return f"tiswarm {__version__}, taichi {backend.version()}, code {code_hash(_read(company))}"


@cache
def _read(texts: tuple[str, ...]) -> Sequence[Scenario]:
    return [Scenario.from_json(text) for text in texts]


def difference(worker: str, own: str, client: str) -> str:
    """Tell in one line that a worker has other code."""
    return f"worker {worker} has other code ({own}) than this client ({client}); install the same state on both"


def _address() -> str:
    from distributed import get_worker

    return str(get_worker().address)


def _threads() -> int:
    from distributed import get_worker

    return int(get_worker().state.nthreads)
