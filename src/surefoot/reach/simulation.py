"""One walking step with its pushes, sample by sample.

The controller looks at samples only; a push may come at any instant and is a jump of position and velocity. The first
half step ends at the first sample in the guard, the step at the first sample in the target, or when the orbit crosses
the next apex position.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from surefoot.reach import _walks
from surefoot.reach.ensembles import NOMINAL_OMEGA_RADPS, Law, goal, law_tables, small_rates
from surefoot.reach.look_up import HalfStepController
from surefoot.reach.synthesis import Region


class Ending(StrEnum):
    """How a simulated step ended."""

    REACHED = "a sample lies in the target"
    CROSSED = "the next apex was crossed inside the window, between two samples"
    MISSED = "the next apex was crossed outside the window"
    LEFT_REGION = "the state left the region, where the law has no omega"
    FALLEN_BACK = "the velocity fell to zero before the foot"
    TOO_LONG = "the step took too long"


@dataclass(frozen=True, slots=True)
class Push:
    """A jump of the state.

    Attributes:
        time_s: since the begin of the step.
        velocity_mps: what is added to the velocity.
        position_m: what is added to the position.
    """

    time_s: float
    velocity_mps: float
    position_m: float = 0.0


@dataclass(frozen=True, slots=True)
class Trace:
    """A simulated step: one entry per sample.

    Attributes:
        ending: how it ended.
        times_s: of the samples.
        positions_m: of the CoM.
        velocities_mps: of the CoM.
        omegas_radps: held from each sample on (the last one is not used).
        switch: index of the sample at which the foot was switched, or None.
        margin_mps: by what velocity the state was outside the region when it left it; 0 otherwise.
    """

    ending: Ending
    times_s: tuple[float, ...]
    positions_m: tuple[float, ...]
    velocities_mps: tuple[float, ...]
    omegas_radps: tuple[float, ...]
    switch: int | None
    margin_mps: float = 0.0

    @property
    def succeeded(self) -> bool:
        """Whether the next apex was met inside its window."""
        return self.ending in (Ending.REACHED, Ending.CROSSED)


def simulate(
    region: Region,
    x_m: float,
    v_mps: float,
    pushes: Sequence[Push] = (),
    *,
    seed: int | None = None,
    law: str = "table",
) -> Trace:
    """Walk one step from a state.

    Args:
        region: synthesised with all masks.
        x_m: position at the start, in the frame of the step.
        v_mps: velocity at the start.
        pushes: jumps of the state.
        seed: of small disturbances within the bound of the synthesis; None means no disturbance.
        law: ``table`` or ``barrier`` (see ``Law``).
    """
    tables, aim, code = law_tables(region), goal(region), _walks.TABLE if Law(law) is Law.TABLE else _walks.BARRIER
    rates = np.zeros((_walks.MOST_SAMPLES, 2))
    if seed is not None:
        rates = small_rates(region.settings, (_walks.MOST_SAMPLES,), np.random.default_rng(seed))
    coming = sorted(pushes, key=lambda push: push.time_s)
    x, v, half, previous = float(x_m), float(v_mps), 0, NOMINAL_OMEGA_RADPS
    times, xs, vs, omegas = [], [], [], []
    switch, ending, margin, length = None, Ending.TOO_LONG, 0.0, region.transition.step_length_m
    for k in range(_walks.MOST_SAMPLES):
        if half == 0 and _walks.may_switch(tables, code, x, v):
            half, switch = 1, k
        w = _omega(tables, code, half, x, v, aim.tau, previous)
        times.append(k * aim.tau)
        xs.append(x)
        vs.append(v)
        omegas.append(w)
        found = _ended(half, x, v, w, aim)
        if found is not None:
            ending = found
            break
        before = (x, v)
        x, v, coming = _sample(x, v, tables.feet[half], w, rates[k], aim.tau, k, coming)
        if half == 1 and before[0] < length < x and not (aim.x_low <= x <= aim.x_high):
            v_apex = _at_position(before, (x, v), length)
            inside = aim.v_low <= v_apex <= aim.v_high
            ending = Ending.CROSSED if inside else Ending.MISSED
            times.append((k + 1) * aim.tau)
            xs.append(x)
            vs.append(v)
            omegas.append(w)
            break
        previous = w
    if ending is Ending.LEFT_REGION:
        margin = HalfStepController(region, region.first if half == 0 else region.second).margin(x, v)
    return Trace(ending, tuple(times), tuple(xs), tuple(vs), tuple(omegas), switch, margin)


def _omega(tables: _walks.Tables, law: int, half: int, x: float, v: float, tau: float, previous: float) -> float:
    wish = 0.5 * (NOMINAL_OMEGA_RADPS + previous)
    if law == _walks.TABLE:
        return float(_walks.table_omega(tables, half, x, v, wish))
    return float(_walks.barrier_omega(tables, half, x, v, tau, wish))


def _ended(half: int, x: float, v: float, w: float, aim: _walks.Goal) -> Ending | None:
    if half == 1 and aim.x_low <= x <= aim.x_high and aim.v_low <= v <= aim.v_high:
        return Ending.REACHED
    if x > aim.x_high:
        return Ending.MISSED
    if v <= 0:
        return Ending.FALLEN_BACK
    return Ending.LEFT_REGION if math.isnan(w) else None


def _sample(
    x: float, v: float, foot: float, w: float, rates: np.ndarray, tau: float, k: int, coming: list[Push]
) -> tuple[float, float, list[Push]]:
    """Flow over one sample with the pushes that fall into it."""
    at, end = 0.0, tau
    while coming and coming[0].time_s < (k + 1) * tau:
        push, coming = coming[0], coming[1:]
        until = min(max(push.time_s - k * tau, at), end)
        x, v = _walks.advance(x, v, foot, w, rates[0], rates[1], until - at)
        x, v, at = x + push.position_m, v + push.velocity_mps, until
    x, v = _walks.advance(x, v, foot, w, rates[0], rates[1], end - at)
    return float(x), float(v), coming


def _at_position(before: tuple[float, float], after: tuple[float, float], x: float) -> float:
    """Return the velocity at a position between two samples; its square is nearly linear in position there."""
    share = (x - before[0]) / (after[0] - before[0])
    return math.sqrt(max(before[1] ** 2 + share * (after[1] ** 2 - before[1] ** 2), 0.0))
