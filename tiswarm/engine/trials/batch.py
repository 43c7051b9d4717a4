"""Batch: run the trials of one or many scenarios in chunks."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from tiswarm.dynamics.rows import CLOCK_ROWS, INTEGER_ROWS
from tiswarm.dynamics.specialisation import Specialisation
from tiswarm.dynamics.table import ParameterTable
from tiswarm.engine.choice import check_pairs
from tiswarm.engine.finite import STRANGE, NotFiniteError
from tiswarm.engine.trials import kernel, mates
from tiswarm.records.results import Results
from tiswarm.scenario.errors import ScenarioError
from tiswarm.scenario.model import Scenario
from tiswarm.scenario.parts import LIMIT
from tiswarm.simd import launch, philox, runtime
from tiswarm.simd.runtime import LANES
from tiswarm.strategies import registry
from tiswarm.system.progress import reporting
from tiswarm.system.words import did_you_mean

CHUNK = 16_384
"""Trials that one launch of the kernel runs: a fraction of a second, so that progress shows and Ctrl-C is heard; and a bound
of the memory, since a trial in flight costs its outcomes, its place in the queue and the numbers of its own."""

NO_LIMIT = 2**31 - 1

SPREAD = 2
"""Of places in the arrays every second one has a block that works a queue off: a core fetches ahead beyond its block's end,
and its neighbour would wait for each such line before it may write it again, a tenth to a fifth of the time of two threads."""

Progress = bool | Callable[[int, int], None]
Finished = Callable[[int, Results], None]


class Blocks:
    """The arrays that a kernel works on: one block of lanes per thread, whatever the number of trials.

    Attributes are as the kernel's arguments of the same names (kernel.py).
    """

    def __init__(
        self,
        scenarios: Sequence[Scenario],
        blocks: int,
        counts: tuple[int, int, int] | None = None,
        *,
        spread: int = 1,
        terms: bool = False,
        commanded: tuple[tuple[str, str], ...] = (),
    ) -> None:
        """Allocate blocks; counts: most prey, predators and obstacles in any lane, the scenarios' own when None.

        spread: every how manieth place in the arrays has a block.
        terms: whether agents note their velocity behind each term of a move. commanded: which kinds obey, and what they are
        told.
        """
        types = runtime.types()
        self.blocks, self.spread, self.precision = blocks, spread, runtime.start().precision
        self.counts = counts or (
            max(scenario.prey.count for scenario in scenarios),
            max(scenario.predators.count for scenario in scenarios),
            max(scenario.obstacles.count for scenario in scenarios),
        )
        check_pairs(max(self.counts))
        structure = Specialisation.of(scenarios, self.counts[1], terms=terms, commanded=commanded)
        self.kernel, self.layout, (sums, cells) = kernel.kernel(structure)
        prey, predators, obstacles = (max(count, 1) for count in self.counts)
        rows = self.layout.agent_rows
        self.dtype = types.dtype
        places = blocks * spread
        self.prey = runtime.aligned((places * prey * rows["prey"], LANES), types.dtype)
        self.predators = runtime.aligned((places * predators * rows["predators"], LANES), types.dtype)
        self.obstacles = runtime.aligned((places * obstacles * self.layout.obstacle_rows, LANES), types.dtype)
        self.numbers = runtime.aligned((2 * places * len(self.layout.paths), LANES), types.dtype)
        self.clock = runtime.aligned((places, CLOCK_ROWS, LANES), types.dtype)
        self.integer = runtime.aligned((places, INTEGER_ROWS, LANES), np.uint32)
        self.sums = runtime.aligned((places * sums, LANES), types.dtype)
        self.ground = runtime.aligned((places * max(cells, 1), LANES), types.dtype)
        board = self.layout.board
        self.board = runtime.aligned((places * max(board.fixed + board.each * prey, 1), LANES), types.dtype)
        self.met = runtime.aligned((places * max(prey, predators) * mates.height(self.layout), LANES), types.dtype)
        self.measures = self.layout.structure.frame.measures

    def outcomes(self, trials_count: int) -> tuple[np.ndarray, np.ndarray]:
        """Allocate what a batch writes down: [trial, outcome] and [trial, measure], one column at least."""
        return (
            np.zeros((trials_count, len(kernel.OUTCOMES)), np.int32),
            np.zeros((trials_count, max(len(self.measures), 1)), self.dtype),
        )

    def advance(
        self,
        table: np.ndarray,
        jobs: np.ndarray,
        queue: np.ndarray,
        results: np.ndarray,
        measured: np.ndarray,
        seed: int,
        moves: int,
    ) -> None:
        """Launch the kernel: every block works the queue off, or makes `moves` moves and pauses."""
        arguments = self._arguments(table, jobs, queue, results, measured, seed)
        launch.run(self.kernel, *arguments, moves, precision=self.precision)

    def prepared(
        self, table: np.ndarray, jobs: np.ndarray, queue: np.ndarray, results: np.ndarray, measured: np.ndarray, seed: int
    ) -> Callable[[int], None]:
        """Give what launches the kernel on these arrays again and again, which stay where they are, for so many moves each."""
        return launch.prepared(
            self.kernel, *self._arguments(table, jobs, queue, results, measured, seed), 0, precision=self.precision
        )

    def _arguments(
        self, table: np.ndarray, jobs: np.ndarray, queue: np.ndarray, results: np.ndarray, measured: np.ndarray, seed: int
    ) -> tuple[np.ndarray | int, ...]:
        """List all arguments of the kernel but the last."""
        return (
            self.prey,
            self.predators,
            self.obstacles,
            self.numbers,
            self.clock,
            self.integer,
            table,
            jobs,
            queue,
            results,
            self.sums,
            self.ground,
            measured,
            self.board,
            self.met,
            *self.counts,
            *philox.seed_words(seed),
            self.blocks,
            self.spread,
        )


def run(
    scenarios: list[Scenario],
    count: int,
    seed: int,
    progress: Progress,
    weights: Mapping[str, np.ndarray] | None = None,
    counts: tuple[int, int, int] | None = None,
    finished: Finished | None = None,
) -> list[Results]:
    """Run trials 0 to count - 1 of scenarios of one frame to their ends; see engine/run.py.

    counts: most prey, predators and obstacles of any trial, the scenarios' own when None.
    """
    check_live(scenarios)
    blocks = Blocks(scenarios, runtime.start().threads, counts, spread=SPREAD)
    table = blocks.layout.table(scenarios).astype(blocks.dtype)
    outcomes, measured = blocks.outcomes(len(scenarios) * count)
    split, split_measured = (each.reshape(len(scenarios), count, -1) for each in (outcomes, measured))
    results: list[Results] = []
    with reporting(progress, len(outcomes), "trials") as report:
        for first in range(0, len(outcomes), CHUNK):
            jobs = np.arange(first, min(first + CHUNK, len(outcomes)))
            if weights:
                chunk = {path: np.asarray(values)[jobs] for path, values in weights.items()}
                table = blocks.layout.table(scenarios, chunk).astype(blocks.dtype)
            rows = jobs - first if weights else jobs // count
            places = np.stack([rows, jobs % count], axis=1).astype(np.int32)
            here = slice(jobs[0], jobs[-1] + 1)
            queue = np.array([0, len(jobs)], np.int32)
            blocks.advance(table, places, queue, outcomes[here], measured[here], seed, NO_LIMIT)

            def told(job: int, first: int = first) -> tuple[Scenario, int]:
                which, trial = divmod(first + job, count)
                own = {path: values[trial] for path, values in weights.items()} if weights else {}
                return with_numbers(scenarios[which], own), trial

            refuse_strange(outcomes[here], told, seed)
            while (len(results) + 1) * count <= jobs[-1] + 1:  # the launch ran the last trials of these scenarios
                own = dict(zip(kernel.OUTCOMES, split[len(results)].T, strict=True))
                values = dict(zip(blocks.measures, split_measured[len(results)].T.astype(np.float64), strict=False))
                results.append(Results.of(scenarios[len(results)], seed, runtime.start(), own, values, weights))
                if finished is not None:
                    finished(len(results) - 1, results[-1])
            report(int(jobs[-1]) + 1)
    return results


def refuse_strange(outcomes: np.ndarray, of: Callable[[int], tuple[Scenario, int]], seed: int) -> None:
    """Raise NotFiniteError where a state was not finite at the end of trials: the first runs again, to see when and who.

    outcomes: [job, outcome]; of: scenario and number of the trial of a job.
    """
    strange = np.flatnonzero(outcomes[:, 0] == STRANGE)
    if not len(strange):
        return
    from tiswarm.engine.trials.trial import Single  # which works by the blocks of this module

    scenario, trial = of(int(strange[0]))
    told = f"{len(strange)} of {len(outcomes)} trials are not finite, " if len(strange) > 1 else ""
    try:
        Single(scenario, seed, trial).step(scenario.world.ticks)
    except NotFiniteError as error:
        raise NotFiniteError(f"{told}{error}") from None
    raise NotFiniteError(
        f"{told}trial {trial} is not finite at its end, by strategy '{scenario.prey.strategy}'; lower its gains"
    )


def with_numbers(scenario: Scenario, numbers: Mapping[str, float]) -> Scenario:
    """Give the scenario with the numbers of one trial of its own."""
    return scenario.replaced({path: int(value) if _whole(path) else float(value) for path, value in numbers.items()})


WHOLE = ("world.ticks", "measures.after", "measures.window", "prey.nearest", "predators.nearest")


def _whole(path: str) -> bool:
    """Tell whether a number must be a whole one."""
    return path.endswith(".count") or path in WHOLE


def check_live(scenarios: Sequence[Scenario]) -> None:
    """Refuse strategies that ask programs outside the kernel, which a batch does not stop for."""
    for scenario in scenarios:
        for path in _live_paths(scenario):
            if scenario.numbers()[path]:
                raise ScenarioError(f"{path}: works in single trials and films only; set it to 0 for many trials")


def _live_paths(scenario: Scenario) -> list[str]:
    """List the weights that let strategies ask programs outside the kernel."""
    found = (registry.load("predators", name).live for name in registry.parts("predators", scenario.predators.strategy))
    return [f"predators.weights.{name}" for name in found if name]


def check_weights(scenario: Scenario, weights: Mapping[str, np.ndarray], count: int) -> tuple[int, int, int]:
    """Check numbers of single trials against the scenario's own bounds; give the most prey, predators and obstacles."""
    known = list(scenario.numbers())
    settled = differing(scenario)
    arrays = {}
    for path, values in weights.items():
        if path not in known:
            raise ScenarioError(f"weights: unknown key '{path}'; {did_you_mean(path, known)}")
        if path not in settled:
            raise ScenarioError(f"weights: {path} is the same for all trials of a batch; set it in the scenario")
        array = np.asarray(values, np.float64)
        if array.shape != (count,):
            raise ScenarioError(f"weights: {path} has shape {array.shape}; use one number for each of the {count} trials")
        if not np.isfinite(array).all() or np.abs(array).max() > LIMIT:
            raise ScenarioError(f"weights: {path} holds a number that is not finite, or beyond {LIMIT:g}")
        whole = _whole(path)
        if whole and (array != np.round(array)).any():
            raise ScenarioError(f"weights: {path} holds {array[array != np.round(array)][0]:g}; use a whole number")
        arrays[path] = array
        if other_end(path) is None:
            for end in (array.min(), array.max()):
                scenario.replaced({path: int(end) if whole else float(end)})
    _check_ends(scenario, arrays)

    def most(kind: str) -> int:
        return int(arrays[f"{kind}.count"].max()) if f"{kind}.count" in arrays else getattr(scenario, kind).count

    return most("prey"), most("predators"), most("obstacles")


