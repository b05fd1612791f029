"""The gait-fixed foothold program of Zhou et al. 2025, Eqs. (1)-(16), one function per block of equations.

The functions speak of a ``Motion``: which quantities there are, and which are unknowns. Over the ``whole`` motion
every quantity of Eq. (2) is an unknown; over the ``reduced`` one (see ``reduction``) velocities and
accelerations are differences of positions, and what the equations pin is a number. Both are the same program.

Corrections to the paper (see docs/footholds.md): the feet are integrated like the base; (14) and (15) bound absolute
values; (7) and (11) stand below the implication; a foot in its first stance is on the polygon that holds it.
Where a ``Choice`` leaves several polygons to a footstep the rows are those of their convex hull.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from surefoot.footholds.leg_reach import leg_cuts
from surefoot.footholds.problem import Problem
from surefoot.footholds.rows import Cost, CostBuilder, Index, Quantity, RowBuilder, Rows, Term
from surefoot.footholds.terrain import Hull, cone_hull, hull_of

Choice = tuple[tuple[int, ...], ...]
"""For every footstep the polygons that are left to it; then, for every foot and collision window, the free regions."""

INF = np.inf
FEET = range(4)
SAMPLE_SIZE = 66


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """The quantities of Eq. (2), and how accelerations follow from them.

    Attributes:
        size: how many unknowns there are.
        base: r, shape (N, 3).
        base_acceleration: terms whose sum is rdd, each (N, 3).
        feet: p, shape (N, 4, 3).
        feet_acceleration: terms whose sum is pdd, each (N, 4, 3).
        force: f, shape (N, 4, 3), or None where equal shares are understood.
        orientation: th, shape (N, 3), or None where it is solved apart.
        angular_acceleration: thdd, likewise.
    """

    size: int
    base: Quantity
    base_acceleration: tuple[Term, ...]
    feet: Quantity
    feet_acceleration: tuple[Term, ...]
    force: Quantity | None
    orientation: Quantity | None = None
    angular_acceleration: Quantity | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Rates:
    """The velocities and accelerations of the whole motion, which its integration rows need."""

    base_velocity: Quantity
    base_acceleration: Quantity
    angular_velocity: Quantity
    feet_velocity: Quantity
    feet_acceleration: Quantity


def whole_motion(samples: int) -> tuple[Motion, Rates]:
    """Return the motion in which all 66 numbers of every sample are unknowns, Eq. (2)."""
    begin = np.arange(samples)[:, None] * SAMPLE_SIZE
    axis = np.arange(3)

    def body(offset: int) -> Quantity:
        return Quantity.unknown(begin + offset + axis)

    def leg(offset: int) -> Quantity:
        return Quantity.unknown(begin[:, :, None] + 18 + offset + 12 * np.arange(4)[None, :, None] + axis)

    rates = Rates(body(3), body(6), body(12), leg(3), leg(6))
    motion = Motion(
        size=samples * SAMPLE_SIZE,
        base=body(0),
        base_acceleration=((1.0, rates.base_acceleration),),
        feet=leg(0),
        feet_acceleration=((1.0, rates.feet_acceleration),),
        force=leg(9),
        orientation=body(9),
        angular_acceleration=body(15),
    )
    return motion, rates


def whole_rows(problem: Problem, choice: Choice) -> Rows:
    """Return every row of Eqs. (1)-(16), with the rows of VII-A2 and of the options."""
    motion, _ = whole_motion(problem.samples)
    build = RowBuilder(motion.size)
    fixed_rows(build, problem)
    region_rows(build, problem, motion, choice)
    friction_rows(build, problem, motion, choice)
    collision_rows(build, problem, motion, choice)
    return build.rows()


def fixed_rows(build: RowBuilder, problem: Problem) -> None:
    """Write the rows over the whole motion that no choice changes."""
    motion, rates = whole_motion(problem.samples)
    boundary_rows(build, problem, motion, rates)
    integration_rows(build, problem, motion, rates)
    dynamics_rows(build, problem, motion)
    contact_rows(build, problem, motion, rates)
    torque_rows(build, problem, motion)
    base_torque_rows(build, problem, motion)
    reach_rows(build, problem, motion)
    leg_rows(build, problem, motion)
    clearance_rows(build, problem, motion)
    support_rows(build, problem, motion)
    moment_rows(build, problem, motion)
    tilt_rows(build, problem, motion)


def whole_cost(problem: Problem) -> Cost:
    """Return the cost of Eqs. (4)-(5) over all 66 numbers of every sample."""
    return cost_of(problem, whole_motion(problem.samples)[0])


def cost_of(problem: Problem, motion: Motion) -> Cost:
    """Sum weight times squared deviation over all samples, Eqs. (4)-(5) with Table I.

    Where the motion has no forces, the feet in contact share them equally, which is the least that they can cost.
    """
    build, weights = CostBuilder(motion.size), problem.weights
    base_cost(build, problem, motion.base, motion.base_acceleration)
    leg_cost(build, problem, motion)
    if motion.orientation is not None and motion.angular_acceleration is not None:
        build.add(weights.orientation, [(1.0, motion.orientation)], problem.rpy_reference_rad)
        build.add(weights.angular_acceleration, [(1.0, motion.angular_acceleration)], 0.0)
    if motion.force is None:
        counts = problem.contacts.sum(axis=1)[:, None]
        share = np.where(counts > 0, weights.force / np.maximum(counts, 1), 0.0)
        mass = problem.robot.mass_kg
        build.add(share, [(mass * factor, q) for factor, q in motion.base_acceleration], mass * gravity(problem))
    return build.cost()


def base_cost(build: CostBuilder, problem: Problem, base: Quantity, acceleration: Sequence[Term]) -> None:
    """Add the cost of the base's path."""
    build.add(problem.weights.position, [(1.0, base)], problem.base_reference_m)
    build.add(problem.weights.acceleration, acceleration, 0.0)


