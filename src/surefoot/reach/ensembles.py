"""Many simulated steps at once: success rates under pushes (Shamsah et al., T-RO 2023, Table I and Fig. 11)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import InputError
from surefoot.reach import _walks
from surefoot.reach.barriers import barrier_region
from surefoot.reach.flows import rate_bounds
from surefoot.reach.parameters import Disturbance, Reading, Settings, Transition
from surefoot.reach.synthesis import Region, synthesize

NOMINAL_OMEGA_RADPS = 3.1
STEP_LENGTHS_M = (0.312, 0.416, 0.52)
WINDOWS_MPS = ((0.2, 0.45), (0.45, 0.7))
PAPER_PERCENT = ((90.2, 91.6, 92.5), (91.8, 92.2, 93.6))
PUSH_RATES = (2.0, 5.0)
PUSH_SAMPLE = 6
TABLE_READING = (
    "the jump is one sample (tau) of an enlarged rate disturbance, uniform within 2 m/s and 5 m/s^2, from t = 6 tau of "
    "the step on; starts are uniform in |x| <= 1 cm, 0.2 <= v <= 0.7 m/s and lie in the first half's region; success "
    "is a sampled state in the target"
)
_SAMPLES = 120

Floats = NDArray[np.float64]


class Law(StrEnum):
    """Which omega is held.

    TABLE: of the omegas in the mask, the one nearest to the mean of 3.1 and the previous one (the paper's criterion).
    BARRIER: a real number, so that the state goes to the middle between its barrier curves.
    """

    TABLE = "table"
    BARRIER = "barrier"


@dataclass(frozen=True, slots=True)
class Ensemble:
    """How many steps ended how."""

    runs: int
    reached: int
    left_region: int
    passed: int
    stalled: int

    @property
    def percent(self) -> float:
        """Share of the runs that reached the target [%]."""
        return 100.0 * self.reached / self.runs


@dataclass(frozen=True, slots=True)
class TableCell:
    """One cell of Table I."""

    window_mps: tuple[float, float]
    step_length_m: float
    percent: float
    paper_percent: float


def law_tables(region: Region) -> _walks.Tables:
    """Return what the compiled laws look up for a region."""
    cells = region.cells
    x = np.linspace(cells.x0_m - 0.1, cells.x_edges()[1][-1] + 0.05, 801)
    curves = barrier_region(region.transition, _with_rates(region.settings))
    first, second, switch = curves.first_half(x), curves.second_half(x), curves.guard_span(x)
    low, high = (np.nan_to_num(np.array([first[k], second[k]]), posinf=9.0, neginf=0.0) for k in (0, 1))
    return _walks.Tables(
        masks=np.stack([region.first.masks, region.second.masks]),
        guard=region.first.target,
        omegas=np.array([region.first.omegas_radps, region.second.omegas_radps]),
        x_low=cells.x0_m - 0.5 * cells.x_step_m,
        v_low=cells.v0_mps - 0.5 * cells.v_step_mps,
        x_step=cells.x_step_m,
        v_step=cells.v_step_mps,
        feet=(float(region.first.foot_m), float(region.second.foot_m)),
        low=low,
        high=high,
        switch_low=np.nan_to_num(switch[0], posinf=9.0),
        switch_high=np.nan_to_num(switch[1], neginf=-9.0),
        x0=float(x[0]),
        dx=float(x[1] - x[0]),
    )


def goal(region: Region) -> _walks.Goal:
    """Return the target box and the sampling time of a region."""
    length, half = region.transition.step_length_m, region.settings.target_half_width_m
    low, high = region.transition.apex_velocity_mps
    return _walks.Goal(length - half, length + half, float(low), float(high), float(region.settings.tau_s))


def walk_ensemble(
    region: Region,
    starts: Floats,
    rates: Floats,
    jumps: Floats | None = None,
    law: Law = Law.TABLE,
    tables: _walks.Tables | None = None,
) -> tuple[Ensemble, NDArray[np.int64]]:
    """Walk a step from many states.

    Args:
        region: with all masks.
        starts: positions and velocities, (runs, 2).
        rates: disturbance rates per run and sample, (runs, samples, 2).
        jumps: jumps of the state at the begin of samples, the same shape; None means none.
        law: which omega is held.
        tables: of the region, when they are at hand (``law_tables``).

    Returns:
        Counts, and how every run ended (codes of ``surefoot.reach._walks``).
    """
    jumps = np.zeros_like(rates) if jumps is None else jumps
    code = _walks.TABLE if law is Law.TABLE else _walks.BARRIER
    ends, _ = _walks.walk_many(
        starts, rates, jumps, code, NOMINAL_OMEGA_RADPS, tables or law_tables(region), goal(region)
    )
    counts = np.bincount(ends, minlength=5)
    return Ensemble(len(ends), *(int(n) for n in counts[:4])), ends


def random_starts(region: Region, runs: int, rng: np.random.Generator) -> Floats:
    """Return states with |x| <= 1 cm and 0.2 <= v <= 0.7 m/s inside the first half's region."""
    cells, kept = region.cells, np.empty((0, 2))
    for _ in range(1000):
        x, v = rng.uniform(-0.01, 0.01, runs), rng.uniform(0.2, 0.7, runs)
        i = np.floor((x - cells.x0_m) / cells.x_step_m + 0.5).astype(int)
        j = np.floor((v - cells.v0_mps) / cells.v_step_mps + 0.5).astype(int)
        inside = (i >= 0) & (i < cells.columns) & (j >= 0) & (j < cells.rows)
        inside[inside] = region.first.won[i[inside], j[inside]]
        kept = np.concatenate([kept, np.column_stack([x, v])[inside]])
        if len(kept) >= runs:
            return kept[:runs]
    raise InputError("the first half's region holds no state near the apex to start from")


def small_rates(settings: Settings, shape: tuple[int, ...], rng: np.random.Generator) -> Floats:
    """Return rates within the bound of the synthesis, uniform (of the reading ``jump``: none)."""
    if settings.disturbance.reading is Reading.JUMP:
        return np.zeros((*shape, 2))
    d1, d2 = rate_bounds(settings.disturbance, np.array([settings.omegas.low_radps]))
    bound = np.array([d1[0], d2[0]])
    return rng.uniform(-bound, bound, (*shape, 2))


def table_1(
    runs: int = 1000, seed: int = 0, law: Law = Law.TABLE, *, random_time: bool = False
) -> tuple[TableCell, ...]:
    """Repeat Table I in the reading ``TABLE_READING``.

    Args:
        runs: per cell.
        seed: of the random numbers.
        law: which omega is held.
        random_time: push at a uniformly random sample of the first 0.6 s instead of at 6 tau.
    """
    cells = []
    for window, paper_row in zip(WINDOWS_MPS, PAPER_PERCENT, strict=True):
        for length, paper in zip(STEP_LENGTHS_M, paper_row, strict=True):
            region = synthesize(Transition(length, window), Settings(Disturbance(Reading.RATE)))
            rng = np.random.default_rng([seed, round(1000 * length), round(1000 * window[0])])
            starts = random_starts(region, runs, rng)
            rates = small_rates(region.settings, (runs, _SAMPLES), rng)
            at = rng.integers(0, 30, runs) if random_time else np.full(runs, PUSH_SAMPLE)
            rates[np.arange(runs), at] = rng.uniform(-1, 1, (runs, 2)) * PUSH_RATES
            ensemble, _ = walk_ensemble(region, starts, rates, law=law)
            cells.append(TableCell(window, length, ensemble.percent, paper))
    return tuple(cells)


def _with_rates(settings: Settings) -> Settings:
    """Return settings whose disturbance has a closed form: jumps are left out of the curves."""
    if settings.disturbance.reading is not Reading.JUMP:
        return settings
    calm = Disturbance(Reading.RATE, 0.0, 0.0)
    return Settings(calm, settings.tau_s, settings.grid, settings.omegas, settings.guard, settings.target_half_width_m)


@dataclass(frozen=True, slots=True)
class PushMap:
    """Which share of pushed steps succeeds.

    Attributes:
        law: that walked them.
        instants_s: of the push, since the begin of the step.
        sizes_mps: of the push, a jump of velocity.
        percent: (sizes, instants).
    """

    law: Law
    instants_s: tuple[float, ...]
    sizes_mps: tuple[float, ...]
    percent: Floats


def push_map(
    region: Region,
    sizes_mps: tuple[float, ...],
    *,
    samples: int = 30,
    runs: int = 60,
    seed: int = 0,
    law: Law = Law.TABLE,
) -> PushMap:
    """Push steps from random starts by given velocity jumps at every sample, and count which succeed.

    Args:
        region: with all masks.
        sizes_mps: jumps of velocity.
        samples: the push comes at one of the first samples.
        runs: steps per size and instant.
        seed: of starts and small disturbances.
        law: which omega is held.
    """
    rng = np.random.default_rng(seed)
    starts = random_starts(region, runs, rng)
    rates = small_rates(region.settings, (runs, _SAMPLES), rng)
    tables = law_tables(region)
    percent = np.empty((len(sizes_mps), samples))
    for a, size in enumerate(sizes_mps):
        for k in range(samples):
            jumps = np.zeros_like(rates)
            jumps[:, k, 1] = size
            percent[a, k] = walk_ensemble(region, starts, rates, jumps, law, tables)[0].percent
    instants = tuple(k * region.settings.tau_s for k in range(samples))
    return PushMap(law, instants, sizes_mps, percent)
