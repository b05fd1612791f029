"""A lower bound for all gaits at once: base and feet are priced apart, and each foot takes its cheapest pattern.

Two things couple the feet: the reach rows tie each of them to the base, and the feet in contact share the force. Prices
(multipliers) on the rows of Eq. (16), on the force of every sample and on contact in every cell (``sharing``) take the
coupling apart: the base is one linear system, and every foot a shortest path (``paths``). For any prices the sum is a
lower bound of the cost of every gait; torque, collision and all of friction but a pyramid about the total force are
left out, which only lowers it. Where the base is known to stay within a tube (``tube``), feet stand only where it keeps
them within reach; where it is asked to stay within a region, the best multipliers on its bounds are prices too.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numba
import numpy as np

from surefoot.footholds.cells import Cells, cell_count, cell_samples
from surefoot.footholds.paths import STANCE, SWING, WIDE_M, Flags, cheapest_path
from surefoot.footholds.places import Places, places_of
from surefoot.footholds.problem import Problem
from surefoot.footholds.rows import Array, Index
from surefoot.footholds.sharing import Prices, left_over, savings, upwards
from surefoot.footholds.swings import SwingCosts, swing_costs
from surefoot.footholds.tube import Tube, everywhere, reachable, tube_of_ends

_LEVELS = 2
_SWEEPS, _SWEPT_M = 300, 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Priced:
    """What prices prove.

    Attributes:
        bound: lower bound of the cost of base, feet and forces.
        cells: the cheapest pattern of every foot, shape (M, 4).
        base_m: shape (N, 3).
        walls: see ``PricedBase``.
    """

    bound: float
    cells: Cells
    base_m: Array
    walls: Array


@dataclass(frozen=True, slots=True, eq=False)
class PricedBase:
    """The base's part of what prices prove.

    Attributes:
        value: its least cost.
        path_m: where it is then, shape (N, 3).
        force_n: what moves it so, shape (N, 3).
        walls: multipliers on the bounds of its region that are best with these prices, shape (N, 3).
    """

    value: float
    path_m: Array
    force_n: Array
    walls: Array


@numba.njit(cache=True)
def kept_between(spread: Array, places: Array, low: Array, high: Array) -> Array:
    """Return multipliers that keep places - spread @ multipliers between bounds: positive at the upper ones.

    Any of the right signs are sound; these come from sweeps over the places.
    """
    found = np.zeros(len(places))
    for _ in range(_SWEEPS):
        most = 0.0
        for k in range(len(places)):
            at = places[k] - spread[k] @ found + spread[k, k] * found[k]
            new = (at - min(max(at, low[k]), high[k])) / spread[k, k]
            most = max(most, abs(new - found[k]) * spread[k, k])
            found[k] = new
        if most < _SWEPT_M:
            break
    return found


@dataclass(frozen=True, slots=True, eq=False)
class FootCosts:
    """What stances and swings cost at some prices (see ``cheapest_path``).

    Attributes:
        pricing: whose problem and places are meant.
        swings: of all feet.
        square: of all feet.
        slopes: by foot.
        constants: by foot.
    """

    pricing: Pricing
    swings: SwingCosts
    square: Array
    slopes: list[Array]
    constants: list[Array]

    def cheapest(self, foot: int, allowed: Index) -> tuple[float, list[tuple[int, int, int]]]:
        """Return a foot's cheapest path in the cells that are allowed."""
        low, high, middle = self.pricing.boxes[foot]
        value, path = cheapest_path(
            low, high, middle, self.pricing.level[foot], self.square, self.slopes[foot], self.constants[foot],
            self.swings.ends, self.swings.slopes[foot], self.swings.constants[foot], self.swings.high_slopes[foot],
            self.swings.high_constants[foot], allowed, self.pricing.within[foot],
            self.pricing.problem.options.min_dwell_cells,
        )  # fmt: skip
        return value, [(int(a), int(b), int(box)) for a, b, box in path if a >= 0][::-1]


def levels_of(heights_m: Array) -> Array:
    """Return a few heights that stand for all."""
    levels = sorted({round(float(height), 2) for height in heights_m})
    while len(levels) > _LEVELS:
        near = int(np.argmin(np.diff(levels)))
        levels[near : near + 2] = [(levels[near] + levels[near + 1]) / 2]
    return np.array(levels)


