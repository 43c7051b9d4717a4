"""Race rules: an arms race as its TOML file states it."""

from typing import Annotated, Any

from pydantic import Field, ValidationError

from tiswarm.scenario.errors import ScenarioError, explained
from tiswarm.scenario.parts import Part
from tiswarm.scenario.presets import read_toml
from tiswarm.studies.design import find_study


class Training(Part):
    """A network that a side trains where its numbers gain nothing, or little: what it begins with, and what that may cost."""

    begin: dict[str, Any]  # keys of the scenario, the strategy and the network among them
    under: Annotated[float, Field(ge=0.0, le=1.0)] = 0.0  # trained where numbers gain less than this, too
    budget: Annotated[int, Field(strict=True, ge=1)] = 192_000  # trials of each search, in each scenario that counts
    candidates: Annotated[int, Field(strict=True, ge=4, multiple_of=2)] = 48  # they come in pairs
    search_trials: Annotated[int, Field(strict=True, ge=1)] = 10  # of each candidate


class Contestants(Part):
    """What one side begins with, and the keys that its answers may change: KEY = [LOW, HIGH] or [LOW, HIGH, SCALE]."""

    policies: Annotated[tuple[dict[str, Any], ...], Field(min_length=1)]
    over: dict[str, tuple[float, float] | tuple[float, float, str]]
    network: Training | None = None


class Rules(Part):
    """An arms race as its TOML file states it."""

    title: str
    source: str = ""
    base: str
    trials: Annotated[int, Field(strict=True, ge=2)] = 10_000  # of each cell of the pay-off matrix
    seed: Annotated[int, Field(strict=True, ge=0)] = 0
    rounds: Annotated[int, Field(strict=True, ge=1, le=100)] = 5
    budget: Annotated[int, Field(strict=True, ge=1)] = 128_000  # trials of each search, in each scenario that counts
    candidates: Annotated[int, Field(strict=True, ge=4)] = 24
    search_trials: Annotated[int, Field(strict=True, ge=1)] = 100  # of each candidate
    checks: Annotated[int, Field(strict=True, ge=2)] = 2000
    prey: Contestants
    predators: Contestants


def rules_of(name: str) -> Rules | None:
    """Read the rules of a race by the name or path of its file; None for a study that is none. Errors: ScenarioError."""
    table = read_toml(find_study(name))
    if "rounds" not in table:
        return None
    try:
        rules = Rules.model_validate(table)
    except ValidationError as error:
        raise ScenarioError(f"{name}: {explained(error, Rules)}") from None
    for side, own in (("prey", rules.prey), ("predators", rules.predators)):
        if own.network is not None and f"{side}.weights.network" not in own.network.begin:
            raise ScenarioError(f"{name}: {side}.network.begin: add '{side}.weights.network', the network to begin with")
    return rules
