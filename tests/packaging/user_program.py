"""A program of a user, with every public name that has types: `mypy --strict` must accept it (.ci/run)."""

from fractions import Fraction

import numpy as np

import render
import tiswarm

tiswarm.init("f32", threads=1)
tiswarm.add_path("mine")
scenario: tiswarm.Scenario = tiswarm.load("delft/pronav-10", {"prey.strategy": "evasive"})
try:
    scenario = scenario.replaced({"prey.count": 8})
except tiswarm.ScenarioError as error:
    print(error)
count: int = scenario.prey.count
results: tiswarm.Results = tiswarm.simulate(
    scenario, trials=100, seed=1, weights={"prey.weights.evade": np.linspace(0, 1, 100)}
)
success: tiswarm.Estimate = results.summary()["success"]
mean: float = success.mean
print(tiswarm.compare(results, results)["time"].low)
simulation = tiswarm.Simulation(scenario, seed=0, trial=3)
simulation.step(10)
simulation.set({"prey.weights.evade": 0.1})
place: np.ndarray = simulation.position("prey")
swarm = tiswarm.Swarm(scenario, seed=0)
swarm.step(2)
recording: tiswarm.Recording = tiswarm.record(scenario, trial=2, terms=True)
recording.save("path.npz")
film: render.Film = render.film(recording, "film.mp4", (640, 360), Fraction(30), theme="light")
frames = [frame.shape for frame in render.frames([recording, recording])]
render.poster(recording, "poster.png")
tuned = tiswarm.tune(scenario, {"prey.goal": (0.1, 1.0), "prey.strategy": ["split", "evasive"]}, budget=1000)
print(tuned.scenarios[0].to_toml(), tiswarm.__version__, tiswarm.Start)
environment: tiswarm.Environment = tiswarm.env(scenario, 64, control="both")
shown: np.ndarray = environment.reset(seed=0)
shown, rewards, terminated, truncated = environment.step(np.zeros((64, len(environment.agents), environment.action_size)))
told: tiswarm.Recording = environment.record(lambda seen: seen[:, :, :2], seed=0, trial=1)
frame: np.ndarray = render.still(told, time=3.0)
