# %% [markdown]
# # Your own strategy
#
# A strategy is one file, which tells what an agent adds to its velocity in a tick. Here prey keep away from the middle of the predators in sight.

# %%
from pathlib import Path

folder = Path("mine")
(folder / "prey").mkdir(parents=True, exist_ok=True)
_ = (folder / "prey" / "shy.py").write_text('''
"""Shy: keep away from the mean of the predators in sight."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.strategies import Prey, larger, place, scaled


class Strategy(Prey):
    """Ours: shy Σ (p - q)/n over the n predators q in sight."""

    watches = True  # needs `threat`

    @dataclass(frozen=True)
    class Weights:
        shy: float = 0.05  # strength [1/s]

    @staticmethod
    @ti.func
    def steer(me, threat, swarm, notes, memory, weights):
        return scaled(place(threat), weights.shy / larger(threat.n, 1.0))
''')
# %% [markdown]
# What a hook is given (`me`, `threat`, ...) and which hooks there are is in [Contributing](../contributing.md#add-a-strategy). A number in a
# strategy is a vector of eight, one trial a lane: write it as you would write NumPy.
#
# `add_path` makes the folder known (`--strategy-path` does on the command line); the file's name is the name in presets.

# %%
import tiswarm

tiswarm.add_path(folder)
base = tiswarm.load("delft/centre-10")
shy = base.replaced({"prey.strategy": "shy"})
print(dict(shy.prey.weights))

# %% [markdown]
# ## Is it any good?
#
# Against the strategy that only flocks, in the same 2000 trials:

# %%
reference = tiswarm.simulate(base, trials=2000)
difference = tiswarm.compare(reference, tiswarm.simulate(shy, trials=2000))["success"]
print(f"shy against baseline: {difference.mean:+.3f} ({difference.low:+.3f} to {difference.high:+.3f})")

# %% [markdown]
# ## How shy?
#
# Weights are data: each trial may have one of its own, in one batch of the same kernel. Here 13 values, 1000 trials each.

# %%
import numpy as np

values = np.linspace(0, 0.6, 13)
sweep = tiswarm.simulate(shy, trials=13_000, weights={"prey.weights.shy": np.tile(values, 1000)})
means = sweep.success.reshape(1000, 13).mean(axis=0)
for value, mean in zip(values, means, strict=True):
    print(f"{value:.2f}  {mean:.3f}  {'#' * int(60 * mean)}")

# %% [markdown]
# ## See it
#
# What each term added to a velocity is what `tiswarm replay PRESET --terms` draws as arrows; here is a film.

# %%
import render

chosen = shy.replaced({"prey.weights.shy": float(values[means.argmax()])})
render.film(tiswarm.record(chosen, trial=4), "shy.mp4", size=(640, 360), fps=30, quality="draft")
