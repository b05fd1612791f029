"""The step library: turns with their booked displacements, and the check of every length against the theorems."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import InputError
from surefoot.robots.biped import Biped
from surefoot.walking.parameters import WalkingParameters
from surefoot.walking.turns import booked_displacements

STOP_SPEED_MPS = 0.1
"""Apex speed at the end of a stop and at the beginning of a start."""

_SCAN_M = 0.001
_LONGEST_M = 3.0

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class TurnTemplate:
    """A quarter turn.

    Attributes:
        lengths_cells: of its steps, in fine cells.
        booked: what the action game books for every step: (forward, sideways) in fine cells, along the original
            heading and toward the side of the turn.
    """

    lengths_cells: tuple[float, ...]
    booked: tuple[tuple[int, int], ...]


@dataclass(frozen=True, slots=True)
class StepLibrary:
    """Every step that the action game may command.

    Attributes:
        parameters: of the walk.
        turn_a: the turn whose first step is away from the stance foot.
        turn_b: the turn whose first step is toward the stance foot.
    """

    parameters: WalkingParameters
    turn_a: TurnTemplate
    turn_b: TurnTemplate


def step_library(parameters: WalkingParameters, robot: Biped) -> StepLibrary:
    """Return the step library, every length checked side-aware against the theorems.

    Raises:
        InputError: if no pair of apex speeds in the allowed range admits a length; it names the allowed range.
    """
    omega = robot.omega_radps
    _check_turn_angle(parameters, omega)
    for name in ("straight_cells", "pre_step_cells", "stop_cells", "turn_a_cells", "turn_b_cells"):
        value = getattr(parameters, name)
        for i, cells in enumerate(value if isinstance(value, tuple) else (value,)):
            _check_length(f"walking.{name}", cells * parameters.fine_cell_m, _admits(parameters, omega, name, i))
    return StepLibrary(
        parameters,
        *(
            TurnTemplate(lengths, booked_displacements(lengths, parameters.turn_rad))
            for lengths in (parameters.turn_a_cells, parameters.turn_b_cells)
        ),
    )


def is_away(turn_type: str, step: int) -> bool:
    """Tell whether a turn step (counted from 1) of a turn of type A or B turns away from the stance foot."""
    return (step % 2 == 1) == (turn_type == "A")


def _check_turn_angle(parameters: WalkingParameters, omega: float) -> None:
    """Refuse a turn angle that Theorem IV.2 allows at no apex with the desired dy2, toward or away."""
    slowest, fastest = parameters.apex_speed_mps
    scale = parameters.dy2_m * omega
    most = math.degrees(min(math.atan(fastest / scale), math.atan(scale / slowest)))
    if parameters.turn_angle_deg > most:
        raise InputError(
            f"Theorem IV.2 allows no apex speed in {slowest:g} .. {fastest:g} m/s for turns of "
            f"{parameters.turn_angle_deg:g} degrees with dy2 = {parameters.dy2_m:g} m; "
            f"up to {most:.2f} degrees are allowed",
            key="walking.turn_angle_deg",
        )


def _check_length(key: str, length_m: float, admits: Callable[[Array], NDArray[np.bool_]]) -> None:
    if bool(admits(np.array([length_m]))[0]):
        return
    lengths = np.arange(_SCAN_M, _LONGEST_M, _SCAN_M)
    allowed = lengths[admits(lengths)]
    span = f"{allowed[0]:.3f} .. {allowed[-1]:.3f} m are" if allowed.size else "no length is"
    raise InputError(
        f"no pair of allowed apex speeds satisfies the safety theorems for a step of {length_m:.4f} m; {span} allowed",
        key=key,
    )


def _admits(parameters: WalkingParameters, omega: float, name: str, index: int) -> Callable[[Array], NDArray[np.bool_]]:
    """Return which lengths some pair of apex speeds admits, for one step of one key."""
    low, high = parameters.apex_speed_mps
    speeds = np.linspace(low, high, 51)
    if not name.startswith("turn"):
        final = np.array([STOP_SPEED_MPS]) if name == "stop_cells" else speeds
        return lambda lengths: _straight(lengths, speeds, final, omega, parameters.switch_speed_max_mps)
    final = np.linspace(low, parameters.steering_speed_max_mps, 51)
    away = is_away(name[5].upper(), index + 1)
    before = final if index else speeds
    return lambda lengths: _turning(lengths, before, final, omega, parameters, away)


def _straight(lengths: Array, speeds: Array, final: Array, omega: float, fastest: float) -> NDArray[np.bool_]:
    d, v, w = lengths[:, None, None], speeds[None, :, None], final[None, None, :]
    theorem = np.abs(w**2 - v**2) <= (omega * d) ** 2
    switch = 0.5 * (d + (w**2 - v**2) / (omega**2 * d))
    speed = np.sqrt(v**2 + (omega * switch) ** 2)
    return np.asarray((theorem & (speed <= fastest)).any(axis=(1, 2)))


def _turning(
    lengths: Array, speeds: Array, final: Array, omega: float, parameters: WalkingParameters, away: bool
) -> NDArray[np.bool_]:
    """Check turn steps from an apex with the desired dy2 and dy1 = 0."""
    d, v, w = lengths[:, None, None], speeds[None, :, None], final[None, None, :]
    turn, dy2 = parameters.turn_rad, parameters.dy2_m
    foot = -dy2 * math.sin(turn) if away else dy2 * math.sin(turn)
    square = (v * math.cos(turn)) ** 2
    heading = v <= dy2 * omega / math.tan(turn) if away else v >= dy2 * omega * math.tan(turn)
    corollary = (w**2 - square >= -((omega * d) ** 2)) & (w**2 - square <= omega**2 * (d**2 - 2 * foot * d))
    with np.errstate(divide="ignore", invalid="ignore"):
        switch = 0.5 * ((foot**2 + (w**2 - square) / omega**2) / (d - foot) + foot + d)
        speed = np.sqrt(square + omega**2 * ((switch - foot) ** 2 - foot**2))
    return np.asarray((heading & corollary & (speed <= parameters.switch_speed_max_mps)).any(axis=(1, 2)))
