"""The bound over all gaits: prices, tubes, mixtures and cuts, and what the checker says to them."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from free_scenes import checked, every_table, leap, tiny
from hypothesis import given, settings
from hypothesis import strategies as st

from surefoot.errors import InputError
from surefoot.footholds import solve, write_plan
from surefoot.footholds.ascent import Stage, ascended
from surefoot.footholds.bounding import Bounding
from surefoot.footholds.cells import cell_count, fixed
from surefoot.footholds.dual import Pricing
from surefoot.footholds.first_prices import even_prices, repriced
from surefoot.footholds.mixture import mixture_at
from surefoot.footholds.problem import Problem
from surefoot.footholds.sharing import (
    Prices,
    cone_slopes,
    contact_prices,
    left_over,
    nearest_in_cone,
    savings,
)
from surefoot.footholds.solve import Solution
from surefoot.footholds.terrain import polygon
from surefoot.footholds.tube import everywhere, reachable, tube_below
from surefoot.verify.footholds.cone import leans, pressed_into
from surefoot.verify.footholds.grid import grid_of
from surefoot.verify.footholds.rows import Surface

AHEAD_M = 0.25


@pytest.fixture(scope="module")
def cheapest_plan() -> Solution:
    """Return the cheapest plan of an enumeration of gaits."""
    found = [solve(fixed(tiny(AHEAD_M), table), certify=False, why=False) for table in every_table(5)]
    return min(found, key=lambda one: np.inf if one.objective is None else one.objective)


def any_prices(problem: Problem, seed: int) -> Prices:
    rng = np.random.default_rng(seed)
    reach = rng.normal(size=(problem.samples, 4, 3)) * 10 ** rng.uniform(0, 3)
    pull = even_prices(problem).pull + rng.normal(size=(problem.samples, 3)) * rng.uniform(0, 3)
    contact = even_prices(problem).contact * rng.uniform(0, 3, cell_count(problem))
    return Prices(reach, pull, contact, split=float(rng.choice([0.0, rng.uniform(0, 0.99)])))


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_any_prices_bound_the_cost_of_a_plan(seed: int) -> None:
    problem = tiny(AHEAD_M)
    assert 0 < PLAN_COST < 15_000
    assert Pricing(problem, 16).at(any_prices(problem, seed)).bound <= PLAN_COST * (1 + 1e-9)


PLAN_COST = solve(fixed(tiny(AHEAD_M), every_table(5)[30]), certify=False, why=False).objective or 0.0


@given(st.floats(0, 4), st.floats(0, 0.95))
def test_contact_prices_make_a_number_of_feet_best(held: float, split: float) -> None:
    problem = tiny(AHEAD_M)
    saved = savings(problem, replace(even_prices(problem), split=split))
    contact = contact_prices(saved, np.full(5, held))
    least = left_over(saved, contact)
    low, high = int(np.floor(held)), int(np.ceil(held))
    assert least == pytest.approx((contact * low - saved[:, low]).sum(), abs=1e-6)
    assert least == pytest.approx((contact * high - saved[:, high]).sum(), abs=1e-6)


@given(
    st.tuples(*[st.floats(-50, 50)] * 3), st.tuples(*[st.floats(0.01, 3)] * 4), st.lists(st.floats(0, 1), max_size=9)
)
def test_the_nearest_force_of_a_pyramid(
    force: tuple[float, ...], slopes: tuple[float, ...], parts: list[float]
) -> None:
    """It is in the pyramid, no other point is nearer, and the checker finds the same length."""
    sides, point = np.array(slopes), np.array([force])
    found = nearest_in_cone(point, sides)[0]
    assert -sides[0] * found[2] - 1e-9 <= found[0] <= sides[1] * found[2] + 1e-9
    assert -sides[2] * found[2] - 1e-9 <= found[1] <= sides[3] * found[2] + 1e-9
    for part in parts:
        height = 100 * part
        other = np.array([
            np.clip(force[0], -sides[0] * height, sides[1] * height),
            np.clip(force[1], -sides[2] * height, sides[3] * height),
            height,
        ])  # fmt: skip
        assert np.linalg.norm(found - point[0]) <= np.linalg.norm(other - point[0]) + 1e-9
    assert pressed_into(point, sides.reshape(2, 2))[0] == pytest.approx(float(found @ found), abs=1e-6)


def test_the_pyramid_holds_the_friction_of_all_grounds() -> None:
    """Also of tilted ones; the checker derives the same sides."""
    tilted = [[0.5, -0.4, 0.0], [0.9, -0.4, 0.15], [0.9, 0.4, 0.2], [0.5, 0.4, 0.05]]
    ground = (polygon([[0, -0.4, 0], [0.4, -0.4, 0], [0.4, 0.4, 0], [0, 0.4, 0]]), polygon(tilted, 0.3))
    slopes = cone_slopes(replace(tiny(AHEAD_M), polygons=ground))
    rays = np.concatenate([one.rays for one in ground])
    assert np.allclose(nearest_in_cone(rays, slopes), rays)
    own = leans([Surface(one.vertices_m, one.friction) for one in ground])
    assert own is not None
    assert own.ravel() == pytest.approx(slopes)
    wall = polygon([[0.5, -0.4, 0.0], [0.55, -0.4, 0.3], [0.55, 0.4, 0.3], [0.5, 0.4, 0.0]])
    assert not np.isfinite(cone_slopes(replace(tiny(AHEAD_M), polygons=(wall,)))).any()
    assert leans([Surface(wall.vertices_m, wall.friction)]) is None


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from([30.0, 300.0, 3000.0]))
def test_a_mixture_is_below_what_it_smooths_and_has_its_slope(seed: int, heat: float) -> None:
    problem = tiny(AHEAD_M)
    pricing, rng = Pricing(problem, 16, points=True), np.random.default_rng(seed)
    prices = replace(any_prices(problem, seed), split=0.5)
    ties = float((np.abs(prices.reach) * np.array(problem.robot.foot_reach_m)).sum())
    mixture = mixture_at(pricing, prices, heat)
    hard = pricing.at(prices).bound + ties
    assert mixture.value <= hard + 1e-9 * abs(hard)
    way = rng.normal(size=prices.reach.shape), rng.normal(size=prices.pull.shape), rng.normal(size=prices.contact.shape)
    step = 1e-3

    def value(part: float) -> float:
        moved = replace(
            prices,
            reach=prices.reach + part * way[0],
            pull=prices.pull + part * way[1] / 1000,
            contact=prices.contact + part * way[2],
        )
        return mixture_at(pricing, moved, heat).value

    slope = (mixture.off_m * way[0]).sum() + (mixture.draw * way[1]).sum() / 1000 + (mixture.missing * way[2]).sum()
    assert (value(step) - value(-step)) / (2 * step) == pytest.approx(float(slope), rel=1e-2, abs=1e-2)


def test_an_ascent_raises_the_bound() -> None:
    problem = tiny(AHEAD_M)
    pricing = Pricing(problem, 16, points=True)
    start = even_prices(problem)
    found = ascended(pricing, start, (Stage(1e-2, 30), Stage(1e-3, 30)), PLAN_COST)
    assert found.mixture is not None
    assert pricing.at(start).bound < pricing.at(found.prices).bound <= PLAN_COST


def test_the_tube_holds_the_cheapest_plan(cheapest_plan: Solution) -> None:
    """Also in the parts that cuts leave it, wherever they are."""
    problem, plan = tiny(AHEAD_M), cheapest_plan.plan
    assert plan is not None
    assert cheapest_plan.objective is not None
    pricing, rng = Pricing(problem, 24), np.random.default_rng(1)
    for split in (0.0, 0.7):
        priced = pricing.at(repriced(pricing, even_prices(problem), split))
        inverse, slack = pricing.base_hessian(split)[1], cheapest_plan.objective - priced.bound
        region = everywhere(problem)
        for _ in range(8):
            tube = tube_below(inverse, priced.base_m, slack, region)
            assert not tube.empty
            assert (plan.base_m >= tube.low_m - 1e-9).all()
            assert (plan.base_m <= tube.high_m + 1e-9).all()
            for foot in range(4):
                here = plan.feet_m[:, foot]
                standing = plan.forces_n[:, foot].any(axis=1)
                kept = np.array([reachable(problem, tube, foot, p[None], p[None])[:, 0] for p in here])
                cells = np.arange(problem.samples) // 2
                assert kept[np.arange(problem.samples), cells][standing].all()
            sample, axis = int(rng.integers(1, problem.samples - 2)), int(rng.integers(3))
            at = float(plan.base_m[sample, axis] + rng.normal() * 0.03)
            region = region.halves(sample, axis, at)[int(plan.base_m[sample, axis] > at)]


@pytest.mark.parametrize("slack", [1.0001, 1.3, 3.0])
@pytest.mark.parametrize("ahead_m", [AHEAD_M, 0.45])
def test_no_gait_of_an_enumeration_beats_the_bound(slack: float, ahead_m: float) -> None:
    """Neither with prices for all paths, nor with those of the parts of the tube of all plans below some worth."""
    found = [solve(fixed(tiny(ahead_m), table), certify=False, why=False).objective for table in every_table(5)]
    cheapest = min(one for one in found if one is not None)
    bounding = Bounding(tiny(ahead_m))
    for _ in range(4):
        bounding.climb(slack * cheapest, lambda: False)
        assert bounding.proof.bound <= cheapest
    assert bounding.proof.bound > 0.5 * cheapest


@pytest.fixture(scope="module")
def parted(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a plan whose bound holds for the parts of a tube, each with prices of its own."""
    problem = leap()
    solution = solve(problem)
    assert solution.free is not None
    assert solution.objective is not None
    bounding = Bounding(problem)
    for _ in range(3):
        bounding.climb(solution.objective, lambda: False)
    proof = bounding.proof
    assert proof.tree is not None
    assert proof.tree.cut is not None
    assert proof.worth == solution.objective
    path = tmp_path_factory.mktemp("parted") / "plan.json"
    gap = (solution.objective - proof.bound) / solution.objective
    free = replace(solution.free, proof=proof)
    write_plan(path, problem, replace(solution, bound=proof.bound, gap=gap, net_gap=None, free=free))
    return path


