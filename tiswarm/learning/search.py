"""Search: CMA-ES by the library `cmaes`, or pairs, in the unit cube for numbers, without bounds for weights; large is good."""

import importlib.util
from collections.abc import Sequence
from typing import Any, Literal, get_args

import numpy as np

from tiswarm.learning.evolution import PairedStrategy
from tiswarm.scenario.errors import ScenarioError

Method = Literal["cma-es", "openai-es"]

SIGMA = 0.25
"""First step, of the width of a range: two standard deviations reach from the middle to an end."""

MANY = 60
"""Coordinates beyond which covariances cost more than they tell."""


def check_cmaes() -> None:
    """Raise ValueError unless the search's library is there."""
    if importlib.util.find_spec("cmaes") is None:
        raise ValueError("tune: cmaes is not installed; pip install 'tiswarm[tune]'")


def suited(network: str, halving: bool) -> Method:
    """Give the method that finds most in as many trials, see docs/tuning.md; where candidates leave, the one that can."""
    return "openai-es" if network and not halving else "cma-es"


def check_method(method: str, candidates: int, halving: bool) -> None:
    """Raise ScenarioError for a method that is not there, or cannot do what is asked of it."""
    if method not in get_args(Method):
        raise ScenarioError(f"method: {method!r} is not known; use 'cma-es' or 'openai-es'")
    if method == "openai-es" and candidates % 2:
        raise ScenarioError(f"candidates: openai-es asks for pairs, and {candidates} is odd; use {candidates + 1}")
    if method == "openai-es" and halving:
        raise ScenarioError("halving: openai-es compares all candidates on the same trials; leave halving out, or use cma-es")


class Search:
    """Asks for candidates and is told their scores; what it asks for depends on its seed and on what it was told alone."""

    def __init__(
        self, start: np.ndarray, candidates: int, seed: Sequence[int], steps: np.ndarray, method: Method = "cma-es"
    ) -> None:
        """Begin at a place: [coordinate].

        steps: [range], between whole numbers, 0 for real ones; coordinates behind the ranges have no bounds. Many are searched
        with a variance each instead of all covariances (Ros, Hansen 2008).

        Errors: ScenarioError for whole numbers beside many weights.
        """
        from cmaes import CMA, CMAwM, SepCMA

        bounds = np.tile([-np.inf, np.inf], (len(start), 1))
        bounds[: len(steps)] = (0.0, 1.0)
        self._bounds = bounds
        word = int(np.random.SeedSequence(seed).generate_state(1)[0])
        self._whole = bool((steps > 0).any())
        given: dict[str, Any] = {"bounds": bounds, "seed": word, "population_size": candidates}
        if self._whole and len(start) > len(steps):
            raise ScenarioError("tune: whole numbers cannot be searched together with a network; find them first")
        if self._whole and method == "openai-es":
            raise ScenarioError("tune: openai-es cannot search whole numbers; use cma-es")
        self._cma: Any
        if method == "openai-es":
            self._cma = PairedStrategy(start, SIGMA, **given)
        elif self._whole:
            self._cma = CMAwM(start, SIGMA, steps=steps, **given)
        else:
            self._cma = (SepCMA if len(start) > MANY else CMA)(start, SIGMA, **given)
        self._told: list[np.ndarray] = []
        self.candidates = candidates

    def ask(self) -> np.ndarray:
        """Give the candidates of the next generation: [candidate, coordinate]."""
        if not self._whole:
            self._told = [self._cma.ask() for _ in range(self.candidates)]
            return np.stack(self._told)
        both = [self._cma.ask() for _ in range(self.candidates)]
        self._told = [told for _, told in both]
        return np.stack([shown for shown, _ in both])

    def tell(self, scores: np.ndarray) -> None:
        """Rank the candidates of the last `ask`: [candidate]."""
        self._cma.tell([(each, -float(score)) for each, score in zip(self._told, scores, strict=True)])

    @property
    def centre(self) -> np.ndarray:
        """Give the mean of the distribution, inside the bounds: [coordinate]."""
        return np.clip(self._cma.mean, self._bounds[:, 0], self._bounds[:, 1])
