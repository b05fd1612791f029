"""How risky an apex is: how likely it leads, some steps on, to a command that no step can follow safely.

The CoM can be steered sideways only through the apex speeds, one number a step. With steps of one length the feet's
asymmetry about the waypoints hardly changes whatever the speeds, so an apex may satisfy every rule and still lead
nowhere: the greedy choice of Algorithm 1 runs into such dead ends. Here commands are drawn at random from those that
the action game may give, the next apex is chosen with the least risk, and the risk is the discounted probability that
no choice is left. It is found by value iteration on a table over dy1, dy2 and apex speed, once for a walk. Left and
right are mirrored, so that the stance foot is always the left one.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from surefoot.walking.costs import Aim, step_cost
from surefoot.walking.library import STOP_SPEED_MPS, is_away
from surefoot.walking.parameters import WalkingParameters
from surefoot.walking.rules import SLACK, Limits, apex_from, full_candidate, lateral_candidate, sagittal_candidate
from surefoot.walking.theorems import heading_margin

STANDING, WALKING, READY = 0, 1, 2
"""Nodes of the commands; then come the pending turns of type A by steps done, then those of type B."""

COST_WEIGHT = 0.002
_DISCOUNT = 0.95
_TOLERANCE = 1e-3
_SWEEPS = 60
_DY1_M = (-0.4, 0.52, 24)
_DY2_M = (0.0, 0.345, 47)
_SPEED_MPS = (0.05, 0.1)
"""Between these the spacing of speeds follows the length of a fine cell [m/s per m]: the shorter the steps, the more a
speed decides over how long they last, and with that over where the next foot comes to stand."""
START_OFFSETS_M = np.arange(0.005, 0.15, 0.005)
"""Lateral distances of the CoM from the stance foot at the apex from which a robot starts."""

Array = NDArray[np.float64]


class RiskTable(NamedTuple):
    """The risk of every node on a grid.

    Attributes:
        values: shape (nodes, dy1, dy2, speed).
        origin: least dy1 [m], dy2 [m] and speed [m/s].
        spacing: of the grid.
    """

    values: Array
    origin: tuple[float, float, float]
    spacing: tuple[float, float, float]


def turn_node(turn_type: str, done: int, turn_steps: int) -> int:
    """Return the node of a pending turn with 1 .. k-1 steps done."""
    return READY + done + (turn_steps - 1 if turn_type == "B" else 0)


@lru_cache(maxsize=8)
def risk_table(parameters: WalkingParameters, limits: Limits, straight: Aim, steering: Aim) -> RiskTable:
    """Return the table of risks of a walk."""
    rows = _commands(parameters)
    first = np.searchsorted(rows[:, 0], np.arange(rows[-1, 0] + 2)).astype(np.int64)
    low, high = parameters.apex_speed_mps
    speed_mps = min(max(parameters.fine_cell_m, _SPEED_MPS[0]), _SPEED_MPS[1])
    axes = (_DY1_M, _DY2_M, (low, max(high, low + 0.01), max(2, round((high - low) / speed_mps) + 1)))
    table = RiskTable(
        np.zeros((first.size - 1, *(count for _, _, count in axes))),
        (axes[0][0], axes[1][0], axes[2][0]),
        (_spacing(*axes[0]), _spacing(*axes[1]), _spacing(*axes[2])),
    )
    for _ in range(_SWEEPS):
        values = _swept(table, rows, first, START_OFFSETS_M, limits, straight, steering)
        change = float(np.abs(values - table.values).max())
        table = table._replace(values=values)
        if change < _TOLERANCE:
            break
    return table


def _spacing(low: float, high: float, count: int) -> float:
    return (high - low) / (count - 1)


def _commands(parameters: WalkingParameters) -> Array:
    """Return the commands of every node, one a row, mirrored so that the left foot stands.

    Columns: node, next node, heading change, length, least and most next speed, correction allowed, and the heading
    change that has to be possible at the next apex (in its own mirrored frame).
    """
    p, cell, k = parameters, parameters.fine_cell_m, parameters.turn_steps
    low, high = p.apex_speed_mps
    away = -p.turn_rad

    def straight(node: int, after: int, cells: int, change: float = away) -> tuple[float, ...]:
        return (node, after, 0.0, cells * cell, low, high, 0, change)

    rows = [straight(STANDING, WALKING, p.stop_cells), straight(WALKING, READY, p.pre_step_cells, p.turn_rad)]
    rows += [straight(WALKING, WALKING, cells) for cells in p.straight_cells]
    rows.append((WALKING, STANDING, 0.0, p.stop_cells * cell, STOP_SPEED_MPS, STOP_SPEED_MPS, 0, 0.0))
    top = min(high, p.steering_speed_max_mps)
    for turn_type, begin, lengths in (("A", WALKING, p.turn_a_cells), ("B", READY, p.turn_b_cells)):
        for i, cells in enumerate(lengths, 1):
            node = begin if i == 1 else turn_node(turn_type, i - 1, k)
            after = WALKING if i == k else turn_node(turn_type, i, k)
            change = away if is_away(turn_type, i) else p.turn_rad
            shifts = p.lateral_outcomes_cells if i == k else 0
            rows.append((node, after, change, cells * cell, low, top, shifts, away if i == k else -change))
    return np.array(sorted(rows), np.float64)


@njit(cache=True)
def risk_at(table: RiskTable, node: int, dy1_m: float, dy2_m: float, speed_mps: float) -> float:
    """Return the risk of an apex by interpolation; 1 outside the table."""
    values = table.values
    x = (dy1_m - table.origin[0]) / table.spacing[0]
    y = (dy2_m - table.origin[1]) / table.spacing[1]
    z = 0.0 if node == 0 else (speed_mps - table.origin[2]) / table.spacing[2]
    if not (0 <= x <= values.shape[1] - 1 and 0 <= y <= values.shape[2] - 1):
        return 1.0
    z = min(max(z, 0.0), values.shape[3] - 1.0)
    i, j, k = min(int(x), values.shape[1] - 2), min(int(y), values.shape[2] - 2), min(int(z), values.shape[3] - 2)
    x, y, z = x - i, y - j, z - k
    risk = 0.0
    for d in range(2):
        weight = z if d else 1 - z
        if weight > 1e-12:
            near = (1 - y) * values[node, i, j, k + d] + y * values[node, i, j + 1, k + d]
            far = (1 - y) * values[node, i + 1, j, k + d] + y * values[node, i + 1, j + 1, k + d]
            risk += weight * ((1 - x) * near + x * far)
    return risk


@njit(cache=True)
def _swept(
    table: RiskTable,
    rows: Array,
    first: NDArray[np.int64],
    offsets_m: Array,
    limits: Limits,
    straight: Aim,
    steering: Aim,
) -> Array:
    """Return the values after one sweep of value iteration."""
    values = np.empty_like(table.values)
    for node in range(values.shape[0]):
        for i in range(values.shape[1]):
            dy1 = table.origin[0] + i * table.spacing[0]
            for j in range(values.shape[2]):
                dy2 = table.origin[1] + j * table.spacing[1]
                for k in range(values.shape[3]):
                    if node == 0 and k > 0:
                        values[node, i, j, k] = values[node, i, j, 0]
                        continue
                    speed = table.origin[2] + k * table.spacing[2]
                    total = 0.0
                    for row in rows[first[node] : first[node + 1]]:
                        if node == 0:
                            total += _start_risk(table, row, dy1 + dy2, offsets_m, limits, straight)
                        else:
                            total += _command_risk(table, row, dy1, dy2, speed, limits, straight, steering)
                    values[node, i, j, k] = total / (first[node + 1] - first[node])
    return values


@njit(cache=True)
def _command_risk(
    table: RiskTable,
    row: Array,
    dy1_m: float,
    dy2_m: float,
    speed_mps: float,
    limits: Limits,
    straight: Aim,
    steering: Aim,
) -> float:
    """Return the least risk with which a command can be carried out; 1 when it cannot."""
    apex = apex_from(dy1_m, dy2_m, speed_mps, 1.0, row[2])
    tries = round((row[5] - row[4]) / table.spacing[2]) + 1
    aim = straight if row[2] == 0 or row[6] > 0 else steering
    best = 1.0
    for i in range(tries):
        speed = row[4] + (row[5] - row[4]) * i / max(1, tries - 1)
        candidate = full_candidate(apex, row[3], speed, limits)
        if candidate.broken == 0:
            foot, com = -candidate.next_foot_left_m, -candidate.next_com_left_m
            best = _least(table, row, com, foot - com, speed, limits, aim, best)
    return best


@njit(cache=True)
def _start_risk(table: RiskTable, row: Array, foot_m: float, offsets_m: Array, limits: Limits, straight: Aim) -> float:
    """Return the least risk of a start from a stance foot."""
    tries = round((row[5] - row[4]) / table.spacing[2]) + 1
    best = 1.0
    for i in range(tries):
        speed = row[4] + (row[5] - row[4]) * i / max(1, tries - 1)
        apex = apex_from(foot_m, 0.0, 0.1, 1.0, 0.0)
        sagittal = sagittal_candidate(apex, row[3], speed, limits)
        if sagittal.broken:
            continue
        for offset in offsets_m:
            candidate = lateral_candidate(apex, foot_m - offset, sagittal, limits)
            if candidate.broken == 0:
                foot, com = -candidate.next_foot_left_m, -candidate.next_com_left_m
                best = _least(table, row, com, foot - com, speed, limits, straight, best)
    return best


@njit(cache=True)
def _least(
    table: RiskTable,
    row: Array,
    dy1_m: float,
    dy2_m: float,
    speed_mps: float,
    limits: Limits,
    aim: Aim,
    bound: float,
) -> float:
    """Return the least of a bound and the risks after the allowed corrections."""
    if heading_margin(speed_mps, dy2_m, 1.0, row[7], limits.omega_radps) < SLACK:
        return bound
    best = bound
    reach = int(row[6])
    for shift in range(-reach, reach + 1):
        dy1 = dy1_m - shift * aim.fine_cell_m
        if abs(dy1 + dy2_m) > limits.safety_distance_m - SLACK:
            continue
        risk = COST_WEIGHT * step_cost(aim, 1.0, dy1, dy2_m, 0.0, 0.0)
        if risk < best:
            risk += _DISCOUNT * risk_at(table, int(row[1]), dy1, dy2_m, speed_mps)
            best = min(best, risk)
    return best