def test_the_checker_derives_the_bound_of_a_tree(parted: Path) -> None:
    ledger = checked(parted)
    assert not ledger.kept
    claimed = json.loads(parted.read_text())["answer"]["bound"]
    assert claimed * (1 - 1e-6) <= ledger.counts["bound"] < 1.05 * claimed


def test_a_tree_is_saved_with_the_prices_of_its_tube() -> None:
    """Also where nothing could be claimed before there was a tree."""
    bounding = Bounding(leap())
    bounding.landing, bounding.proof = np.inf, replace(bounding.proof, bound=-np.inf)
    for _ in range(2):
        bounding.climb(1e5, lambda: False)
    assert bounding.proof.bound == -np.inf
    bounding.landing = 0.0
    bounding.climb(1e5, lambda: False)
    assert bounding.proof.tree is not None
    assert bounding.proof.first is bounding.prices


def leaves(node: dict[str, Any]) -> list[dict[str, Any]]:
    return [node] if "cut" not in node else leaves(node["below"]) + leaves(node["above"])


def _all_leaves(bound: dict[str, Any], **values: Any) -> None:
    for leaf in leaves(bound["tree"]):
        leaf.update(values)


@pytest.mark.parametrize(
    "doctor",
    [
        lambda bound: bound.update(worth=0.5 * bound["worth"]),
        lambda bound: leaves(bound["tree"])[0].update(contact=[4 * one for one in bound["first"]["contact"]]),
        lambda bound: _all_leaves(bound, split=0.0),
        lambda bound: bound["first"].update(pull=[[0.0, 0.0, 0.0]] * 40) or bound.update(worth=1e9),
        lambda bound: leaves(bound["tree"])[-1].update(reach=[[20, 0, 2, 0, 9e4]]),
        lambda bound: bound.update(tree={**leaves(bound["tree"])[0], "walls": []}),
    ],
)
def test_the_checker_refuses_doctored_trees(
    parted: Path, tmp_path: Path, doctor: Callable[[dict[str, Any]], None]
) -> None:
    document = json.loads(parted.read_text())
    doctor(document["free"]["bound"])
    (tmp_path / "broken.json").write_text(json.dumps(document))
    assert checked(tmp_path / "broken.json").kept


