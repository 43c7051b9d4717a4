"""Terms: what the moves of a kind of agents can consist of."""

from typing import Any

from tiswarm.space import box


def names(layout: Any, kind: str) -> list[str]:
    """List the terms that moves can have, in the order in which they change the velocity. layout: a `Layout`."""
    strategies, frame = layout.parts(kind, "strategy"), layout.structure.frame
    prey = kind == "prey"
    steering = [p.part.name for p in strategies if {"steer", "integrate", "roam"} & set(p.own)]
    kicks = prey and any(p.strategy.dice for p in strategies)
    return [
        *(("separation", "cohesion", "alignment") if layout.flocks(kind) else ()),
        *(("goal",) if prey and frame.targeted else ()),
        *(("field",) if layout.parts(kind, "avoidance", "field") else ()),
        *(("walls",) if box.walled(frame.boundary) else ()),
        *(steering if prey else ("pursuit",)),
        *(("turn",) if layout.parts(kind, "avoidance", "blocks") else ()),
        "cap",
        *(("deflection",) if layout.parts(kind, "avoidance", "deflect") else ()),
        *(("kick",) if kicks else ()),
        *(("barrier",) if prey and frame.safety else ()),
    ]
