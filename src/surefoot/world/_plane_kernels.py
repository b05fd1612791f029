"""Compiled sweeps of the plane segmentation: window fits, region growing, claiming of edge cells.

Grid positions are (column c, row r), whole numbers at the centres of cells; a plane is ``z = a + b c + d r``.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
Flags = NDArray[np.bool_]


@njit(cache=True)
def solve_plane(m: Floats) -> tuple[float, float, float]:
    """Return (a, b, d) of the least-squares plane from moments (n, c, r, cc, cr, rr, z, cz, rz); a is at (0, 0)."""
    n = m[0]
    mc, mr, mz = m[1] / n, m[2] / n, m[6] / n
    cc, cr, rr = m[3] - n * mc * mc, m[4] - n * mc * mr, m[5] - n * mr * mr
    cz, rz = m[7] - n * mc * mz, m[8] - n * mr * mz
    det = cc * rr - cr * cr
    if det <= 1e-9 * (cc + rr) * (cc + rr) + 1e-12:
        return mz, 0.0, 0.0
    b = (cz * rr - rz * cr) / det
    d = (rz * cc - cz * cr) / det
    return mz - b * mc - d * mr, b, d


@njit(cache=True)
def fit_windows(z: Floats, half: int) -> tuple[Floats, Floats, Floats, Floats]:
    """Fit a plane to the window around every cell.

    Returns:
        Fitted height at the cell, slopes along columns and rows per cell, and the root mean square residual; NaN where
        the window holds less than a quarter of its cells.
    """
    rows, columns = z.shape
    height = np.full((rows, columns), np.nan)
    b_, d_, rms = height.copy(), height.copy(), height.copy()
    least = max((half + 1) * (half + 1), 4)
    m = np.zeros(9)
    for r in range(rows):
        for c in range(columns):
            if np.isnan(z[r, c]):
                continue
            m[:] = 0.0
            zz = 0.0
            base = z[r, c]
            for i in range(max(r - half, 0), min(r + half + 1, rows)):
                for j in range(max(c - half, 0), min(c + half + 1, columns)):
                    v = z[i, j] - base
                    if np.isnan(v):
                        continue
                    x, y = j - c, i - r
                    m[0] += 1.0
                    m[1] += x
                    m[2] += y
                    m[3] += x * x
                    m[4] += x * y
                    m[5] += y * y
                    m[6] += v
                    m[7] += x * v
                    m[8] += y * v
                    zz += v * v
            if m[0] < least:
                continue
            a, b, d = solve_plane(m)
            sse = max(zz - a * m[6] - b * m[7] - d * m[8], 0.0)
            height[r, c], b_[r, c], d_[r, c] = base + a, b, d
            rms[r, c] = np.sqrt(sse / (m[0] - 3.0))
    return height, b_, d_, rms


@njit(cache=True)
def _add(m: Floats, x: float, y: float, z: float) -> None:
    m[0] += 1.0
    m[1] += x
    m[2] += y
    m[3] += x * x
    m[4] += x * y
    m[5] += y * y
    m[6] += z
    m[7] += x * z
    m[8] += y * z


@njit(cache=True)
def _flood(
    start: int,
    plane: Floats,
    refit: bool,
    smooth: Floats,
    b_: Floats,
    d_: Floats,
    free: Flags,
    mark: Ints,
    stamp: int,
    queue: Ints,
    tolerance: float,
    bend: float,
) -> int:
    """Collect the connected cells that lie on a plane; with ``refit`` the plane follows the cells; return how many."""
    rows, columns = smooth.shape
    r0, c0 = start // columns, start % columns
    m = np.zeros(9)
    queue[0] = start
    mark[r0, c0] = stamp
    head, tail, next_fit = 0, 1, 12
    while head < tail:
        r, c = queue[head] // columns, queue[head] % columns
        head += 1
        if refit:
            _add(m, c - c0, r - r0, smooth[r, c])
            if m[0] >= next_fit:
                a, b, d = solve_plane(m)
                plane[0], plane[1], plane[2] = a - b * c0 - d * r0, b, d
                next_fit = int(m[0] * 1.3) + 4
        for k in range(4):
            i = r + (k == 1) - (k == 0)
            j = c + (k == 3) - (k == 2)
            if i < 0 or j < 0 or i >= rows or j >= columns or not free[i, j] or mark[i, j] == stamp:
                continue
            if abs(smooth[i, j] - plane[0] - plane[1] * j - plane[2] * i) > tolerance:
                continue
            if abs(b_[i, j] - plane[1]) > bend or abs(d_[i, j] - plane[2]) > bend:
                continue
            mark[i, j] = stamp
            queue[tail] = i * columns + j
            tail += 1
    return tail


@njit(cache=True)
def _refit(queue: Ints, count: int, smooth: Floats, plane: Floats) -> None:
    columns = smooth.shape[1]
    r0, c0 = queue[0] // columns, queue[0] % columns
    m = np.zeros(9)
    for k in range(count):
        r, c = queue[k] // columns, queue[k] % columns
        _add(m, c - c0, r - r0, smooth[r, c])
    a, b, d = solve_plane(m)
    plane[0], plane[1], plane[2] = a - b * c0 - d * r0, b, d


@njit(cache=True)
def grow_regions(
    smooth: Floats,
    b_: Floats,
    d_: Floats,
    core: Flags,
    seeds: Ints,
    tolerance: float,
    bend: float,
    least: int,
    first: int,
) -> tuple[Ints, int]:
    """Grow planar regions of core cells from seeds.

    Args:
        smooth: fitted heights.
        b_: slopes along columns.
        d_: slopes along rows.
        core: cells that may belong to a region.
        seeds: flat indices of the core cells, best first.
        tolerance: largest distance of a fitted height from the region's plane.
        bend: largest difference of slopes.
        least: fewest cells of a region.
        first: label of the first region.

    Returns:
        Labels (0 for none) and the next free label.
    """
    rows, columns = smooth.shape
    labels = np.zeros((rows, columns), np.int32)
    mark = np.zeros((rows, columns), np.int32)
    free = core.copy()
    queue = np.empty(rows * columns, np.int32)
    plane = np.zeros(3)
    label, stamp = first, 0
    for s in range(len(seeds)):
        r, c = seeds[s] // columns, seeds[s] % columns
        if not free[r, c]:
            continue
        plane[1], plane[2] = b_[r, c], d_[r, c]
        plane[0] = smooth[r, c] - plane[1] * c - plane[2] * r
        stamp += 1
        count = _flood(seeds[s], plane, True, smooth, b_, d_, free, mark, stamp, queue, tolerance, bend)
        if count >= least:
            for _ in range(2):
                _refit(queue, count, smooth, plane)
                start = -1
                for k in range(count):
                    i, j = queue[k] // columns, queue[k] % columns
                    if abs(smooth[i, j] - plane[0] - plane[1] * j - plane[2] * i) <= tolerance:
                        start = queue[k]
                        break
                if start < 0:
                    count = 0
                    break
                stamp += 1
                count = _flood(start, plane, False, smooth, b_, d_, free, mark, stamp, queue, tolerance, bend)
        if count < least:
            free[r, c] = False
            continue
        for k in range(count):
            i, j = queue[k] // columns, queue[k] % columns
            labels[i, j] = label
            free[i, j] = False
        label += 1
        if free[r, c]:  # the plane has moved away from its own seed
            free[r, c] = False
    return labels, label


@njit(cache=True)
def claim_edges(
    z: Floats, labels: Ints, planes: Floats, open_: Flags, tolerance: float, rounds: int, neighbours: int
) -> Ints:
    """Give open cells beside regions to the region whose plane they lie on best.

    Args:
        z: measured heights.
        labels: 0 for none.
        planes: (labels, 3) planes.
        open_: cells that may be given.
        tolerance: largest distance from the plane.
        rounds: how many cells deep.
        neighbours: with 1, a side neighbour in the region is enough; else so many of the 8 have to be in it; one more
            for a cell without a height, three more when something high stands beside it.
    """
    rows, columns = z.shape
    old = labels.copy()
    new = labels.copy()
    for _ in range(rounds):
        changed = False
        for r in range(rows):
            for c in range(columns):
                if old[r, c] > 0 or not open_[r, c]:
                    continue
                best, choice = tolerance, 0
                for i in range(max(r - 1, 0), min(r + 2, rows)):
                    for j in range(max(c - 1, 0), min(c + 2, columns)):
                        label = old[i, j]
                        if label == 0 or label == choice or (neighbours == 1 and i != r and j != c):
                            continue
                        miss = 0.0  # of a dropout only the neighbours can tell
                        if not np.isnan(z[r, c]):
                            miss = abs(z[r, c] - planes[label, 0] - planes[label, 1] * c - planes[label, 2] * r)
                        elif neighbours == 1:
                            continue
                        needed = neighbours
                        if np.isnan(z[r, c]):
                            plane = planes[label, 0] + planes[label, 1] * c + planes[label, 2] * r
                            needed += 3 if _overlooked(z, r, c, plane + 3.0 * tolerance) else 1
                        if miss > best or (neighbours > 1 and _alike(old, r, c, label) < needed):
                            continue
                        best, choice = miss, label
                if choice > 0:
                    new[r, c] = choice
                    changed = True
        old[:] = new
        if not changed:
            break
    return new


@njit(cache=True)
def _overlooked(z: Floats, r: int, c: int, level: float) -> bool:
    """Return whether a neighbour is higher than a level."""
    for i in range(max(r - 1, 0), min(r + 2, z.shape[0])):
        for j in range(max(c - 1, 0), min(c + 2, z.shape[1])):
            if z[i, j] > level:
                return True
    return False


@njit(cache=True)
def _alike(labels: Ints, r: int, c: int, label: int) -> int:
    count = 0
    for i in range(max(r - 1, 0), min(r + 2, labels.shape[0])):
        for j in range(max(c - 1, 0), min(c + 2, labels.shape[1])):
            if labels[i, j] == label:
                count += 1
    return count


@njit(cache=True)
def settle_rivals(z: Floats, labels: Ints, planes: Floats, step: float) -> Ints:
    """Give cells at the step between two regions to the one whose plane is nearer; return new labels.

    Args:
        z: measured heights.
        labels: 0 for none.
        planes: (labels, 3) planes.
        step: planes that differ by less at the cell are no step.
    """
    rows, columns = z.shape
    new = labels.copy()
    for r in range(rows):
        for c in range(columns):
            own = labels[r, c]
            if own == 0 or np.isnan(z[r, c]):
                continue
            here = planes[own, 0] + planes[own, 1] * c + planes[own, 2] * r
            best = abs(z[r, c] - here)
            for k in range(4):
                i, j = r + (k == 1) - (k == 0), c + (k == 3) - (k == 2)
                if i < 0 or j < 0 or i >= rows or j >= columns:
                    continue
                other = labels[i, j]
                if other == own or other == 0:
                    continue
                there = planes[other, 0] + planes[other, 1] * c + planes[other, 2] * r
                if abs(there - here) > step and abs(z[r, c] - there) < best:
                    best = abs(z[r, c] - there)
                    new[r, c] = other
    return new


@njit(cache=True)
def region_planes(z: Floats, labels: Ints, count: int) -> Floats:
    """Return the least-squares plane of every label from measured heights, shape (count, 3)."""
    rows, columns = z.shape
    origin = np.full((count, 2), -1)
    moments = np.zeros((count, 9))
    for r in range(rows):
        for c in range(columns):
            label = labels[r, c]
            if label > 0 and not np.isnan(z[r, c]):
                if origin[label, 0] < 0:
                    origin[label, 0], origin[label, 1] = c, r
                _add(moments[label], c - origin[label, 0], r - origin[label, 1], z[r, c])
    planes = np.zeros((count, 3))
    for label in range(count):
        if moments[label, 0] >= 3:
            a, b, d = solve_plane(moments[label])
            planes[label, 0] = a - b * origin[label, 0] - d * origin[label, 1]
            planes[label, 1], planes[label, 2] = b, d
    return planes


@njit(cache=True)
def largest_misses(
    z: Floats, labels: Ints, means: Floats, label: int, plane: Floats, top: int, left: int, rows: int, columns: int
) -> tuple[float, float]:
    """Return the largest distance of a region from its plane within a rectangle: of local means, and of single cells.

    Args:
        z: measured heights.
        labels: of the regions.
        means: of the distances, over the cells around.
        label: of the region.
        plane: of the region.
        top: first row of the rectangle.
        left: its first column.
        rows: how many rows it has.
        columns: how many columns it has.
    """
    mean, single = 0.0, 0.0
    for r in range(top, top + rows):
        for c in range(left, left + columns):
            if labels[r, c] != label:
                continue
            if not np.isnan(means[r, c]):
                mean = max(mean, abs(means[r, c]))
            if not np.isnan(z[r, c]):
                single = max(single, abs(z[r, c] - plane[0] - plane[1] * c - plane[2] * r))
    return mean, single


@njit(cache=True)
def own_means(misses: Floats, labels: Ints, half: int) -> Floats:
    """Return for every cell of a region the mean of a value over the cells of the same region around it; else NaN."""
    rows, columns = misses.shape
    out = np.full((rows, columns), np.nan)
    for r in range(rows):
        for c in range(columns):
            label = labels[r, c]
            if label == 0:
                continue
            total, n = 0.0, 0
            for i in range(max(r - half, 0), min(r + half + 1, rows)):
                for j in range(max(c - half, 0), min(c + half + 1, columns)):
                    if labels[i, j] == label and not np.isnan(misses[i, j]):
                        total += misses[i, j]
                        n += 1
            if n > 0:
                out[r, c] = total / n
    return out
