# %% [markdown]
# # Tuning
#
# Which weights make most prey arrive? `tiswarm.tune` searches by CMA-ES, whose candidates all meet the same trials, and tells the result on
# trials that no search saw. It needs `pip install "tiswarm[tune]"`.

# %%
import tiswarm

start = tiswarm.load("delft/pronav-10", {"prey.strategy": "evasive"})
found = tiswarm.tune(
    start,
    {"prey.weights.evade": (0.001, 0.1, "log"), "prey.goal": (0.01, 1, "log")},
    budget=16_000,
    candidates=16,
    trials=50,
    checks=400,
    validation=4000,
)

# %% [markdown]
# A small budget, so that this page builds in seconds; `tiswarm tune --help` tells what it spends unless told otherwise. What was found:

# %%
tuned = found.scenarios[0]
print(f"prey.weights.evade: {start.prey.weights['evade']:g} -> {tuned.prey.weights['evade']:g}")
print(f"prey.goal: {start.prey.goal:g} -> {tuned.prey.goal:g}")

# %% [markdown]
# ## Believe it?
#
# The 4000 trials of the validation are those that `tiswarm.simulate` has, numbers 0 to 3999. Start and result are compared on
# them in pairs:

# %%
held = found.validations[0]
print(f"{held.start.mean:.3f} -> {held.tuned.mean:.3f}: {held.difference.mean:+.3f} ± {held.difference.stderr:.3f}")

# %% [markdown]
# The search itself, generation by generation: the best candidate flatters, since it was chosen for its luck, too.

# %%
for each in found.history[::4]:
    print(f"generation {each.number:2}: mean {each.scores.mean():.3f}, best {each.scores.max():.3f}")

# %% [markdown]
# How it works, networks, several worlds at once: [Tuning and training](../tuning.md).
