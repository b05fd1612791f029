"""Initial winning sets: how much of the surroundings of a keyframe surely leads to the next one.

The robust margin set of a keyframe lies between two tangent and two cotangent manifolds of its orbit. The initial
winning set I_WIN is what the region of the step holds of it; its size tells how robust a keyframe transition is.
Source: Warnke et al., Section II and Appendix B (Figs. 3 and 5). The paper gives neither margins nor grid; the margins
here are sigma = 0.002 and zeta = 0.003 at the first keyframe, sigma = 0.006 and zeta = 0.05 at the next one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from surefoot.reach._sweep import sweep
from surefoot.reach.flows import flow, images
from surefoot.reach.lattice import Cells, Lattice, above_asymptotes, lattice
from surefoot.reach.parameters import Disturbance, GridSpec, OmegaSet, Reading, Settings

GRAVITY_MPS2 = 9.81
_ZETA_SCALE, _ZETA_OFFSET_M = 1e-5, 2e-4

WORKSHOP = Settings(
    Disturbance(Reading.RATE),
    grid=GridSpec(0.004, 0.004, behind_m=0.152, beyond_m=0.2, slowest_mps=0.2),
    omegas=OmegaSet(2.0, 4.0, 0.02),
)
"""Grid and inputs of the workshop paper's examples."""


@dataclass(frozen=True, slots=True)
class Margins:
    """Bounds on the tangent (sigma) and cotangent (zeta) coordinates."""

    sigma: float
    zeta: float


@dataclass(frozen=True, slots=True)
class KeyframeStep:
    """A step between two keyframes.

    Attributes:
        apex_velocity_mps: at both apexes.
        step_length_m: between them.
        height_change_m: of the floor; the CoM stays level, so the second apex height is less by it.
        heading_change_rad: at the first apex.
        apex_height_m: at the first apex.
        dy2_m: from the apex CoM to its foot, sideways; matters with a heading change, toward the stance foot.
    """

    apex_velocity_mps: float
    step_length_m: float = 0.5
    height_change_m: float = 0.0
    heading_change_rad: float = 0.0
    apex_height_m: float = 1.0
    dy2_m: float = 0.135


@dataclass(frozen=True, slots=True)
class InitialWinningSet:
    """The sets of Fig. 3: margin set, winning set and what they share, on one grid."""

    step: KeyframeStep
    cells: Lattice
    initial: Cells
    final: Cells
    winning_second: Cells
    winning: Cells

    @property
    def shared(self) -> Cells:
        """Cells of I_WIN."""
        return np.asarray(self.initial & self.winning)

    @property
    def size(self) -> int:
        """How many cells I_WIN has."""
        return int(np.count_nonzero(self.shared))

    @property
    def area(self) -> float:
        """Area of I_WIN [m m/s]."""
        return self.size * self.cells.cell_area


def initial_winning_set(
    step: KeyframeStep,
    settings: Settings = WORKSHOP,
    initial: Margins = Margins(0.002, 0.003),
    final: Margins = Margins(0.006, 0.05),
) -> InitialWinningSet:
    """Compute the initial winning set of a keyframe transition.

    Args:
        step: between the keyframes.
        settings: disturbance, grid and inputs.
        initial: margins of the first keyframe.
        final: margins of the next keyframe, and of the tube in which the foot may be switched.
    """
    cells = lattice(settings.grid, step.step_length_m)
    v, length = step.apex_velocity_mps, step.step_length_m
    foot = step.dy2_m * math.sin(abs(step.heading_change_rad))
    along = v * math.cos(step.heading_change_rad)
    ratio = (
        math.cos(step.heading_change_rad) ** 2
    )  # sigma is measured in the scale of the keyframe, not of its projection
    first_omega = math.sqrt(GRAVITY_MPS2 / step.apex_height_m)
    second_omega = math.sqrt(GRAVITY_MPS2 / (step.apex_height_m - step.height_change_m))
    target = margin_set(cells, length, v, length, second_omega, final)
    second = _won(cells, length, target, np.ones(cells.shape, np.bool_), settings)
    guard = second & tube(cells, 0.0, along, foot, first_omega, final.sigma * ratio)
    source = above_asymptotes(cells, foot, settings.omegas.values_radps[0])
    first = _won(cells, foot, guard, source, settings)
    start = margin_set(cells, 0.0, along, foot, first_omega, Margins(initial.sigma * ratio, initial.zeta))
    return InitialWinningSet(step, cells, start, target, second, first)


def tube(cells: Lattice, apex_m: float, velocity_mps: float, foot_m: float, omega: float, sigma: float) -> Cells:
    """Return the cells wholly within +-sigma of the orbit through a state.

    sigma(x, v) = (v_a / w)^2 [v^2 - v_a^2 - w^2 ((x - x_foot)^2 - (x_a - x_foot)^2)], with x_a = x_foot at an apex.
    """
    x0, x1 = cells.x_edges()
    v0, v1 = cells.v_edges()
    far = np.maximum(np.abs(x0 - foot_m), np.abs(x1 - foot_m))
    near = np.where((x0 <= foot_m) & (x1 >= foot_m), 0.0, np.minimum(np.abs(x0 - foot_m), np.abs(x1 - foot_m)))
    scale, base = (velocity_mps / omega) ** 2, velocity_mps**2 - (omega * (apex_m - foot_m)) ** 2
    least = scale * (v0[None, :] ** 2 - base - (omega * far[:, None]) ** 2)
    most = scale * (v1[None, :] ** 2 - base - (omega * near[:, None]) ** 2)
    return np.asarray((least >= -sigma) & (most <= sigma))


def margin_set(
    cells: Lattice, apex_m: float, velocity_mps: float, foot_m: float, omega: float, margins: Margins
) -> Cells:
    """Return the cells wholly within the margins of a keyframe.

    zeta(x, v) = z0 [1 + (v / v0)^(w^2) (x - x_a) / dx], with v0 the velocity of the orbit at dx past the apex.
    """
    x0, x1 = (edges - apex_m for edges in cells.x_edges())
    v0, v1 = cells.v_edges()
    reference = math.sqrt(velocity_mps**2 + (omega * _ZETA_OFFSET_M) ** 2)
    slow, fast = ((v / reference) ** (omega**2) / _ZETA_OFFSET_M for v in (v0, v1))
    most = _ZETA_SCALE * (1 + np.maximum(x1[:, None] * fast[None, :], x1[:, None] * slow[None, :]))
    least = _ZETA_SCALE * (1 + np.minimum(x0[:, None] * fast[None, :], x0[:, None] * slow[None, :]))
    between = (least >= -margins.zeta) & (most <= margins.zeta)
    return np.asarray(between & tube(cells, apex_m, velocity_mps, foot_m, omega, margins.sigma))


def _won(cells: Lattice, foot_m: float, target: Cells, source: NDArray[np.bool_], settings: Settings) -> Cells:
    step = flow(settings.omegas.values_radps, settings.tau_s, settings.disturbance)
    won, _ = sweep(target, source, images(cells, foot_m, step), True)
    return np.asarray(won)