class Pricing:
    """Evaluates prices for one problem.

    Args:
        problem: its gait is free.
        budget: how many boxes of footholds each foot gets.
        points: whether only their middles count: no bound, but a concave function.
        tube: where the base stays; none: what its ends tell.
    """

    def __init__(self, problem: Problem, budget: int, *, points: bool = False, tube: Tube | None = None) -> None:
        self.problem, self.points = problem, points
        self.count, self.per = cell_count(problem), cell_samples(problem)
        self.places: list[Places] = [places_of(problem, foot, budget) for foot in range(4)]
        allowed = np.zeros((self.count, 4), dtype=np.int64)
        allowed[[0, -1]] = STANCE
        self.allowed: Index = allowed
        self.boxes = [self._boxes(here, foot) for foot, here in enumerate(self.places)]
        heights = [middle[:, 2] for _, _, middle in self.boxes]
        self.levels_m = levels_of(np.concatenate(heights))
        self.level = [np.abs(own[:, None] - self.levels_m).argmin(axis=1) for own in heights]
        self._swings: SwingCosts | None = None
        self._halved: dict[float, tuple[Array, Array]] = {}
        self.confine(tube or tube_of_ends(problem), everywhere(problem))

    def confine(self, tube: Tube, region: Tube) -> None:
        """Let feet stand only where a base in this tube can keep them within reach, and ask it to stay in a region."""
        self.region = region
        self.within: list[Flags] = []
        for foot, here in enumerate(self.places):
            point = self.problem.feet_m[foot][None]
            low, high = np.concatenate([here.low, point]), np.concatenate([here.high, point])
            self.within.append(reachable(self.problem, tube, foot, low, high))

    def _boxes(self, here: Places, foot: int) -> tuple[Array, Array, Array]:
        """Return the corners of the boxes of a foot and a likely point in each; the start foothold is the last."""
        point = self.problem.feet_m[foot][None]
        low, high = np.concatenate([here.low, point]), np.concatenate([here.high, point])
        path = self.problem.foot_reference_m[:, foot]
        likely = np.clip(np.median(path, axis=0), low, high)
        middle = np.where(high - low < WIDE_M, (low + high) / 2, likely)
        return (middle, middle, middle) if self.points else (low, high, middle)

    @cached_property
    def second(self) -> Array:
        """Second differences of a path at rest at sample 0, over dt^2, rows 1 .. N-1; row 0 is empty."""
        size = self.problem.samples
        matrix = np.zeros((size, size))
        for row in range(1, size):
            matrix[row, row] += 1.0
            matrix[row, row - 1] -= 2.0
            matrix[row, max(row - 2, 0)] += 1.0
        divided: Array = matrix / self.problem.step_s**2
        return divided

    def base_hessian(self, split: float) -> tuple[Array, Array]:
        """Return the base's Hessian without the share of acceleration that is paid with the force, and its inverse.

        The inverse is that of the samples between the ends, which are known.
        """
        if split not in self._halved:
            weights, size = self.problem.weights, self.problem.samples
            moved = 2 * weights.acceleration * (1 - split) * self.second.T @ self.second
            hessian = moved + 2 * weights.position * np.eye(size)
            inverse = np.asarray(np.linalg.inv(hessian[1:-2, 1:-2]), dtype=np.float64)
            self._halved[split] = hessian, inverse
        return self._halved[split]

    def at(self, prices: Prices, allowed: Index | None = None) -> Priced:
        """Return what prices prove."""
        problem, robot = self.problem, self.problem.robot
        world = np.einsum("iab,ijb->ija", problem.rotations, prices.reach)
        base = self.base(world.sum(axis=1), prices)
        left = left_over(savings(problem, prices), prices.contact)
        cells, feet_value = self.feet(world, prices.contact, self.allowed if allowed is None else allowed)
        ties = float((prices.reach * np.array(robot.feet_m)).sum())
        ties += float((np.abs(prices.reach) * np.array(robot.foot_reach_m)).sum())
        return Priced(base.value + left + feet_value - ties, cells, base.path_m, base.walls)

    def base(self, world: Array, prices: Prices) -> PricedBase:
        """Return the base's part."""
        problem, weights, pull = self.problem, self.problem.weights, prices.pull
        mass, (hessian, inverse) = problem.robot.mass_kg, self.base_hessian(prices.split)
        alone = weights.acceleration * (1 - prices.split)
        reference, up = problem.base_reference_m, upwards(problem)
        linear = 2 * mass * self.second.T @ pull - world - 2 * weights.position * reference
        path = np.zeros_like(reference)
        path[0], path[-2:] = problem.start_m, problem.goal_m
        known = hessian @ path
        path[1:-2] = -inverse @ (linear + known)[1:-2]
        walls, beyond = self._walls(path, inverse)
        path[1:-2] -= inverse @ walls[1:-2]
        first = -mass * pull[0] / alone
        value = float((path * (hessian @ path)).sum() / 2 + ((linear + walls) * path).sum())
        value += weights.position * float((reference**2).sum()) - alone * float((first**2).sum())
        value += 2 * mass * float((pull @ up).sum())
        value += weights.acceleration * prices.split * len(path) * float(up @ up) - beyond
        acceleration = self.second @ path
        acceleration[0] = first
        return PricedBase(value, path, mass * (acceleration + up), walls)

    def _walls(self, path_m: Array, inverse: Array) -> tuple[Array, float]:
        """Return the best multipliers on the region's bounds, and the sum of multipliers times bounds.

        Args:
            path_m: of the base without them, shape (N, 3).
            inverse: of the base's Hessian between the ends.
        """
        walls, beyond, inner = np.zeros_like(path_m), 0.0, slice(1, -2)
        for axis in range(3):
            low, high = self.region.low_m[inner, axis], self.region.high_m[inner, axis]
            cut = np.flatnonzero(np.isfinite(low) | np.isfinite(high))
            if len(cut):
                found = kept_between(inverse[np.ix_(cut, cut)], path_m[inner, axis][cut], low[cut], high[cut])
                walls[inner, axis][cut] = found
                bounds = np.where(found > 0, high[cut], low[cut])
                beyond += float(found[found != 0] @ bounds[found != 0])
        return walls, beyond

    def feet(self, world: Array, contact: Array, allowed: Index) -> tuple[Cells, float]:
        """Return every foot's cheapest pattern, and the cost of all."""
        table = self.table(world, contact)
        cells, value = np.zeros((self.count, 4), dtype=bool), 0.0
        for foot in range(4):
            cost, stances = table.cheapest(foot, allowed[:, foot])
            value += cost
            for since, end, _ in stances:
                cells[since:end, foot] = True
        return cells, value

    def table(self, world: Array, contact: Array) -> FootCosts:
        """Return what stances and swings cost at given prices."""
        problem, per = self.problem, self.per
        track = problem.weights.foot
        square = 2 * track * per * np.arange(self.count + 1, dtype=float)
        reference = problem.foot_reference_m
        paid = np.repeat(contact / per, per)
        slopes = [self.summed(world[:, foot] - 2 * track * reference[:, foot]) for foot in range(4)]
        constants = [
            self.summed((track * (reference[:, foot] ** 2).sum(axis=1) - paid)[:, None])[:, 0] for foot in range(4)
        ]
        self._swings = swing_costs(problem, world, self.levels_m, self._swings)
        return FootCosts(self, self._swings, square, slopes, constants)

    def guesses(self, prices: Prices) -> Callable[[Cells], float]:
        """Return a function that says what prices prove about one contact table; cheap, for ranking."""
        world = np.einsum("iab,ijb->ija", self.problem.rotations, prices.reach)
        robot = self.problem.robot
        ties = float((prices.reach * np.array(robot.feet_m)).sum())
        ties += float((np.abs(prices.reach) * np.array(robot.foot_reach_m)).sum())
        rest = self.base(world.sum(axis=1), prices).value - ties
        unpaid = prices.contact[:, None] * np.arange(5) - savings(self.problem, prices)
        table = self.table(world, prices.contact)
        known: dict[tuple[int, bytes], float] = {}

        def value(cells: Cells) -> float:
            total = rest + float(unpaid[np.arange(self.count), cells.sum(axis=1)].sum())
            for foot in range(4):
                key = (foot, cells[:, foot].tobytes())
                if key not in known:
                    known[key] = table.cheapest(foot, np.where(cells[:, foot], STANCE, SWING))[0]
                total += known[key]
            return total

        return value

    def summed(self, values: Array) -> Array:
        """Return sums over all samples before each cell."""
        sums = np.concatenate([np.zeros((1, values.shape[1])), np.cumsum(values, axis=0)])
        return sums[:: self.per]