@pytest.mark.parametrize(
    "doctor",
    [
        lambda bound: bound["tree"].update(cut=[0, 0, 0.3]),
        lambda bound: bound["tree"].update(cut=[10, 3, 0.3]),
        lambda bound: bound["tree"].update(cut=[10, 0, float("nan")]),
        lambda bound: bound["tree"].update(below=None),
        lambda bound: bound.update(tree=[]),
        lambda bound: leaves(bound["tree"])[0].update(walls=[[5, 1, 100.0]]),
        lambda bound: bound.pop("worth"),
        lambda bound: bound.pop("first"),
    ],
)
def test_the_checker_refuses_broken_trees(
    parted: Path, tmp_path: Path, doctor: Callable[[dict[str, Any]], None]
) -> None:
    document = json.loads(parted.read_text())
    doctor(document["free"]["bound"])
    (tmp_path / "broken.json").write_text(json.dumps(document))
    with pytest.raises(InputError, match=r"cannot be evaluated|no number of JSON"):
        checked(tmp_path / "broken.json")


@given(
    st.lists(st.floats(-0.3, 0.9), min_size=6, max_size=6),
    st.floats(0.0, 1.0),
    st.floats(0.0, 1.0),
    st.integers(0, 3),
)
@settings(max_examples=30)
def test_grids_enclose_quadratics(square: list[float], along: float, across: float, side: int) -> None:
    """The least over the nodes, less what they may spread, is below the value of any point of the polygon."""
    corners = np.array([[0.0, 0.0, 0.0], [0.9, 0.2, 0.1], [0.8, 0.9, 0.1], [-0.1, 0.7, 0.0]])
    surface = Surface(corners, 0.6)
    grid = grid_of([surface], np.array([[0.1 * side, 0.3, 0.0]]), np.zeros(3), (0.1, 0.15))
    a, b, _, d = surface.corners
    mixed = a + along * (b - a) + across * (d - a)
    point = mixed - ((mixed - a) @ surface.normal) * surface.normal
    if surface.outside(point) > 0:
        return
    weight, tilt = 50.0, 40 * np.array(square[:3])
    at_nodes = weight * ((grid.points**2).sum(axis=1) - grid.spread) + grid.points @ tilt
    assert at_nodes[:-1].min() <= weight * float(point @ point) + float(tilt @ point) + 1e-9
