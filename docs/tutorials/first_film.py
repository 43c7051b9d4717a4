# %% [markdown]
# # First trial and film
#
# Six prey have to cross a field of obstacles to a target while fifteen predators crash into them. We run the scenario many times, look at
# one of those trials and film it. `pip install tiswarm` is all that is needed.

# %%
import render
import tiswarm

scenario = tiswarm.load("delft/pronav-10")
print(scenario.title)
print(scenario.prey.count, "prey,", scenario.predators.count, "predators,", scenario.obstacles.count, "obstacles")

# %% [markdown]
# ## A thousand trials
#
# Each trial has obstacles and starts of its own, drawn from the seed and the trial's number: the pair names it for good. The first call
# compiles a kernel, which takes a few seconds; later ones find it compiled.

# %%
results = tiswarm.simulate(scenario, trials=1000, seed=0)
for name, estimate in results.summary().items():
    print(f"{name:14} {estimate.mean:7.3f} ± {estimate.stderr:.3f}")

# %% [markdown]
# `success` is the share of prey that arrive, `time` the seconds a trial takes, `impact_spread` the seconds between the first prey that arrives and
# the last. Arrays have an entry a trial:

# %%
best = int(results.success.argmax())
print("prey that arrived in the first ten trials:", (results.success[:10] * scenario.prey.count).round().astype(int))
print("the first trial with the most:", best)

# %% [markdown]
# ## Another strategy, the same luck
#
# A scenario is frozen; `replaced` gives a changed one. Trials with the same number have the same starts and obstacles, so that their
# difference is paired, and its interval is narrow.

# %%
split = scenario.replaced({"prey.strategy": "split"})
difference = tiswarm.compare(results, tiswarm.simulate(split, trials=1000, seed=0))["success"]
print(f"split against baseline: {difference.mean:+.3f} ({difference.low:+.3f} to {difference.high:+.3f})")

# %% [markdown]
# ## One trial, tick by tick
#
# A recording holds the path of everybody: `[tick, agent, axis]` in metres, NaN once an agent is gone.

# %%
recording = tiswarm.record(split, trial=best, seed=0)
print(recording.prey.position.shape, recording.prey.fate)

# %% [markdown]
# ## The film
#
# `render.film` writes it, and a notebook shows it.

# %%
render.film(recording, "split.mp4", size=(640, 360), fps=30, quality="draft")

# %% [markdown]
# Two strategies side by side, under the same luck, is a list of two recordings:

# %%
both = [recording, tiswarm.record(scenario, trial=best, seed=0)]
render.film(both, "versus.mp4", size=(960, 360), fps=30, quality="draft")

# %% [markdown]
# From here: [your own strategy](own_strategy.md), [films](../films.md), [what a preset may state](../reference/keys.md).
