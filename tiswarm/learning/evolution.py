"""Evolution: OpenAI's evolution strategy, steps up a gradient that pairs of opposite candidates estimate."""

from collections.abc import Sequence

import numpy as np

RATE = 0.1
"""Greatest step of a coordinate in a generation, about, on the search's scale."""

MEMORY = (0.9, 0.999)
"""How much of the gradient's mean and square Adam keeps."""


class PairedStrategy:
    """Candidates in antithetic pairs around a mean that moves by Adam; ranks in place of scores, so that no outlier leads.

    Salimans, Ho, Chen, Sidor, Sutskever 2017 (arXiv 1703.03864), algorithm 1 and section 2.1; Adam of Kingma, Ba 2015. It is
    asked and told as the classes of the library `cmaes` are: small values are good.
    """

    def __init__(self, mean: np.ndarray, sigma: float, bounds: np.ndarray, seed: int, population_size: int) -> None:
        """Begin at a mean: [coordinate]. bounds: [coordinate, end]; population_size: an even number."""
        self.mean = mean.astype(np.float64)
        self._sigma = sigma
        self._bounds = bounds
        self._pairs = population_size // 2
        self._rng = np.random.default_rng(seed)
        self._noise: list[np.ndarray] = []
        self._asked = 0
        self._steps = 0
        self._slope = np.zeros_like(self.mean)
        self._square = np.zeros_like(self.mean)

    def ask(self) -> np.ndarray:
        """Give a candidate, [coordinate], each second one opposite to the one before."""
        if self._asked % 2 == 0:
            self._noise.append(self._rng.standard_normal(len(self.mean)))
        way = self._noise[-1] * (1.0 if self._asked % 2 == 0 else -1.0)
        self._asked += 1
        return np.clip(self.mean + self._sigma * way, self._bounds[:, 0], self._bounds[:, 1])

    def tell(self, solutions: Sequence[tuple[np.ndarray, float]]) -> None:
        """Step by what candidates came to, in the order in which they were asked for."""
        values = np.array([value for _, value in solutions])
        ranks = np.empty(len(values))
        ranks[np.argsort(-values, kind="stable")] = np.linspace(-0.5, 0.5, len(values))
        lead = (ranks[0::2] - ranks[1::2])[:, None] * np.stack(self._noise)
        slope = lead.sum(axis=0) / (len(values) * self._sigma)
        self._steps += 1
        self._slope = MEMORY[0] * self._slope + (1 - MEMORY[0]) * slope
        self._square = MEMORY[1] * self._square + (1 - MEMORY[1]) * slope**2
        first = self._slope / (1 - MEMORY[0] ** self._steps)
        second = self._square / (1 - MEMORY[1] ** self._steps)
        self.mean = np.clip(self.mean + RATE * first / (np.sqrt(second) + 1e-8), self._bounds[:, 0], self._bounds[:, 1])
        self._noise, self._asked = [], 0
