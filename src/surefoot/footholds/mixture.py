"""The bound of prices made smooth: feet and numbers of feet in contact as means over all that is nearly cheapest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surefoot.footholds.dual import FootCosts, Pricing
from surefoot.footholds.rows import Array
from surefoot.footholds.sharing import Prices, dearness, savings, shifted
from surefoot.footholds.swings import swing_of
from surefoot.footholds.ways import Charges, Ways, ways_of

_FEET = np.arange(5)
_LEAST = 1e-7


@dataclass(frozen=True, slots=True, eq=False)
class Mixture:
    """What prices prove at some heat, and the mean of what is nearly cheapest.

    Attributes:
        value: at most what the same prices prove with footholds at points.
        off_m: how far the feet are from their nominal positions, in the axes of the base, shape (N, 4, 3).
        draw: what the force that moves the base exceeds that of the feet by, twice, shape (N, 3).
        missing: how many feet more the force wants in contact, shape (M,).
        base_m: shape (N, 3).
        standing: by foot, how much stands where, shape (M, B).
    """

    value: float
    off_m: Array
    draw: Array
    missing: Array
    base_m: Array
    standing: list[Array]


def mixture_at(pricing: Pricing, prices: Prices, heat: float) -> Mixture:
    """Return what prices prove at some heat; the bounds of Eq. (16) are not taken away from it.

    Args:
        pricing: its footholds are points.
        prices: multipliers.
        heat: see ``ways_of``.
    """
    problem = pricing.problem
    world = np.einsum("iab,ijb->ija", problem.rotations, prices.reach)
    base = pricing.base(world.sum(axis=1), prices)
    left, parts = _numbers_of_feet(savings(problem, prices), prices.contact, heat)
    table = pricing.table(world, prices.contact)
    ways = [ways_of(charges_of(table, foot), heat) for foot in range(4)]
    held = np.sum([way.standing.sum(axis=1) for way in ways], axis=0)
    nominal = np.array(problem.robot.feet_m)
    value = base.value + left + sum(way.value for way in ways) - float((prices.reach * nominal).sum())
    with np.errstate(divide="ignore"):
        ease = np.repeat(parts @ (1 / dearness(problem, prices.split)), pricing.per)[:, None]
    return Mixture(
        value,
        np.einsum("iba,ijb->ija", problem.rotations, _mean_path(table, world, ways) - base.path_m[:, None]) - nominal,
        2 * base.force_n - 2 * shifted(problem, prices) * ease,
        parts @ _FEET - held,
        base.path_m,
        [way.standing for way in ways],
    )


def charges_of(table: FootCosts, foot: int) -> Charges:
    """Return what a foot is charged at points."""
    pricing, swings = table.pricing, table.swings
    middle = pricing.boxes[foot][2]
    half = (middle**2).sum(axis=1) / 2
    stood = table.square[:, None] * half + table.slopes[foot] @ middle.T + table.constants[foot][:, None]
    return Charges(
        middle, half, pricing.level[foot], stood, swings.ends, swings.slopes[foot], swings.constants[foot],
        swings.high_slopes[foot], swings.high_constants[foot], pricing.within[foot],
        pricing.problem.options.min_dwell_cells,
    )  # fmt: skip


def _numbers_of_feet(saved: Array, contact: Array, heat: float) -> tuple[float, Array]:
    """Return what is left of savings after feet are paid, and the parts of 0 to 4 feet in every cell, shape (M, 5)."""
    paid = contact[:, None] * _FEET - saved
    least = paid.min(axis=1, keepdims=True)
    weights = np.exp((least - paid) / heat)
    total = weights.sum(axis=1, keepdims=True)
    return float((least - heat * np.log(total)).sum()), weights / total


def _mean_path(table: FootCosts, world: Array, ways: list[Ways]) -> Array:
    """Return the mean positions of all feet, shape (N, 4, 3)."""
    pricing, problem = table.pricing, table.pricing.problem
    per, weights, count = pricing.per, problem.weights, pricing.count
    path = np.zeros((problem.samples, 4, 3))
    for foot, way in enumerate(ways):
        path[:, foot] = np.repeat(way.standing @ pricing.boxes[foot][2], per, axis=0)
    swung = np.stack([way.swung for way in ways])
    ends = np.stack([[way.left.sum(axis=(0, 1)), way.reached.sum(axis=(0, 1))] for way in ways])
    share = swung.sum(axis=(1, 2))
    linear = world - 2 * weights.foot * problem.foot_reference_m
    for cells in range(1, count - 1):
        feet, lift = np.nonzero(np.diagonal(share, cells, 1, 2) > _LEAST)
        if not len(feet):
            continue
        size, to = cells * per, lift + cells
        one = swing_of(size, problem.step_s, weights.foot, weights.foot_acceleration)
        samples = lift[:, None] * per + np.arange(size)
        pull = linear[samples, feet[:, None]] * share[feet, lift, to][:, None, None]
        pressed = table.swings.pressed[cells][feet, :, :, lift - 1]
        pull[:, :, 2] -= np.einsum("sab,sabk->sk", swung[feet, :, :, lift, to], pressed)
        between = np.einsum("ek,sea->ska", one.gain, ends[feet, :, lift, to]) - np.einsum(
            "kl,sla->ska", one.inverse, pull[:, :-1]
        )
        np.add.at(path, (samples[:, :-1], feet[:, None]), between)
        np.add.at(path, (samples[:, -1], feet), ends[feet, 1, lift, to])
    return path
