"""Integrator: from a course to the next state: drives, the step itself, and edges of the world."""

from dataclasses import dataclass

import taichi as ti

from tiswarm.dynamics.table import ParameterTable
from tiswarm.simd.lanes import cosine, dot, larger, place, safe, sine, smaller, unit
from tiswarm.simd.runtime import Func
from tiswarm.space import box, box_lanes


@ti.func
def drifted(place, rate, step):
    """Give a coordinate after half a step with the old velocity, so that forces are felt in its middle (Verlet)."""
    half = 0.5 * step
    return place + half * rate


@dataclass(frozen=True)
class KindSteps:
    """The step of one kind of agents."""

    limited: Func  # cap the speed; where there is a least speed, raise it to that
    drift: Func  # half a step with the old velocity
    face: Func  # let a unicycle that starts head where it moves, or along x when it stands
    advance: Func  # proceed; where certificates have a say first, write the command down
    proceed: Func  # write the next state down: p + v dt, or its second half under Verlet
    commit: Func


@dataclass(frozen=True)
class Steps:
    """Steps of both kinds, and the turn near walls."""

    wall_turn: Func  # turn away from walls that are nearer than the margin, by a fixed step of velocity
    prey: KindSteps
    predators: KindSteps


def build(layout: ParameterTable) -> Steps:
    """Build wall_turn, and for each kind limited, drift, face, advance and commit, one agent each."""
    at, rows, dim = layout.at, layout.rows, len(layout.axes)
    width = len(layout.paths)
    frame = layout.structure.frame

    @ti.func
    def wall_turn(course: ti.template(), me: ti.template(), numbers: ti.template(), b):
        """Turn away from walls that are nearer than the margin, by a fixed step of velocity."""
        if ti.static(box.walled(frame.boundary)):
            n = b * width
            margin = numbers[n + at.margin]
            step = numbers[n + at.turn_factor]
            if ti.static(frame.per_second):
                step = numbers[n + at.dt] * step
            for k in ti.static(range(dim)):
                here = place(me)[k]
                course[k] += ti.select(here < margin, step, 0.0)
                course[k] += ti.select(here > numbers[n + at.size[k]] - margin, -1.0 * step, 0.0)

    def kind_of(kind: str) -> KindSteps:
        columns = getattr(at, kind)
        unicycle, slow = kind in frame.unicycles, kind in frame.slow

        @ti.func
        def limited(course: ti.template(), me: ti.template(), numbers: ti.template(), b):
            """Cap the speed; where there is a least speed, raise it to that."""
            speed2 = dot(course, course)
            scale = me.max_speed / ti.sqrt(larger(speed2, me.max_speed * me.max_speed))
            if ti.static(slow):
                least = numbers[b * width + columns.min_speed]
                scale = larger(scale, ti.select(speed2 < least * least, least / ti.sqrt(safe(speed2)), 0.0))
            for k in ti.static(range(dim)):
                course[k] = scale * course[k]

        @ti.func
        def drift(agents: ti.template(), a, numbers: ti.template(), b):
            """Half a step with the old velocity."""
            step = numbers[b * width + at.dt]
            for k in ti.static(range(dim)):
                agents[a + rows.place[k]] = drifted(agents[a + rows.place[k]], agents[a + rows.motion[k]], step)

        @ti.func
        def face(agents: ti.template(), a, fresh):
            """Let a unicycle that starts head where it moves, or along x when it stands."""
            ahead = unit([agents[a + row] for row in ti.static(rows.motion)])
            stands = ti.select(dot(ahead, ahead) < 0.5, 1.0, 0.0)
            ahead[0] += stands
            for k in ti.static(range(2)):
                agents[a + rows.heading[k]] = ti.select(fresh, ahead[k], agents[a + rows.heading[k]])

        @ti.func
        def steered(agents: ti.template(), a, course: ti.template(), me: ti.template(), numbers: ti.template(), b):
            """Let a point ahead of the axle follow the course: [speed, turn rate] = diag(1, 1/ahead) R(-θ) u, both capped."""
            n = b * width
            x = agents[a + rows.heading[0]]
            y = agents[a + rows.heading[1]]
            most = numbers[n + columns.max_turn]
            speed = x * course[0] + y * course[1]
            rate = (x * course[1] - y * course[0]) / numbers[n + columns.ahead]
            speed = larger(-1.0 * me.max_speed, smaller(me.max_speed, speed))  # in this order, so that no number stays none
            angle = numbers[n + at.dt] * larger(-1.0 * most, smaller(most, rate))
            c = cosine(angle)
            s = sine(angle)
            agents[a + rows.heading[0]] = c * x - s * y
            agents[a + rows.heading[1]] = s * x + c * y
            course[0] = speed * x
            course[1] = speed * y

        @ti.func
        def proceed(agents: ti.template(), a, course: ti.template(), me: ti.template(), numbers: ti.template(), b):
            """Write the next state down: p + v dt, or its second half under Verlet."""
            step = numbers[b * width + at.dt]
            if ti.static(frame.verlet):
                step = 0.5 * step
            if ti.static(unicycle):
                steered(agents, a, course, me, numbers, b)
            for k in ti.static(range(dim)):
                agents[a + rows.next_motion[k]] = course[k]
                agents[a + rows.next_place[k]] = place(me)[k] + course[k] * step

        @ti.func
        def command(agents: ti.template(), a, course: ti.template(), me: ti.template(), numbers: ti.template(), b):  # noqa: ARG001 - as its sister
            """Write the command down."""
            for k in ti.static(range(dim)):
                agents[a + rows.next_motion[k]] = course[k]

        @ti.func
        def commit(agents: ti.template(), a, numbers: ti.template(), b):
            """Take the next state over, inside the world's edges; who is gone stays where it went, at a finite place."""
            n = b * width
            here = agents[a + rows.alive] > 0.5
            to = [agents[a + row] for row in ti.static(rows.next_place)]
            rate = [agents[a + row] for row in ti.static(rows.next_motion)]
            size = [numbers[n + column] for column in ti.static(at.size)]
            if ti.static(unicycle and box.rounded(frame.boundary)):
                found = box_lanes.reflection(to, rate, size)
                ahead = [agents[a + row] for row in ti.static(rows.heading)]
                turned = box_lanes.reversed_across([found[0], found[1]], ahead, found[4])
                for k in ti.static(range(2)):
                    agents[a + rows.heading[k]] = ti.select(here, turned[k], agents[a + rows.heading[k]])
            box_lanes.confine(frame.boundary, to, rate, size, numbers[n + columns.radius])
            for k in ti.static(range(dim)):
                if ti.static(frame.swept):
                    end = agents[a + rows.next_place[k]] if ti.static(box.wraps(frame.boundary)) else to[k]
                    travel = end - agents[a + rows.place[k]]
                    if ti.static(frame.verlet):  # the half step that went before
                        travel = travel + 0.5 * numbers[n + at.dt] * agents[a + rows.motion[k]]
                    agents[a + rows.travel[k]] = travel
                agents[a + rows.place[k]] = ti.select(here, to[k], agents[a + rows.place[k]])
                agents[a + rows.motion[k]] = rate[k]

        advance = command if kind == "prey" and frame.safety else proceed
        return KindSteps(limited=limited, drift=drift, face=face, advance=advance, proceed=proceed, commit=commit)

    return Steps(wall_turn=wall_turn, prey=kind_of("prey"), predators=kind_of("predators"))
