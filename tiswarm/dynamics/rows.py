"""Rows: where the numbers of an agent and of a block lie in the arrays of a batch."""

from types import SimpleNamespace

from tiswarm.scenario.barrier import MOST_JOINT
from tiswarm.scenario.measures import TRAPS

# Values of an agent's fate, in the order of recording.FATES.
STAYS, ARRIVED, CAPTURED, CRASHED = range(4)
# Rows of a block's clock: is the lane in use, has its trial ended, ticks run, states measured, and what is counted.
(
    ON, DONE, AGE, MEASURED, ALIVE_COUNT, ARRIVED_COUNT, CAPTURED_COUNT, CRASHED_COUNT, FIRST_ARRIVAL, LAST_ARRIVAL, CLOCK_ROWS
) = range(11)  # fmt: skip
# Rows of a block's whole numbers: the trial in each lane (as random numbers know it), its tick, and its place in the batch.
TRIAL, TICK, JOB, INTEGER_ROWS = range(4)

# Rows of the board on which a block's commands are corrected together: of an agent its point and velocity, the last one that of
# a wall; of a lane how many constraints it has met, and whether any of them is new; and of each constraint what
# joint_solution.py says.
JOINT_AGENT, JOINT_CONSTRAINT = 4, 7
JOINT_LENGTH = JOINT_AGENT * (MOST_JOINT + 1)
JOINT_NEW = JOINT_LENGTH + 1
JOINT_FIRST = JOINT_NEW + 1
JOINT_ROWS = JOINT_FIRST + JOINT_CONSTRAINT * (MOST_JOINT * (MOST_JOINT - 1) // 2 + 4 * MOST_JOINT)


def agent_rows(
    dim: int, unicycles: bool, measures: tuple[str, ...], swept: bool, listed: bool = False, safe: bool = False
) -> SimpleNamespace:
    """Lay out the rows of an agent in a block: where it is, what contact decided, what it saw, and its next state."""
    row = iter(range(100))

    def vector() -> list[int]:
        return [next(row) for _ in range(dim)]

    def trap() -> SimpleNamespace:
        """See traps.py."""
        vectors = {name: vector() for name in ("anchor", "last", "total")}
        names = ("held", "path", "counted", "time", "spin", "most", "spin_sum", "most_sum")
        return SimpleNamespace(**vectors, **{name: next(row) for name in names})

    return SimpleNamespace(
        place=vector(),
        motion=vector(),
        alive=next(row),
        fate=next(row),
        field=vector(),
        seen=next(row),
        hit=next(row),  # predators: touches prey; prey: has been inside an obstacle
        next_place=vector(),
        next_motion=vector(),
        travel=vector() if swept else [],  # how far it came in the last tick, across a periodic edge, too
        heading=[next(row), next(row)] if unicycles else [],  # cosine and sine
        label=next(row) if "groups" in measures else -1,
        trap=trap() if set(TRAPS) & set(measures) else None,
        plan=next(row) if listed else -1,  # the cell in which a prey's plan begins
        corrected=next(row) if safe else -1,  # whether a certificate changed the last command
        count=next(row),
    )
