"""Verifies a saved step region: its sets by definition, and its promise against an adversary.

The adversary takes corners of winning cells and vertices of the disturbance, holds an omega that the file allows, and
integrates the pendulum with this module's own formulas. No step may leave the region, and every step must go forward,
so that no play can stay short of the target. Source: Shamsah et al., T-RO 2023, Definitions IV.1-IV.2.
"""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from surefoot.verify.findings import Ledger
from surefoot.verify.regions.file import RegionFile, read_region

STEPS = 100_000
WALKS = 500
HALF = Fraction(1, 2)
RULE = "Definitions IV.1-IV.2"
_TINY = 1e-12

Floats = NDArray[np.float64]


def check_region(path: Path, ledger: Ledger) -> None:
    """Verify a saved step region.

    Raises:
        InputError: a file is missing, truncated, stale or malformed.
    """
    region = read_region(path)
    _check_counts(region, ledger)
    _check_target(region, ledger)
    _check_guard(region, ledger)
    for half in ("first", "second"):
        _check_masks(region, half, ledger)
    _check_asymptotes(region, ledger)
    rng = np.random.default_rng(0)
    steps = sum(_attack(region, half, STEPS // 2, rng, ledger) for half in ("first", "second"))
    ledger.counts["adversary_steps"] = steps
    ledger.counts["adversary_walks"] = _walks(region, rng, ledger)


def _check_counts(region: RegionFile, ledger: Ledger) -> None:
    sets = {"target": "second_target", "shws": "second_won", "guard": "first_target", "fhws": "first_won"}
    for name, key in sets.items():
        found = int(np.count_nonzero(region.arrays[key]))
        ledger.counts[name] = found
        if found != region.cells.whole(name, least=0):
            ledger.refuse(
                "formats.md, step region", f"cells.{name} is not the number of cells, {found}", str(region.path)
            )


def _check_target(region: RegionFile, ledger: Ledger) -> None:
    """Every target cell lies wholly inside the target box, compared in rationals."""
    columns, rows = region.shape
    left, right = region.length - region.half_width, region.length + region.half_width
    x = [
        left < region.x0 + (i - HALF) * region.dx and region.x0 + (i + HALF) * region.dx < right for i in range(columns)
    ]
    low, high = region.window
    v = [low < region.v0 + (j - HALF) * region.dv and region.v0 + (j + HALF) * region.dv < high for j in range(rows)]
    _refuse_cells(region, "second_target", ~np.outer(x, v), "is not wholly inside the target", ledger)


def _check_guard(region: RegionFile, ledger: Ledger) -> None:
    """Every guard cell is a winning cell of the second half, ahead of the foot and between the manifolds."""
    _refuse_cells(region, "first_target", ~region.arrays["second_won"], "is no winning cell of the second half", ledger)
    x0, x1, v0, v1 = _edges(region)
    omega, slow, fast = region.tube
    near, far = np.maximum(x0 - region.first_foot, 0.0), x1 - region.first_foot
    centre_behind = x0 + x1 <= 2 * region.first_foot
    low = v0[None, :] ** 2 - slow**2 - (omega * far[:, None]) ** 2
    high = fast**2 - v1[None, :] ** 2 + (omega * near[:, None]) ** 2
    outside = (low < -_TINY) | (high < -_TINY) | centre_behind[:, None]
    _refuse_cells(region, "first_target", outside, "is not between the tangent manifolds", ledger)


def _check_masks(region: RegionFile, half: str, ledger: Ledger) -> None:
    """A cell wins when it is in the target or some omega is allowed, and only omegas that exist are allowed."""
    masks, won, target = (region.arrays[f"{half}_{name}"] for name in ("masks", "won", "target"))
    bad = won != (target | masks.any(axis=2))
    _refuse_all(bad, f"{half}_won", "wins without an omega, or has an omega and does not win", ledger)
    count = len(region.omegas[0])
    if count % 64:
        unknown = masks[:, :, -1] >> np.uint64(count % 64) != 0
        _refuse_all(unknown, f"{half}_masks", "allows an omega that is not in the set", ledger)


def _check_asymptotes(region: RegionFile, ledger: Ledger) -> None:
    """Winning cells of the first half, its guard apart, lie above both asymptotes of the least omega."""
    x0, x1, v0, _ = _edges(region)
    reach = region.omegas[0][0] * np.maximum(abs(x0 - region.first_foot), abs(x1 - region.first_foot))
    below = (v0[None, :] <= reach[:, None]) & region.arrays["first_masks"].any(axis=2)
    _refuse_cells(region, "first_won", below, "reaches below an asymptote of the least omega", ledger)


def _attack(region: RegionFile, half: str, steps: int, rng: np.random.Generator, ledger: Ledger) -> int:
    """Take extreme steps from random winning cells; return how many."""
    i, j = np.nonzero(region.arrays[f"{half}_masks"].any(axis=2))
    if i.size == 0:
        return 0
    chosen = rng.integers(0, i.size, -(-steps // 16))
    i, j = i[chosen], j[chosen]
    w = _some_omega(region, half, i, j, rng)
    x0, x1, v0, v1 = _edges(region)
    for x, v in ((x0[i], v0[j]), (x0[i], v1[j]), (x1[i], v0[j]), (x1[i], v1[j])):
        for a in (-1.0, 1.0):
            for b in (-1.0, 1.0):
                y, u = _flow(region, half, x, v, w, np.full_like(x, a), np.full_like(x, b))
                lost = ~_inside(region, f"{half}_won", y, u)
                for n in np.flatnonzero(lost)[:1]:
                    where = f"{half} half, x = {x[n]:.6g} m, v = {v[n]:.6g} m/s, omega = {w[n]:.6g} rad/s"
                    ledger.refuse(RULE, "the adversary leaves the region", where, times=int(lost.sum()))
                still = y <= x
                for n in np.flatnonzero(still)[:1]:
                    where = f"{half} half, x = {x[n]:.6g} m, v = {v[n]:.6g} m/s, omega = {w[n]:.6g} rad/s"
                    ledger.refuse(
                        RULE, "the adversary keeps the state from going forward", where, times=int(still.sum())
                    )
    return 16 * i.size


def _walks(region: RegionFile, rng: np.random.Generator, ledger: Ledger) -> int:
    """Walk whole steps against random vertices of the disturbance; each has to end in the target."""
    i, j = np.nonzero(region.arrays["first_won"])
    if i.size == 0:
        return 0
    chosen = rng.integers(0, i.size, WALKS)
    x0, x1, v0, v1 = _edges(region)
    x = x0[i[chosen]] + rng.random(WALKS) * (x1 - x0)[i[chosen]]
    v = v0[j[chosen]] + rng.random(WALKS) * (v1 - v0)[j[chosen]]
    alive, second = np.ones(WALKS, np.bool_), np.zeros(WALKS, np.bool_)
    for _ in range(100_000):
        second |= alive & _inside(region, "first_target", x, v)
        alive &= ~(second & _inside(region, "second_target", x, v))
        if not alive.any():
            return WALKS
        for half, here in (("first", alive & ~second), ("second", alive & second)):
            n = np.flatnonzero(here)
            if n.size == 0:
                continue
            held = _inside(region, f"{half}_won", x[n], v[n])
            if not held.all():
                lost = n[~held][0]
                ledger.refuse(RULE, "a walk leaves the region", f"{half} half, x = {x[lost]:.6g} m", int((~held).sum()))
                alive[n[~held]] = False
                n = n[held]
            p, q = _cell(region, x[n], v[n])
            w = _some_omega(region, half, p, q, rng)
            a, b = rng.choice([-1.0, 1.0], n.size), rng.choice([-1.0, 1.0], n.size)
            x[n], v[n] = _flow(region, half, x[n], v[n], w, a, b)
    ledger.refuse(RULE, "a walk does not come to its end", "")
    return WALKS


def _flow(
    region: RegionFile, half: str, x: Floats, v: Floats, w: Floats, a: Floats, b: Floats
) -> tuple[Floats, Floats]:
    """Integrate one sample about the half's foot, the disturbance at a vertex of its bound.

    With the rates d1 and d2 constant, z = x - x_foot + d2 / w^2 and u = v + d1 obey z' = u, u' = w^2 z, so z + u / w
    grows with e^(w t) and z - u / w falls with e^(-w t).
    """
    foot = region.first_foot if half == "first" else float(region.length)
    first, second = region.bound
    d1, d2 = np.zeros_like(x), np.zeros_like(x)
    if region.reading == "rate":
        d1, d2 = a * first, b * second
    elif region.reading == "inside_phi":
        d1, d2 = b * second, w * w * a * first
    z, u = x - foot + d2 / (w * w), v + d1
    up, down = 0.5 * (z + u / w) * np.exp(w * region.tau), 0.5 * (z - u / w) * np.exp(-w * region.tau)
    y, s = up + down + foot - d2 / (w * w), w * (up - down) - d1
    return (y + a * first, s + b * second) if region.reading == "jump" else (y, s)


def _some_omega(
    region: RegionFile, half: str, i: NDArray[np.int64], j: NDArray[np.int64], rng: np.random.Generator
) -> Floats:
    """Return for every cell one of its allowed omegas, at random (any omega where none is allowed)."""
    count = len(region.omegas[0])
    words = region.arrays[f"{half}_masks"][i, j]
    bits = ((words[:, :, None] >> np.arange(64, dtype=np.uint64)) & np.uint64(1)).reshape(i.size, 64 * words.shape[1])[
        :, :count
    ]
    omegas = np.array(region.omegas[0 if half == "first" else 1])
    return np.asarray(omegas[np.argmax(bits * rng.uniform(0.5, 1.0, bits.shape), axis=1)])


def _edges(region: RegionFile) -> tuple[Floats, Floats, Floats, Floats]:
    """Return left, right, lower and upper edges of the cells, each rounded once."""
    columns, rows = region.shape
    x = np.array([float(region.x0 + (i - HALF) * region.dx) for i in range(columns + 1)])
    v = np.array([float(region.v0 + (j - HALF) * region.dv) for j in range(rows + 1)])
    return x[:-1], x[1:], v[:-1], v[1:]


def _cell(region: RegionFile, x: Floats, v: Floats) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    i = np.floor((x - float(region.x0)) / float(region.dx) + 0.5).astype(np.int64)
    j = np.floor((v - float(region.v0)) / float(region.dv) + 0.5).astype(np.int64)
    return i, j


def _inside(region: RegionFile, key: str, x: Floats, v: Floats) -> NDArray[np.bool_]:
    """Tell which states lie in a set of cells."""
    i, j = _cell(region, x, v)
    columns, rows = region.shape
    found = (i >= 0) & (i < columns) & (j >= 0) & (j < rows)
    found[found] = region.arrays[key][i[found], j[found]]
    return found


def _refuse_cells(region: RegionFile, key: str, bad: NDArray[np.bool_], message: str, ledger: Ledger) -> None:
    """Refuse the marked cells of a set."""
    _refuse_all(bad & region.arrays[key], key, message, ledger)


def _refuse_all(wrong: NDArray[np.bool_], key: str, message: str, ledger: Ledger) -> None:
    times = int(np.count_nonzero(wrong))
    if times:
        i, j = (int(n[0]) for n in np.nonzero(wrong))
        ledger.refuse(RULE, f"a cell of {key} {message}", f"column {i}, row {j}", times)
