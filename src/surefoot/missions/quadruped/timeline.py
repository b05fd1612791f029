"""Planner and tracker as two timelines: when a motion is planned, when it is sent, and when it is walked.

The planner starts on the next motion when the one before begins to be walked, so that what it sees is at most one
motion old. Case (a): the next motion is there before the robot comes to rest and is appended without a stop; case (b):
the robot stands and waits for it.

Source: Zhou et al. 2025, VIII-B and Fig. 6.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from surefoot.errors import InputError

MOST_DELAYS = 10_000


@dataclass(frozen=True, slots=True)
class Slot:
    """One motion on both timelines [s of the mission].

    Attributes:
        plan_start_s: when the planner begins.
        sent_s: when it is done.
        start_s: when the robot begins to walk.
        end_s: when it stands again.
        idle_s: how long it stood before, waiting; what the first motion takes to plan does not count.
    """

    plan_start_s: float
    sent_s: float
    start_s: float
    end_s: float
    idle_s: float

    @property
    def case(self) -> str:
        """The paper's case: ``a``, appended without a stop, or ``b``, stance and wait."""
        return "b" if self.idle_s > 0 else "a"


@dataclass(frozen=True, slots=True)
class Clock:
    """Where both timelines are.

    Attributes:
        planner_s: when the planner is free.
        walked_s: when the robot stands again.
        begun: whether it ever walked.
    """

    planner_s: float = 0.0
    walked_s: float = 0.0
    begun: bool = False

    def planned(self, planning_s: float) -> Clock:
        """Return the clock after planning that sent nothing."""
        return Clock(self.planner_s + planning_s, self.walked_s, self.begun)

    def walked(self, plan_start_s: float, horizon_s: float) -> tuple[Slot, Clock]:
        """Return a motion's place, planned by now, and the clock at which the planner begins on the next one."""
        sent_s = self.planner_s
        late = sent_s > self.walked_s
        start_s = sent_s if late else self.walked_s
        idle_s = start_s - self.walked_s if late and self.begun else 0.0
        slot = Slot(plan_start_s, sent_s, start_s, start_s + horizon_s, idle_s)
        return slot, Clock(start_s, start_s + horizon_s, begun=True)


def timeline(planning_s: Sequence[float], horizons_s: Sequence[float]) -> tuple[Slot, ...]:
    """Return the slots of motions that are planned one after another.

    Args:
        planning_s: what planning each takes.
        horizons_s: how long each is walked.
    """
    clock, slots = Clock(), []
    for planning, horizon in zip(planning_s, horizons_s, strict=True):
        begin_s = clock.planner_s
        slot, clock = clock.planned(planning).walked(begin_s, horizon)
        slots.append(slot)
    return tuple(slots)


def delays(text: str | None) -> tuple[float, ...]:
    """Read injected delays: seconds, one or several that take turns.

    Raises:
        InputError: they are no numbers from 0 to 1000.
    """
    try:
        found = tuple(float(word) for word in text.split(",")) if text else (0.0,)
    except ValueError:
        found = ()
    if not found or len(found) > MOST_DELAYS or not all(0 <= one <= 1000 for one in found):
        raise InputError("needs seconds from 0 to 1000, one number or several in turns such as 0,0,3", key="--delay")
    return found


def delay_of(given: Sequence[float], segment: int) -> float:
    """Return the injected delay of a segment."""
    return given[segment % len(given)]
