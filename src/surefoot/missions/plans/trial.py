"""Trial walks: can every step that the action strategy commands be walked with the scenario's walking numbers?

The games decide where steps lead; whether a step of that length satisfies the theorems depends on the steps before it.
With the default numbers the ensembles of the test campaign answer for that. Other numbers are tried out when a plan is
made.
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from typing import TYPE_CHECKING

from surefoot.frames import Direction, Foot
from surefoot.missions.scenario.scene import BipedScene
from surefoot.navigation import STOP_ORDER, Action, ActionRules, ActionStrategy, FineStart, FineState, apply_action

if TYPE_CHECKING:
    from surefoot.walking import Unsafe

TRIED_FINE_CELL_M = (0.099, 0.109)
TRIED_TREAD_M = (0.35, 0.55)
WALKS, STEPS = 3, 500


@dataclass(frozen=True, slots=True)
class Trial:
    """What trial walks with random orders showed.

    Attributes:
        steps: walking steps in all.
        unsafe: walks that came to a step without any safe candidate.
        reason: why, the first time.
    """

    steps: int
    unsafe: int
    reason: str = ""


def needs_trial(scene: BipedScene) -> bool:
    """Return whether a scenario walks with other numbers than those that the test campaign covers."""
    low, high = TRIED_FINE_CELL_M
    unusual_stairs = any(
        not TRIED_TREAD_M[0] <= stairs.tread_m <= TRIED_TREAD_M[1] for stairs in scene.scenario.heights.stairs
    )
    given = scene.scenario.walking.model_dump(exclude_none=True)
    return bool(given) or unusual_stairs or not low <= scene.walking.fine_cell_m <= high


def trial_walks(
    scene: BipedScene,
    rules: ActionRules,
    strategy: ActionStrategy,
    start: FineStart,
    first_context: int,
    walks: int = WALKS,
) -> Trial:
    """Walk the action strategy under random orders, so many times STEPS steps."""
    walked = unsafe = 0
    reason = ""
    for seed in range(walks):
        steps, stopped = _walk(scene, rules, strategy, start, first_context, random.Random(seed))  # noqa: S311
        walked += steps
        unsafe += stopped is not None
        reason = reason or ("" if stopped is None else stopped.reason)
    return Trial(walked, unsafe, reason)


def _walk(
    scene: BipedScene,
    rules: ActionRules,
    strategy: ActionStrategy,
    start: FineStart,
    first_context: int,
    chance: random.Random,
) -> tuple[int, Unsafe | None]:
    from surefoot.missions.scenario.fine_steps import FineSteps
    from surefoot.walking import Unsafe, plan_step, standing_state

    tables, steps = rules.tables, FineSteps(scene, rules)
    heading = scene.problem.heading
    fine = FineState(start.row, start.column, int(heading) * tables.turn_steps, int(Foot.LEFT), 0, first_context)
    place = steps.waypoint_m(scene.problem.start, fine)
    state = standing_state(place, steps.yaw_rad(fine), Foot.LEFT, scene.walking, scene.robot)
    walked = 0
    while walked < STEPS:
        action = strategy.decide(fine)
        if action != Action.STAY:
            step = plan_step(state, steps.command(fine, action), scene.walking, scene.robot)
            if isinstance(step, Unsafe):
                return walked, step
            moved = apply_action(tables, fine, action, step.sagittal_cells, step.lateral_cells)
            state, walked = step.next_state(), walked + 1
        else:
            moved = apply_action(tables, fine, action, 0, 0)
        context = rules.contexts[fine.context]
        fine = moved.state
        if moved.achieved:
            heading = heading if context.order == STOP_ORDER else Direction(context.order)
            following = 4 * context.there + int(heading)
            choices = tables.next_context[tables.next_first[following] : tables.next_first[following + 1]]
            if not len(choices):
                return walked, None
            fine = fine._replace(context=int(chance.choice(choices.tolist())))
    return walked, None
