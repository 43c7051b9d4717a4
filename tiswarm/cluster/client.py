"""Client: gives slices to the workers of a Dask cluster, and again where they were lost, until every cell is whole."""

import logging
import time
import uuid
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from typing import Any, TypeVar

from tiswarm.cluster import worker
from tiswarm.cluster.slices import Batch, Gathered, Slice, cut
from tiswarm.engine.choice import engine_of
from tiswarm.engine.slices import Part
from tiswarm.records.results import Results
from tiswarm.simd import runtime
from tiswarm.simd.threads import available_threads
from tiswarm.studies.design import Cell
from tiswarm.system.extras import needed
from tiswarm.system.progress import deferring_interrupts

AHEAD = 2
"""Slices that wait at a worker, the one that runs included: it need not wait for the client."""

PATIENCE = 120.0
"""How long a scheduler that does not answer is waited for [s]: as long as one takes to be started anew."""

PAUSE = 0.02
"""How long the client sleeps between two looks at what is finished [s]."""

LOOK = 2.0
"""How often workers are counted [s]."""

_Piece = TypeVar("_Piece")


class Cluster:
    """A scheduler and its workers; a context manager. `run` runs cells as `run_study` wants them run.

    address: of a scheduler, tcp://HOST:PORT; the path of a scheduler file, NAME.json; or local, local:N for N workers on this
    machine, which are started and end with the client.

    workers: how many there are; most: how many there were at most. threads, folders: as given.
    """

    def __init__(self, address: str, threads: int | None = None, folders: Sequence[str] = ()) -> None:
        """Check the address; nothing is started yet.

        threads: of each worker; its own number when None. folders: of the user's strategies, as workers find them.

        Errors: ValueError for an address that is none; MissingExtra.
        """
        self._distributed = needed("cluster", "distributed")
        self._address, self.threads, self.folders = address, threads, tuple(folders)
        self._local = _local_workers(address)
        self._cluster: Any = None
        self._client: Any = None
        self._counted = 0.0
        self.workers = self.most = 0

    def __enter__(self) -> "Cluster":
        """Start or find the scheduler. Errors: RuntimeError when none answers."""
        for name in ("distributed", "distributed.worker", "distributed.scheduler", "distributed.nanny", "distributed.core"):
            logging.getLogger(name).setLevel(logging.CRITICAL)  # losses are met, and told in our own words
        if self._local:
            threads = self.threads or max(available_threads() // self._local, 1)
            with deferring_interrupts():
                self._cluster = self._distributed.LocalCluster(
                    n_workers=self._local,
                    threads_per_worker=threads,
                    memory_limit=0,
                    dashboard_address="127.0.0.1:0",  # None would ask for one port, and warn where it is taken
                    silence_logs=logging.CRITICAL,
                )
        self._connect(patience=0.0)
        return self

    def __exit__(self, *_: Any) -> None:
        """Leave the scheduler; end what was started."""
        for each in (self._client, self._cluster):
            if each is not None:
                with suppress(Exception):  # it may be gone, which is what we want
                    each.close()

    def run(
        self,
        groups: Sequence[Sequence[Cell]],
        count: int,
        report: Callable[[int], None],
        finish: Callable[[Cell, Results], None],
    ) -> None:
        """Run groups of cells, `count` trials each; see `studies.run.Runner`.

        Errors: OtherCode for a worker with other code; as `gather`.
        """
        if not groups:
            return
        self.compare(tuple(each.to_json() for each in Batch.of([cell for group in groups for cell in group]).company))
        gathered, done = Gathered(count), 0

        def land(own: Slice, parts: Sequence[Part]) -> None:
            nonlocal done
            done += own.trials
            for cell, span, part in zip(own.cells, own.spans, parts, strict=True):
                whole = gathered.put(cell, span, part)
                if whole is not None:
                    engine = engine_of(cell.scenario)
                    finish(cell, Results.of(cell.scenario, cell.seed, runtime.start(), *whole, None, engine))

        self.gather(worker.run, cut(groups, count, self.workers), self._task, land, lambda: report(done))

    def gather(
        self,
        work: Callable[[Any], Any],
        pieces: Iterable[_Piece],
        task: Callable[[_Piece], Any],
        land: Callable[[_Piece, Any], None],
        report: Callable[[], None] = lambda: None,
    ) -> None:
        """Let workers do all pieces of some work, and do those again that were lost.

        work: what a worker calls, on the `task` of a piece; land: takes each piece with what came of it, in the order in which
        they are finished; report: called again and again meanwhile.

        Errors: RuntimeError when the scheduler stays away, or a piece ends every worker that runs it; what the work raises.
        """
        waiting = deque(pieces)
        flying: dict[str, tuple[Any, _Piece]] = {}
        while waiting or flying:
            if not self._there():
                waiting.extendleft(own for _, own in reversed(flying.values()))
                flying.clear()
                self._reconnect(report)
            while waiting and len(flying) < AHEAD * max(self.workers, 1):
                own = waiting.popleft()
                key = f"tiswarm-{uuid.uuid4().hex}"
                flying[key] = (self._client.submit(work, task(own), key=key, pure=False), own)
            landed = [key for key, (future, _) in flying.items() if future.status != "pending"]
            for key in landed:
                future, own = flying.pop(key)
                came = self._taken(future)
                if came is None:
                    waiting.appendleft(own)
                else:
                    land(own, came)
            report()
            if not landed:
                time.sleep(PAUSE)

    def _taken(self, future: Any) -> Any:
        """Give what a task came to; None where it was lost and must run again. Errors: as `run`."""
        try:
            return future.result()
        except self._distributed.scheduler.KilledWorker:
            raise RuntimeError(
                f"cluster {self._address}: workers that ran one slice ended, time and again; see their logs, give them more "
                "memory, and start again: finished cells are kept"
            ) from None
        except (OSError, TimeoutError, self._distributed.CancelledError):  # the connection, or the scheduler, was lost
            return None

    def _task(self, own: Slice) -> worker.Task:
        scenarios = [cell.scenario for cell in own.cells]
        company = tuple(each.to_json() for each in own.batch.company)
        return worker.Task(
            scenarios=tuple(each.to_json() for each in scenarios),
            hashes=tuple(each.hash() for each in scenarios),
            spans=own.spans,
            company=company,
            counts=own.batch.counts,
            seed=own.cells[0].seed,
            precision=runtime.start().precision,
            threads=self.threads,
            folders=self.folders,
            identity=worker.identity((), company),
        )

    def compare(self, company: tuple[str, ...]) -> None:
        """Compare the code of all workers that are there with ours. Those that come later are compared task by task.

        company: scenarios as JSON, whose code counts. Errors: OtherCode.
        """
        ours = worker.identity((), company)
        found = self._client.run(worker.identity, self.folders, company, on_error="return")
        for name, theirs in sorted(found.items()):
            if isinstance(theirs, BaseException):
                raise worker.OtherCode(f"worker {name} cannot run tiswarm ({theirs}); install the client's state of it there")
            if theirs != ours:
                raise worker.OtherCode(worker.difference(name, theirs, ours))

    def _there(self) -> bool:
        """Tell whether the scheduler answers; count its workers now and then."""
        if self._client.status != "running":
            return False
        if time.monotonic() - self._counted > LOOK:
            try:
                self._count()
            except (OSError, TimeoutError):
                return False
        return True

    def _count(self) -> None:
        self.workers = len(self._client.nthreads())
        self.most = max(self.most, self.workers)
        self._counted = time.monotonic()

    def _reconnect(self, report: Callable[[], None]) -> None:
        with suppress(Exception):
            self._client.close(timeout=1)
        self._connect(PATIENCE, report)

    def _connect(self, patience: float, report: Callable[[], None] = lambda: None) -> None:
        """Find the scheduler, which may be away for a while. Errors: RuntimeError when it stays away."""
        end = time.monotonic() + patience
        while True:
            try:
                if self._cluster is None and self._address.endswith(".json"):
                    self._client = self._distributed.Client(scheduler_file=self._address, timeout=5)
                else:
                    self._client = self._distributed.Client(self._cluster or self._address, timeout=5)
                self._count()
                return
            except (OSError, TimeoutError, ValueError) as error:
                if time.monotonic() > end:
                    raise RuntimeError(
                        f"cluster {self._address}: no scheduler answers ({error}); check the address and give the same "
                        "command again: finished cells are kept"
                    ) from None
            report()
            time.sleep(0.2)


def _local_workers(address: str) -> int:
    """Read how many workers are to be started on this machine, 0 for another's scheduler. Errors: ValueError."""
    if address == "local":
        return available_threads()
    if not address.startswith("local:"):
        if not address.endswith(".json") and ":" not in address:
            raise ValueError(f"--cluster {address}: write local, local:N, tcp://HOST:PORT or the path of a scheduler file")
        return 0
    count = address.removeprefix("local:")
    if not (count.isascii() and count.isdigit() and 1 <= int(count) <= 1024):
        raise ValueError(f"--cluster {address}: write local:N with N from 1 to 1024")
    return int(count)
