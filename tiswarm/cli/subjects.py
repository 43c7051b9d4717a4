"""Subjects: what a film verb films: a trial of a preset, several of them, a recording, or a trial that a study counted."""

from pathlib import Path
from typing import Any

from tiswarm.cli.options import WrongInput, load_scenario, out, pair, plain_name

FIELDS = ("field", "plan")
"""Overlays that are sampled before a film begins."""


def names(text: str) -> tuple[str, ...]:
    """Read words between commas."""
    return tuple(name.strip() for name in text.split(",") if name.strip())


def chosen(source: str, sets: list[str] | None, trial: int, seed: int, grid: str | None, versus: str | None) -> tuple[Any, str]:
    """Give what to film, one recording or several, and a name for the file."""
    import tiswarm

    if source.endswith(".npz"):
        if sets or grid or versus:
            raise WrongInput(f"{source}: a recording is what it is; film a preset to use --set, --grid or --versus")
        if not Path(source).is_file():
            raise WrongInput(f"{source}: no such file; record one with tiswarm.record(...).save(...)")
        return tiswarm.Recording.load(source), Path(source).stem
    if grid and versus:
        raise WrongInput("--grid, --versus: use one of them")
    plain = plain_name(source)
    if versus:
        strategies = names(versus)
        if len(strategies) < 2:
            raise WrongInput(f"--versus {versus}: name two prey strategies or more, for example --versus evasive,split-evasive")
        scenarios = [load_scenario(source, [*(sets or []), f"prey.strategy={name}"]) for name in strategies]
        return [played(scenario, trial, seed) for scenario in scenarios], f"{plain}-{trial}-versus"
    scenario = load_scenario(source, sets)
    if grid:
        columns, rows = pair(grid, "--grid", "4x4")
        if not 1 <= columns * rows <= 100:
            raise WrongInput(f"--grid {grid}: film 1 to 100 trials at once")
        return [played(scenario, trial + k, seed) for k in range(columns * rows)], f"{plain}-{trial}-grid"
    return played(scenario, trial, seed), f"{plain}-{trial}"


def played(scenario: Any, trial: int, seed: int) -> Any:
    """Give a trial to film: a recording, or a large swarm that runs while it is filmed."""
    import tiswarm
    from tiswarm.engine.choice import engine_of

    if engine_of(scenario) == "grid":
        return tiswarm.Simulation(scenario, seed, trial)
    return tiswarm.record(scenario, trial, seed)


def again(subject: Any) -> Any:
    """Start simulations anew, which a film has used up."""
    if isinstance(subject, list):
        return [again(each) for each in subject]
    return played(subject.scenario, subject.trial, subject.seed) if is_live(subject) else subject


def is_live(subject: Any) -> bool:
    """Tell whether a subject runs while it is filmed."""
    import tiswarm

    return isinstance(subject, tiswarm.Simulation)


def middle(subject: Any) -> float | None:
    """Give the time of a live simulation's poster; a recording knows its liveliest moment."""
    subjects = subject if isinstance(subject, list) else [subject]
    return max(each.ticks for each in subjects) / 2 if any(is_live(each) for each in subjects) else None


def longest(subject: Any) -> int:
    """Count the ticks of the longest of what is filmed."""
    return max(each.ticks for each in (subject if isinstance(subject, list) else [subject]))


def field(subject: Any, name: str) -> Any:
    """Sample the field of the obstacles of one recording, or its planned ways, to be drawn as arrows."""
    import render
    from tiswarm.engine.trials.trial import field
    from tiswarm.engine.trials.ways import planned

    if isinstance(subject, list) or is_live(subject):
        raise WrongInput(f"--overlay {name}: needs one recorded trial; film one, of few agents")
    return render.Field(*(field if name == "field" else planned)(subject))


def others(source: str, subject: Any, count: int) -> Any:
    """Run so many other trials of the scenario of one that is filmed, and give what became of the prey in them."""
    import render
    import tiswarm

    if isinstance(subject, list) or is_live(subject) or source.endswith((".npz", ".json")):
        raise WrongInput("--among: needs one trial of a preset, of few agents")
    scenario = subject.scenario
    hunted = scenario.predators.count > 0 and scenario.world.contact in ("deadly", "eaten")
    if not (scenario.target.present or hunted):
        raise WrongInput(f"--among: nothing becomes of prey in {source}; film one with a target or predators")
    fate = "arrived" if scenario.target.present else "captured"
    results = tiswarm.simulate(scenario, trials=count + 1, seed=subject.seed)
    rest = [trial for trial in range(count + 1) if trial != min(subject.trial, count)]
    return render.Among(fate, getattr(results, fate)[rest])


def counted(study: Any, cell: int | None, trial: int, picks: list[str], quiet: bool) -> tuple[Any, str]:
    """Give a recording of a trial that a study counted, and a name for the file."""
    if cell is None:
        raise WrongInput("--cell: missing; name a cell by its number in cells.csv, for example --cell 0")
    if len(picks) + bool(trial) > 1:
        raise WrongInput("--trial, --worst, --median, --best: use one of them")
    if picks:
        trial = study.picked(cell, picks[0])
    recording = study.record(cell, trial)
    if not quiet:
        out.print(study.described(cell, trial))
    return recording, study.name(cell, trial)
