"""Prices to start from: those of a program with a gait, even ones, and others of the same base."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from surefoot.footholds.cells import cell_count, cell_samples
from surefoot.footholds.dual import Pricing
from surefoot.footholds.model import gravity
from surefoot.footholds.nodes import Node
from surefoot.footholds.problem import Problem
from surefoot.footholds.rows import FAMILIES, Array
from surefoot.footholds.sharing import Prices, contact_prices, savings, upwards

_FEET_EXPECTED = 2.7


def prices_of_node(problem: Problem, node: Node) -> Prices:
    """Return the prices at which the solution of a program is the best one of its gait: its multipliers.

    Where forces are shared equally, the pull is w F / n; in flight, and where forces are unknowns, it is half the
    multiplier of Newton's law. A foot in contact is paid what it saves.
    """
    multipliers, where = node.answer.multipliers, node.rows.where
    reach = np.zeros((problem.samples, 4, 3))
    chosen = node.rows.family == FAMILIES.index("reach")
    reach[where[chosen, 0], where[chosen, 1], where[chosen, 2]] = multipliers[chosen]
    assert node.motion is not None
    terms = node.motion.base_acceleration
    acceleration = sum(np.asarray(factor) * quantity.at(node.answer.unknowns) for factor, quantity in terms)
    counts = np.maximum(problem.contacts.sum(axis=1), 1)[:, None]
    pull = problem.weights.force * problem.robot.mass_kg * (np.asarray(acceleration) - gravity(problem)) / counts
    law = (node.rows.family == FAMILIES.index("flight")) | (node.rows.family == FAMILIES.index("dynamics"))
    pull[where[law, 0], where[law, 1]] = multipliers[law] / 2
    return with_contacts(problem, Prices(reach, pull, np.zeros(cell_count(problem))), problem.contacts.sum(axis=1))


def with_contacts(problem: Problem, prices: Prices, held: Array) -> Prices:
    """Return prices with those of contact at which so many feet, by sample, are best."""
    by_cell = np.asarray(held, dtype=np.float64)[:: cell_samples(problem)]
    return replace(prices, contact=contact_prices(savings(problem, prices), by_cell))


def repriced(pricing: Pricing, prices: Prices, split: float) -> Prices:
    """Return prices that pay a share of the base's acceleration with the force, and move the base as before."""
    problem = pricing.problem
    world = np.einsum("iab,ijb->ija", problem.rotations, prices.reach)
    force = pricing.base(world.sum(axis=1), prices).force_n
    acceleration = force / problem.robot.mass_kg - upwards(problem)
    share = (split - prices.split) * problem.weights.acceleration / problem.robot.mass_kg
    shared = replace(prices, pull=prices.pull + share * acceleration, split=split)
    return with_contacts(problem, shared, np.full(problem.samples, _FEET_EXPECTED))


def even_prices(problem: Problem) -> Prices:
    """Return prices for a base that moves evenly on some three feet: reach is free, force costs what weight does."""
    pull = np.zeros((problem.samples, 3))
    pull[:, 2] = problem.weights.force * problem.robot.mass_kg * problem.gravity_mps2 / _FEET_EXPECTED
    bare = Prices(np.zeros((problem.samples, 4, 3)), pull, np.zeros(cell_count(problem)))
    return with_contacts(problem, bare, np.full(problem.samples, _FEET_EXPECTED))