def leg_cost(build: CostBuilder, problem: Problem, motion: Motion, feet: Sequence[int] = FEET) -> None:
    """Add the cost of the paths of some feet, and of their forces where these are unknowns."""
    weights, chosen = problem.weights, list(feet)
    build.add(weights.foot, [(1.0, motion.feet[:, chosen])], problem.foot_reference_m[:, chosen])
    build.add(weights.foot_acceleration, [_of_feet(term, chosen) for term in motion.feet_acceleration], 0.0)
    if motion.force is not None:
        build.add(weights.force, [(1.0, motion.force[:, chosen])], 0.0)


def _of_feet(term: Term, chosen: list[int]) -> Term:
    factor, quantity = term
    return factor, quantity[:, chosen]


def gravity(problem: Problem) -> np.ndarray:
    """Return g, shape (3,)."""
    return np.array([0.0, 0.0, -problem.gravity_mps2])


def boundary_rows(build: RowBuilder, problem: Problem, motion: Motion, rates: Rates) -> None:
    """Pin both ends, Eqs. (1a)-(1b): poses, zero velocities, and the feet at the start."""
    for sample, position, rpy in (
        (0, problem.start_m, problem.start_rpy_rad),
        (-1, problem.goal_m, problem.goal_rpy_rad),
    ):
        build.add("boundary", position, position, [(1.0, motion.base[sample])])
        build.add("boundary", 0.0, 0.0, [(1.0, rates.base_velocity[sample])])
        if motion.orientation is not None:
            build.add("boundary", rpy, rpy, [(1.0, motion.orientation[sample])])
            build.add("boundary", 0.0, 0.0, [(1.0, rates.angular_velocity[sample])])
    build.add("boundary", problem.feet_m, problem.feet_m, [(1.0, motion.feet[0])])