def differing(scenario: Scenario) -> set[str]:
    """List the numbers that may differ from trial to trial: what a kernel reads from its table, the structure kept."""
    own = ParameterTable(Specialisation.of([scenario], 1), runtime.types().lanes).paths
    weights = {path for path in scenario.numbers() if ".weights." in path}
    return (set(own) | weights) - {"coverage.cell", "planning.cell", *_live_paths(scenario)}


def other_end(path: str) -> str | None:
    """Give the key of the other end of a range: "obstacles.radius.0" for "obstacles.radius.1"; None for no end of a range."""
    names = path.split(".")
    for at, name in enumerate(names[:-1]):
        if name in ("region", "velocity") or names[: at + 1] == ["obstacles", "radius"]:
            names[at + 1] = "1" if names[at + 1] == "0" else "0"
            return ".".join(names)
    return None


def _check_ends(scenario: Scenario, arrays: Mapping[str, np.ndarray]) -> None:
    """Raise ScenarioError where a range of a single trial runs from a larger to a smaller number."""
    numbers = scenario.numbers()
    for path in arrays:
        other = other_end(path)
        if other is not None:
            low, high = sorted((path, other))
            below, above = (arrays.get(end, numbers[end]) for end in (low, high))
            if np.any(np.asarray(below) > np.asarray(above)):
                raise ScenarioError(
                    f"weights: {low} is above {high} in some trials; a range runs from its lower to its upper end"
                )
            if path.startswith("obstacles.radius") and np.any(arrays[path] < 0):
                raise ScenarioError(f"weights: {path} holds a negative radius; use 0 or more")
