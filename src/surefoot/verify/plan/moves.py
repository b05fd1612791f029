"""One move of the action game, transcribed from rules.md 5 into compiled functions.

A *core* is (row, column, heading, stance, mode). Rules travel as arrays in ``Rules``, which compiled
code can read.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from surefoot.verify.navigation.claims import Claims
from surefoot.verify.scene.derived import STOP

Array = NDArray[Any]
STANDING, WALKING, READY = 0, 1, 2
CONTINUE, STOPPING, STAY, START, PRE_STEP, TURN, STRAIGHT = range(7)
NOWHERE = 4
(
    FINE,
    LOST_CROSSING,
    SIDE_BAND,
    STAIRS_HEADING,
    STAIRS_FOOT,
    STEP_HEIGHT,
    NO_ROW,
    NOT_ALLOWED,
    FOREIGN_BORDER,
) = range(9)
OFFSETS = np.array([(-1, 0), (0, 1), (1, 0), (0, -1)], np.int64)


class Rules(NamedTuple):
    """The numbers of the action game.

    Attributes:
        sizes: cells per side, side band, steps of a turn, sagittal and lateral outcomes, stop and pre-step length.
        straight: lengths of the straight moves.
        booked: (type A or B, step, 2) displacement ahead and toward the turn's side, in the first heading's frame.
        here: profile of each context.
        order: order of each context, 4 is stop.
        there: profile of the cell that the order leads to.
        up: axis of each profile, -1 for flat.
        heights: (profile, n) relative to the border where the axis enters.
        gain: of each profile.
        admissible: (profile, n).
        step_height: the largest height change of a move.
    """

    sizes: Array
    straight: Array
    booked: Array
    here: Array
    order: Array
    there: Array
    up: Array
    heights: Array
    gain: Array
    admissible: Array
    step_height: float


def rules_of(claims: Claims) -> Rules:
    """Return the numbers of the action game of a plan."""
    n, steps = claims.whole("fine_cells"), claims.turn_steps
    names = ("sagittal_outcomes_cells", "lateral_outcomes_cells", "stop_cells", "pre_step_cells")
    flat = [profile is None for profile in claims.profiles]
    heights = np.zeros((len(flat), n))
    admissible = np.ones((len(flat), n), np.bool_)
    for index, profile in enumerate(claims.profiles):
        if profile is not None:
            heights[index], admissible[index] = profile.heights_m, profile.admissible
    contexts = np.array(claims.contexts, np.int64).reshape(-1, 3)
    return Rules(
        sizes=np.array([n, claims.whole("side_band_cells"), steps, *(claims.whole(name) for name in names)], np.int64),
        straight=np.array(claims.straight, np.int64),
        booked=np.stack([booked(lengths) for lengths in claims.turns]),
        here=contexts[:, 0].copy(),
        order=contexts[:, 1].copy(),
        there=contexts[:, 2].copy(),
        up=np.array([-1 if profile is None else int(profile.up) for profile in claims.profiles], np.int64),
        heights=heights,
        gain=np.array([0.0 if profile is None else profile.gain_m for profile in claims.profiles]),
        admissible=admissible,
        step_height=claims.walking["max_step_height_m"],
    )


def booked(lengths: tuple[float, ...]) -> NDArray[np.int64]:
    """Return (steps, 2) what each step of a turn books, ahead and toward its side, in fine cells.

    The first i steps book the cell that contains their true end, so a step books the difference of two such cells.
    """
    angle = math.pi / 2 / len(lengths)
    ahead = aside = 0.0
    before, found = (0, 0), []
    for step, length in enumerate(lengths):
        ahead += length * math.cos((step + 1) * angle)
        aside += length * math.sin((step + 1) * angle)
        now = (math.floor(ahead + 0.5), math.floor(aside + 0.5))
        found.append((now[0] - before[0], now[1] - before[1]))
        before = now
    return np.array(found, np.int64)


@njit(cache=True, inline="always")
def order_side(rules: Rules, heading: int, order: int) -> int:
    """Return 0 or 1 when an order lies left or right of a cardinal heading, else -1."""
    steps = rules.sizes[2]
    if order == STOP:
        return -1
    turn = (order * steps - heading) % (4 * steps)
    return 1 if turn == steps else 0 if turn == 3 * steps else -1


@njit(cache=True, inline="always")
def allowed(rules: Rules, heading: int, stance: int, mode: int, order: int, action: int) -> bool:
    """Return whether the table of actions allows an action."""
    if mode > READY:
        return action == CONTINUE
    side = order_side(rules, heading, order)
    if mode == STANDING:
        return action == (STAY if order == STOP else START)
    if mode == READY:
        return action == TURN and side == stance
    if order == STOP:
        return action == STOPPING
    if action in (PRE_STEP, TURN):
        return side >= 0 and side != stance
    return STRAIGHT <= action < STRAIGHT + len(rules.straight)


@njit(cache=True, inline="always")
def outcome_limits(rules: Rules, core: tuple[int, int, int, int, int], kind: int, action: int) -> tuple[int, int]:
    """Return the largest sagittal and lateral outcome that the environment may choose."""
    row, column, heading, _, mode = core
    n, band, steps = rules.sizes[0], rules.sizes[1], rules.sizes[2]
    if action == STAY:
        return 0, 0
    if action in (CONTINUE, TURN):
        done = turn_steps_done(rules, heading, mode)
        return 0, rules.sizes[4] if done + 1 == steps else 0
    inside = band <= row < n - band and band <= column < n - band
    return (rules.sizes[3] if inside and rules.up[kind] < 0 else 0), 0


@njit(cache=True, inline="always")
def turn_steps_done(rules: Rules, heading: int, mode: int) -> int:
    """Return how many steps of a turn are done."""
    if mode <= READY:
        return 0
    return int(heading % rules.sizes[2] if mode % 2 == 0 else -heading % rules.sizes[2])


@njit(cache=True, inline="always")
def moved(
    rules: Rules, core: tuple[int, int, int, int, int], order: int, action: int, sagittal: int, lateral: int
) -> tuple[int, int, int, int, int]:
    """Return the core after an allowed action and an outcome, with the position not yet wrapped."""
    row, column, heading, stance, _ = core
    steps, toggled = rules.sizes[2], 1 - stance
    if action == STAY:
        return core
    if action in (CONTINUE, TURN):
        return _turned(rules, core, order, lateral)
    length, after = rules.sizes[5], WALKING
    if action == STOPPING:
        after = STANDING
    elif action == PRE_STEP:
        length, after = rules.sizes[6], READY
    elif action >= STRAIGHT:
        length = rules.straight[action - STRAIGHT]
    ahead = OFFSETS[heading // steps]
    reach = length + sagittal
    return row + reach * ahead[0], column + reach * ahead[1], heading, toggled, after


@njit(cache=True, inline="always")
def _turned(
    rules: Rules, core: tuple[int, int, int, int, int], order: int, lateral: int
) -> tuple[int, int, int, int, int]:
    """Return the core after the next step of a turn."""
    row, column, heading, stance, mode = core
    steps = rules.sizes[2]
    if mode <= READY:
        right = order_side(rules, heading, order) == 1
        kind = 0 if mode == WALKING else 1
    else:
        right, kind = mode % 2 == 0, 0 if mode <= 4 else 1
    done = turn_steps_done(rules, heading, mode)
    sign = 1 if right else -1
    first = (heading - sign * done) % (4 * steps) // steps
    ahead, aside = OFFSETS[first], OFFSETS[(first + sign) % 4]
    far, wide = rules.booked[kind, done]
    left = OFFSETS[(first + sign + 3) % 4]
    row += far * ahead[0] + wide * aside[0] + lateral * left[0]
    column += far * ahead[1] + wide * aside[1] + lateral * left[1]
    after = WALKING
    if done + 1 < steps:
        after = (4 if right else 3) if kind == 0 else (6 if right else 5)
    return row, column, (heading + sign) % (4 * steps), 1 - stance, after


@njit(cache=True, inline="always")
def landed(
    rules: Rules, core: tuple[int, int, int, int, int], context: int, action: int, after: tuple[int, int, int, int, int]
) -> tuple[int, bool, int]:
    """Return the broken rule or ``FINE``, whether the order is achieved, and the border crossed or ``NOWHERE``."""
    n, order = rules.sizes[0], rules.order[context]
    crossed = NOWHERE
    row, column = after[0], after[1]
    if (row < 0 or row >= n) and (column < 0 or column >= n):
        return LOST_CROSSING, False, NOWHERE
    if row < -n or row >= 2 * n or column < -n or column >= 2 * n:
        return LOST_CROSSING, False, NOWHERE
    if row < 0 or row >= n:
        crossed = 0 if row < 0 else 2
    elif column < 0 or column >= n:
        crossed = 3 if column < 0 else 1
    if crossed not in (NOWHERE, order):
        return LOST_CROSSING, False, NOWHERE
    here = rules.here[context]
    there = rules.there[context] if crossed != NOWHERE else here
    broken = _stairs(rules, core, here, there, crossed, action, after)
    if broken == FINE and after[2] % rules.sizes[2] == 0:
        aside = column if after[2] // rules.sizes[2] % 2 == 0 else row
        if not rules.sizes[1] <= aside % n < n - rules.sizes[1]:
            broken = SIDE_BAND
    return broken, crossed != NOWHERE or (order == STOP and after[4] == STANDING), crossed


@njit(cache=True, inline="always")
def _stairs(
    rules: Rules,
    core: tuple[int, int, int, int, int],
    here: int,
    there: int,
    crossed: int,
    action: int,
    after: tuple[int, int, int, int, int],
) -> int:
    """Return the broken rule of stairs, or ``FINE``."""
    n, steps = rules.sizes[0], rules.sizes[2]
    if action == STAY:
        return FINE
    for kind in (here, there):
        if rules.up[kind] >= 0 and (after[2] % steps or (after[2] // steps - rules.up[kind]) % 2):
            return STAIRS_HEADING
    end = along(rules, there, after[0] % n, after[1] % n)
    if not rules.admissible[there, end]:
        return STAIRS_FOOT
    change = rules.heights[there, end] - rules.heights[here, along(rules, here, core[0], core[1])]
    if crossed != NOWHERE:
        change += border(rules, here, crossed) - border(rules, there, (crossed + 2) % 4)
    level = action in (CONTINUE, STOPPING, START, TURN)
    return STEP_HEIGHT if abs(change) > (0.0 if level else rules.step_height) + 1e-9 else FINE


@njit(cache=True, inline="always")
def along(rules: Rules, kind: int, row: int, column: int) -> int:
    """Return the fine index of a position along the axis of its profile."""
    n, up = rules.sizes[0], rules.up[kind]
    if up == 1:
        return column
    if up == 3:
        return int(n - 1 - column)
    return row if up == 2 else int(n - 1 - row)


@njit(cache=True, inline="always")
def border(rules: Rules, kind: int, side: int) -> float:
    """Return the height of a cell at a border, relative to where its axis enters."""
    return float(rules.gain[kind] if rules.up[kind] == side else 0.0)


@njit(cache=True, inline="always")
def foreign_kept(rules: Rules, core: tuple[int, int, int, int, int], order: int, last: int) -> bool:
    """Return whether a state of a turn keeps the side band from all borders but the ordered and last crossed ones."""
    if core[4] <= READY:
        return True
    n, band = rules.sizes[0], rules.sizes[1]
    gaps = (core[0], n - 1 - core[1], n - 1 - core[0], core[1])
    kept = True
    for side in range(4):
        kept = kept and (side in (order, last) or gaps[side] >= band)
    return kept