def integration_rows(build: RowBuilder, problem: Problem, motion: Motion, rates: Rates) -> None:
    """Integrate base, orientation and feet by backward Euler, Eq. (3)."""
    chains = [
        (motion.base, rates.base_velocity, rates.base_acceleration),
        (motion.feet, rates.feet_velocity, rates.feet_acceleration),
    ]
    if motion.orientation is not None and motion.angular_acceleration is not None:
        chains.append((motion.orientation, rates.angular_velocity, motion.angular_acceleration))
    for position, velocity, acceleration in chains:
        for low, high in ((position, velocity), (velocity, acceleration)):
            build.add("integration", 0.0, 0.0, [(1.0, low[1:]), (-1.0, low[:-1]), (-problem.step_s, high[1:])])


def dynamics_rows(build: RowBuilder, problem: Problem, motion: Motion) -> None:
    """Newton's law m rdd = sum f + m g at all samples, Eq. (3)."""
    mass = problem.robot.mass_kg
    pull = mass * gravity(problem)
    terms: list[Term] = [(mass * np.asarray(factor), quantity) for factor, quantity in motion.base_acceleration]
    if motion.force is not None:
        terms += [(-1.0, motion.force[:, foot]) for foot in range(4)]
        build.add("dynamics", pull, pull, terms, where=(np.arange(problem.samples)[:, None], np.arange(3)))
    else:
        flight = np.flatnonzero(~problem.contacts.any(axis=1))
        build.add("flight", pull, pull, [_some(term, flight) for term in terms], where=(flight[:, None], np.arange(3)))


def _some(term: Term, samples: Index) -> Term:
    factor, quantity = term
    return (factor[samples] if np.ndim(factor) else factor), quantity[samples]


def region_rows(build: RowBuilder, problem: Problem, motion: Motion, choice: Choice) -> None:
    """Put every new foothold on its polygon, Eqs. (6)-(7), at the first sample of its stance."""
    for number, left in enumerate(choice[: len(problem.footsteps)]):
        foothold_rows(build, problem, motion, number, hull_of([problem.polygons[r] for r in left]))


def foothold_rows(build: RowBuilder, problem: Problem, motion: Motion, number: int, hull: Hull) -> None:
    """Put one foothold on the hull of the polygons that are left to it."""
    footstep = problem.footsteps[number]
    foot = motion.feet[footstep.touch, footstep.foot]
    build.add(
        "region", -INF, hull.bounds, [(hull.planes[:, a], foot[a][None]) for a in range(3)],
        where=(number, np.arange(len(hull.bounds))),
    )  # fmt: skip
    if hull.normal is not None:
        build.add(
            "region", hull.offset, hull.offset, [(hull.normal[a], foot[a][None]) for a in range(3)], where=(number, -1)
        )


def friction_rows(build: RowBuilder, problem: Problem, motion: Motion, choice: Choice) -> None:
    """Keep every force in the friction pyramid of the polygon its foot stands on, Eqs. (10)-(11)."""
    for foot in range(4):
        for support in _supports(problem, foot):
            left = (problem.start_polygons[foot],) if support < 0 else choice[support]
            cone = cone_hull([problem.polygons[r] for r in left])
            stance_rows(build, problem, motion, foot, support, cone)


def stance_rows(build: RowBuilder, problem: Problem, motion: Motion, foot: int, support: int, cone: np.ndarray) -> None:
    """Keep the forces of one stance in the cone of the polygons that are left to it."""
    assert motion.force is not None
    samples = np.flatnonzero(problem.support_index[:, foot] == support)
    force = motion.force[samples, foot]
    terms = [(cone[None, :, a], force[:, a][:, None]) for a in range(3)]
    build.add("friction", -INF, 0.0, terms, where=(samples[:, None], foot, np.arange(len(cone))))


def _supports(problem: Problem, foot: int) -> list[int]:
    """Return the footsteps of a foot, and -1 for the start foothold."""
    index = problem.support_index[:, foot]
    return [int(support) for support in np.unique(index[index > -2])]


