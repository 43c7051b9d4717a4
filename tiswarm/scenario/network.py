"""Networks: what steers a neural strategy, as numbers in a small file beside the preset."""

import os
import zipfile
import zlib
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np

from tiswarm.scenario.errors import ScenarioError
from tiswarm.system.files import replacing

Inputs = Literal["thesis", "own"]
Outputs = Literal["gains", "velocity"]

INPUTS = {"thesis": 8, "own": 13}
OUTPUTS = {"gains": 5, "velocity": 2}
WIDEST = 64
MOST_LAYERS = 4
LIMIT = 1e6


@dataclass(frozen=True)
class Shape:
    """What of a network selects a kernel's code: what it is told, what it decides, and how many numbers each layer has.

    inputs: thesis, eight numbers in the world's axes, or own, thirteen in the agent's own frame; outputs: gains, of separation,
    alignment, cohesion, goal and field, or velocity, a change of velocity [m/s]; layers: [layer], from inputs to outputs.
    """

    inputs: Inputs
    outputs: Outputs
    layers: tuple[int, ...]

    def __post_init__(self) -> None:
        """Check that all go together. Errors: ScenarioError."""
        if self.inputs not in get_args(Inputs) or self.outputs not in get_args(Outputs):
            raise ScenarioError(
                f"network: {self.inputs!r} to {self.outputs!r} is not known; use thesis or own, gains or velocity"
            )
        ends = (INPUTS[self.inputs], OUTPUTS[self.outputs])
        if not 2 <= len(self.layers) <= MOST_LAYERS + 1 or (self.layers[0], self.layers[-1]) != ends:
            told = f"{ends[0]} inputs, up to {MOST_LAYERS - 1} hidden layers, and {ends[1]} outputs"
            raise ScenarioError(f"network: layers of {'-'.join(map(str, self.layers))} do not fit; use {told}")
        if not all(1 <= width <= WIDEST for width in self.layers):
            raise ScenarioError(f"network: layers of {'-'.join(map(str, self.layers))}; use 1 to {WIDEST} numbers a layer")

    @property
    def size(self) -> int:
        """Count the weights: those of each neuron's inputs, and its bias."""
        return sum((before + 1) * after for before, after in zip(self.layers, self.layers[1:], strict=False))

    @property
    def scratch(self) -> int:
        """Count the numbers that a forward pass writes down."""
        return sum(self.layers[1:])


@dataclass(frozen=True, eq=False)
class Network:
    """A network: weights, [weight], layer by layer and neuron by neuron, each neuron's weights and then its bias."""

    shape: Shape
    weights: np.ndarray

    def __post_init__(self) -> None:
        """Check the weights. Errors: ScenarioError."""
        if self.weights.shape != (self.shape.size,):
            layers = "-".join(map(str, self.shape.layers))
            raise ScenarioError(f"network: {self.weights.size} weights for layers of {layers}, which have {self.shape.size}")
        if not np.isfinite(self.weights).all() or np.abs(self.weights).max() > LIMIT:
            raise ScenarioError(f"network: holds a weight that is not finite, or beyond {LIMIT:g}")

    @property
    def digest(self) -> str:
        """Name the network by what it computes."""
        told = f"{self.shape.inputs} {self.shape.outputs} {self.shape.layers}".encode()
        return sha256(told + np.ascontiguousarray(self.weights, "<f8").tobytes()).hexdigest()[:16]

    def save(self, path: str | os.PathLike) -> Path:
        """Write the network; the file appears whole or not at all."""
        arrays: dict[str, Any] = {
            "inputs": np.array(self.shape.inputs),
            "outputs": np.array(self.shape.outputs),
            "layers": np.array(self.shape.layers, np.int32),
            "weights": self.weights.astype(np.float64),
        }
        with replacing(Path(path)) as part, part.open("wb") as file:
            np.savez(file, allow_pickle=False, **arrays)
        return Path(path)

    def outputs_of(self, inputs: np.ndarray) -> np.ndarray:
        """Give what the network answers, by NumPy: [..., input] to [..., output]."""
        place, values = 0, inputs
        for number, (before, after) in enumerate(zip(self.shape.layers, self.shape.layers[1:], strict=False)):
            rows = self.weights[place : place + (before + 1) * after].reshape(after, before + 1)
            values = values @ rows[:, :-1].T + rows[:, -1]
            place += rows.size
            if number < len(self.shape.layers) - 2:
                values = np.tanh(values)
        return np.asarray(values)


def constant(shape: Shape, outputs: np.ndarray) -> Network:
    """Give a network that answers the same whatever it is told: weights of zero, and biases behind."""
    weights = np.zeros(shape.size)
    weights[-shape.layers[-1] * (shape.layers[-2] + 1) :].reshape(shape.layers[-1], -1)[:, -1] = outputs
    return Network(shape, weights)


def begun(shape: Shape, outputs: np.ndarray, seed: int = 0) -> Network:
    """Give a network to begin training with: answers as `constant`, hidden neurons that each look elsewhere."""
    rng = np.random.default_rng(seed)
    weights = constant(shape, outputs).weights.copy()
    place = 0
    for before, after in zip(shape.layers[:-2], shape.layers[1:-1], strict=True):
        rows = weights[place : place + (before + 1) * after].reshape(after, before + 1)
        rows[:, :-1] = rng.normal(0.0, before**-0.5, (after, before))
        place += rows.size
    return Network(shape, weights)


def find(name: str) -> Path:
    """Find a network's file: a path, or a name beside the presets that ship with tiswarm. Errors: ScenarioError."""
    from tiswarm.scenario.presets import preset_folder

    for path in (Path(name), preset_folder() / name):
        if path.is_file():
            return path
    raise ScenarioError(f"network: no file {name!r}, here or beside the presets; name an .npz that a network was saved to")


def read(name: str) -> Network:
    """Read a network by its file's name. Errors: ScenarioError."""
    path = find(name)
    told = path.stat()
    return _read(path, told.st_mtime_ns, told.st_size)


@cache
def _read(path: Path, _changed: int, _size: int) -> Network:
    try:
        with np.load(path, allow_pickle=False) as stored:
            inputs, outputs = str(stored["inputs"]), str(stored["outputs"])
            layers = tuple(int(width) for width in np.atleast_1d(stored["layers"]))
            weights = np.asarray(stored["weights"], np.float64)
    except (OSError, ValueError, TypeError, EOFError, KeyError, zipfile.BadZipFile, zlib.error):
        raise ScenarioError(f"{path}: is no network; name an .npz that a network was saved to") from None
    try:
        return Network(Shape(inputs, outputs, layers), weights)  # type: ignore[arg-type]
    except ScenarioError as error:
        raise ScenarioError(f"{path}: {error}") from None