def contact_rows(build: RowBuilder, problem: Problem, motion: Motion, rates: Rates) -> None:
    """Hold feet still in stance, Eq. (12), and forces at zero in swing, Eq. (13)."""
    assert motion.force is not None
    held, free = problem.contacts, ~problem.contacts
    build.add("contact", 0.0, 0.0, [(1.0, rates.feet_velocity[held])])
    build.add("contact", 0.0, 0.0, [(1.0, motion.force[free])])


def torque_rows(build: RowBuilder, problem: Problem, motion: Motion, feet: Sequence[int] = FEET) -> None:
    """Bound the joint torques |J' f| at the reference joints, Eq. (14)."""
    assert motion.force is not None
    limit = np.array(problem.robot.torque_max_nm)
    for foot in feet:
        jacobian = np.array(problem.robot.jacobians[foot])
        samples = np.flatnonzero(problem.contacts[:, foot])
        force = motion.force[samples, foot]
        terms = [(jacobian[a][None, :], force[:, a][:, None]) for a in range(3)]
        build.add("torque", -limit, limit, terms, where=(samples[:, None], foot, np.arange(3)))


def base_torque_rows(build: RowBuilder, problem: Problem, motion: Motion) -> None:
    """Bound the torque on the base |I thdd|, Eq. (15)."""
    assert motion.angular_acceleration is not None
    limit = problem.robot.base_torque_max_nm
    terms = [(np.array(problem.robot.inertia_kgm2), motion.angular_acceleration)]
    build.add("base torque", -limit, limit, terms, where=(np.arange(problem.samples)[:, None], np.arange(3)))


def reach_rows(build: RowBuilder, problem: Problem, motion: Motion, feet: Sequence[int] = FEET) -> None:
    """Keep every foot, in swing too, in the box about its nominal position that moves with the base, Eq. (16)."""
    chosen = list(feet)
    sample, foot = np.arange(problem.samples)[:, None, None], np.array(chosen)[None, :, None]
    nominal = np.array(problem.robot.feet_m)[None, chosen]
    reach = np.array(problem.robot.foot_reach_m)
    turn = problem.rotations[:, None]
    points = [(turn[..., b, :], motion.feet[:, chosen, b][..., None]) for b in range(3)]
    base = [(-turn[..., b, :], motion.base[:, None, b][..., None]) for b in range(3)]
    build.add("reach", nominal - reach, nominal + reach, [*points, *base], where=(sample, foot, np.arange(3)))


def leg_rows(build: RowBuilder, problem: Problem, motion: Motion, feet: Sequence[int] = FEET) -> None:
    """Keep every foot, in swing too, where its leg reaches with its joints' limits, if that is asked for."""
    if not problem.options.joint_reach:
        return
    chosen = list(feet)
    normals, bounds = (part[chosen] for part in leg_cuts(problem.robot))
    turned = np.einsum("iba,jka->bijk", problem.rotations, normals)
    points = [(turned[b], motion.feet[:, chosen, b][..., None]) for b in range(3)]
    base = [(-turned[b], motion.base[:, None, b][..., None]) for b in range(3)]
    sample, foot = np.arange(problem.samples)[:, None, None], np.array(chosen)[None, :, None]
    build.add("leg", -INF, bounds[None], [*points, *base], where=(sample, foot, np.arange(normals.shape[1])))


def clearance_rows(build: RowBuilder, problem: Problem, motion: Motion, feet: Sequence[int] = FEET) -> None:
    """Lift the swing foot above lift-off and touch-down in the middle of the swing (VII-A2)."""
    height = problem.options.clearance_m
    if height <= 0:
        return
    for number, footstep in enumerate(problem.footsteps):
        samples = np.array(footstep.cleared, dtype=np.int64)
        if len(samples) and footstep.foot in feet:
            vertical = motion.feet[:, footstep.foot, 2]
            for side, ground in enumerate((footstep.lift - 1, footstep.touch)):
                terms = [(1.0, vertical[samples]), (-1.0, vertical[[ground]])]
                build.add("clearance", height, INF, terms, where=(samples, number, side))


def collision_rows(build: RowBuilder, problem: Problem, motion: Motion, choice: Choice) -> None:
    """Keep every foot in one free region at all samples of a window, Eqs. (29)-(31), where one region is left."""
    if problem.options.collision:
        for number, regions in enumerate(choice[len(problem.footsteps) :]):
            if len(regions) == 1:
                window_rows(build, problem, motion, number, regions[0])


def window_rows(build: RowBuilder, problem: Problem, motion: Motion, number: int, region: int) -> None:
    """Keep one foot in one free region at all samples of one window."""
    windows = problem.windows()
    foot, window = divmod(number, len(windows))
    matrix, bound = problem.free_regions[region]
    samples = np.array(windows[window])
    point = motion.feet[samples, foot]
    terms = [(matrix[None, :, a], point[:, a][:, None]) for a in range(3)]
    build.add("collision", -INF, bound, terms, where=(samples[:, None], number, np.arange(len(bound)), region))


def support_rows(build: RowBuilder, problem: Problem, motion: Motion) -> None:
    """Keep the base near the mean of the feet in contact whenever there are three or more (``com_support_m``)."""
    if problem.options.com_support_m is None:
        return
    counts = problem.contacts.sum(axis=1)
    samples = np.flatnonzero(counts >= 3)
    share = (problem.contacts[samples] / counts[samples, None])[..., None]
    feet = [(-share[:, foot], motion.feet[samples, foot, :2]) for foot in range(4)]
    limit = problem.options.com_support_m
    terms = [(1.0, motion.base[samples, :2]), *feet]
    build.add("support", -limit, limit, terms, where=(samples[:, None], np.arange(2)))


def moment_rows(build: RowBuilder, problem: Problem, motion: Motion) -> None:
    """Let forces turn the base: I thdd = sum lever x f with the levers of the reference (``moment_balance``)."""
    if not problem.options.moment_balance or motion.angular_acceleration is None or motion.force is None:
        return
    turn = problem.rotations
    inertia = turn @ np.diag(problem.robot.inertia_kgm2) @ turn.transpose(0, 2, 1)
    lever, thdd = problem.levers_m, motion.angular_acceleration
    terms: list[Term] = [(inertia[:, :, a], thdd[:, a][:, None]) for a in range(3)]
    for foot in range(4):
        cross = _cross_matrices(lever[:, foot])
        terms += [(-cross[:, :, a], motion.force[:, foot, a][:, None]) for a in range(3)]
    build.add("moment", 0.0, 0.0, terms, where=(np.arange(problem.samples)[:, None], np.arange(3)))


def tilt_rows(build: RowBuilder, problem: Problem, motion: Motion) -> None:
    """Keep the orientation near its reference, about which the moments are linearised (``moment_balance``)."""
    if problem.options.moment_balance and motion.orientation is not None:
        limit, reference = problem.options.tilt_max_rad, problem.rpy_reference_rad
        where = (np.arange(problem.samples)[:, None], np.arange(3))
        build.add("tilt", reference - limit, reference + limit, [(1.0, motion.orientation)], where=where)


def _cross_matrices(lever: np.ndarray) -> np.ndarray:
    """Return matrices whose product with f is lever x f, shape (n, 3, 3)."""
    x, y, z = lever.T
    zero = np.zeros_like(x)
    return np.moveaxis(np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]]), 2, 0)


def all_open(problem: Problem) -> Choice:
    """Return the choice that leaves everything open."""
    polygons, regions = tuple(range(len(problem.polygons))), tuple(range(len(problem.free_regions)))
    windows = 4 * problem.options.collision_windows if problem.options.collision else 0
    return (polygons,) * len(problem.footsteps) + (regions,) * windows


def decided(choice: Choice) -> bool:
    """Return whether nothing is left open."""
    return all(len(left) == 1 for left in choice)
