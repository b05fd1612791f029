"""Several obstacles: the compiled turn against brute force, and plans whose maker took one rule of them wrongly."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from naive_planner import Cheats, read_rows, rewrite, write_document, write_map, write_plan
from pure_obstacles import Cells, PureObstacles
from small_scene import PICTURE, SCENARIO, Planner

from surefoot.errors import LimitExceeded
from surefoot.verify import Report, verify_path
from surefoot.verify.navigation import true_product
from surefoot.verify.navigation.assumption import Assumption
from surefoot.verify.navigation.belief import Abstraction, KindKnown, Known, Obstacles, Turned
from surefoot.verify.scene.derived import Scene, derive_scene
from surefoot.verify.scene.scenario import read_scenario

Rows = dict[str, Any]
EAST = "forbidden: [{rectangle_m: [0, 0, 2, 3]}]"
TWO = f"obstacles: [{{start_m: [4.5, 2.5], {EAST}}}, {{start_m: [4.5, 1.5], {EAST}}}]"
NARROWER = EAST.replace("]}]", "]}, {rectangle_m: [3, 2, 4, 3]}]")
UNLIKE = f"obstacles: [{{start_m: [4.5, 2.5], {EAST}}}, {{start_m: [4.5, 1.5], {NARROWER}}}]"
SEPARATE = "navigation: {belief_tracking: separate}"
AUTOMATIC = "navigation: {belief: automatic, belief_precision: 2}"


def rules(report: Report) -> set[str]:
    return {finding.rule for finding in report.findings}


def scene_of(folder: Path, obstacles: str, extra: str = "") -> Scene:
    write_map(folder, PICTURE, pixels=10, resolution_m=0.1)
    (folder / "scenario.yaml").write_text(SCENARIO.replace("OBSTACLES", obstacles).replace("EXTRA", extra))
    return derive_scene(read_scenario(folder / "scenario.yaml"))


def some(scene: Scene, draw: Callable[..., Any]) -> KindKnown:
    """Draw what may be known of a kind of three obstacles in the whole scene."""
    cells = st.sampled_from([scene.index(cell) for cell in scene.kinds])
    visible = draw(st.lists(cells, max_size=3))
    hidden = draw(st.sets(cells, min_size=1, max_size=5)) if len(visible) < 3 else set()
    return KindKnown(tuple(sorted(visible)), tuple(sorted(hidden)))


@settings(max_examples=80, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data(), st.integers(1, 3), st.sampled_from(["exact", "regions", "single"]), st.booleans())
def test_turn_is_that_of_every_assignment(
    tmp_path: Path, data: st.DataObject, speed: int, method: str, waits: bool
) -> None:
    one = f"{{start_m: [4.5, 2.5], speed_cells: {speed}}}"
    scene = scene_of(tmp_path, f"obstacles: [{one}, {one}, {one}]")
    regions = (frozenset({2, 3, 4}), frozenset({10, 5})) if method == "regions" else ()
    own, pure = (kind(scene, Abstraction(method, regions)) for kind in (Obstacles, PureObstacles))
    known = (some(scene, data.draw),)
    robot = data.draw(st.sampled_from([scene.index(cell) for cell in scene.kinds]))
    moves = scene.moves(scene.cell(robot))
    after = robot if waits else scene.index(scene.target(scene.cell(robot), data.draw(st.sampled_from(moves))))
    found, expected = (obstacles.turn(known, robot, after, waits=waits) for obstacles in (own, pure))
    assert found.lost == expected.lost
    assert sorted(found.kinds[0]) == sorted(expected.kinds[0])


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data(), st.integers(1, 2))
def test_blocked_is_what_the_rule_says(tmp_path: Path, data: st.DataObject, speed: int) -> None:
    one = f"{{start_m: [4.5, 2.5], speed_cells: {speed}, forbidden: [{{rectangle_m: [2, 2, 3, 3]}}]}}"
    scene = scene_of(tmp_path, f"obstacles: [{one}, {one}, {one}]")
    obstacles = PureObstacles(scene, Abstraction("exact", ()))
    part = some(scene, data.draw)
    part = KindKnown(*(tuple(cell for cell in cells if cell in obstacles.place) for cells in part))
    robot = data.draw(st.sampled_from([scene.index(cell) for cell in scene.kinds]))
    target = scene.index(scene.target(scene.cell(robot), data.draw(st.sampled_from(scene.moves(scene.cell(robot))))))
    free = {cell for cell in obstacles.domain if not {robot, target} & set(obstacles.next_of(0, cell))}

    def component(cell: int) -> set[int]:
        found = {cell} - {robot}
        while grown := {after for home in found for after in obstacles.next_of(0, home, robot)} - found:
            found |= grown
        return found

    visible = any(cell not in free and component(cell) & free for cell in part.visible)
    shown = {cell for cell in free if scene.sees[robot, cell]}
    hidden = any(cell not in free for cell in part.hidden) and all(component(cell) & shown for cell in part.hidden)
    assert Assumption(obstacles).blocked((part,), robot, target) == (visible or hidden)


@pytest.fixture(scope="module")
def apart(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a sound plan with two obstacles of different domains, which are told apart therefore."""
    folder = tmp_path_factory.mktemp("apart")
    scene_of(folder, UNLIKE)
    return write_plan(folder / "scenario.yaml", folder / "plan")


@pytest.fixture
def plan(apart: Path, tmp_path: Path) -> Path:
    """Return a copy of that plan, to be changed."""
    return Path(shutil.copytree(apart.parent, tmp_path / "world")) / "plan"


def test_sound_plan_that_tells_obstacles_apart_is_accepted(apart: Path) -> None:
    assert_accepted(verify_path(apart))


@pytest.mark.parametrize("extra", ["", AUTOMATIC])
def test_sound_plan_of_two_obstacles_is_accepted(planned: Planner, extra: str) -> None:
    assert_accepted(verify_path(planned(obstacles=TWO, extra=extra)))


def assert_accepted(report: Report) -> None:
    assert report.accepted, report.findings
    assert report.counts["true_product_is_whole"]
    assert int(str(report.counts["true_product_states"])) > int(str(report.counts["navigation_decisions"]))


def test_product_that_is_too_large_is_left_out_and_said_so(planned: Planner, monkeypatch: pytest.MonkeyPatch) -> None:
    plan = planned()
    monkeypatch.setattr(true_product, "MOST_EDGES", 10)
    report = verify_path(plan)
    assert report.accepted
    assert not report.counts["true_product_is_whole"]
    assert "true_product_states" not in report.counts


class OneIsEnough(PureObstacles):
    """Takes the hidden image of one assignment for that of all: the smallest one."""

    def merge(self, images: Iterable[Cells]) -> Cells:
        return min(images, key=len)


class Careless(Obstacles):
    """Looks out for obstacles of the first kind alone."""

    def turn(self, known: Known, robot: int, after: int, *, waits: bool) -> Turned:
        nobody = tuple(KindKnown((), ()) for _ in known[1:])
        lost = super().turn((known[0], *nobody), robot, after, waits=waits).lost
        return super().turn(known, robot, after, waits=waits)._replace(lost=lost)


class Narrow(Obstacles):
    """Leaves the first cell out of the last kind's hidden sets."""

    def turn(self, known: Known, robot: int, after: int, *, waits: bool) -> Turned:
        turned = super().turn(known, robot, after, waits=waits)
        last = tuple(part._replace(hidden=part.hidden[1:] or part.hidden) for part in turned.kinds[-1])
        return turned._replace(kinds=(*turned.kinds[:-1], last))


def slow(scene: Scene, belief: Abstraction) -> Obstacles:
    """Take every obstacle for a slow one."""
    return Obstacles(scene, belief, tuple(replace(kind, speed_cells=1) for kind in scene.obstacle_kinds))


FAST = f"obstacles: [{{start_m: [4.5, 2.5], speed_cells: 2, {EAST}}}]"
WRONG: dict[str, tuple[Any, str, str, set[str]]] = {
    "no look out for the second obstacle": (Careless, TWO, SEPARATE, {"rules.md 4, collision"}),
    "a narrowed belief in the second obstacle": (Narrow, UNLIKE, "", {"rules.md 4, belief"}),
    "a narrowed joint belief": (Narrow, TWO, "", {"rules.md 4, belief"}),
    "one hidden image instead of their union": (
        OneIsEnough,
        TWO,
        "navigation: {belief: exact}",
        {"rules.md 4, belief"},
    ),
    "a fast obstacle taken for a slow one": (slow, FAST, "", {"rules.md 4, belief", "rules.md 4, dead end"}),
}


@pytest.mark.parametrize("name", WRONG)
def test_plan_of_a_wrong_game_is_refused(planned: Planner, name: str) -> None:
    obstacles, scenario, extra, expected = WRONG[name]
    report = verify_path(planned(Cheats(obstacles=obstacles), obstacles=scenario, extra=extra))
    assert not report.accepted
    assert expected & rules(report), report.findings


def with_kinds_swapped(rows: Rows) -> None:
    rows["visible"], rows["hidden"] = rows["visible"][:, ::-1], rows["hidden"][:, ::-1]


def with_a_forgotten_obstacle(rows: Rows) -> None:
    row = int(np.flatnonzero(rows["hidden"][:, 1].any(axis=1))[0])
    rows["hidden"][row, 1] = 0


def with_an_obstacle_both_seen_and_hidden(rows: Rows) -> None:
    row = int(np.flatnonzero(rows["visible"][:, 1] >= 0)[0])
    rows["hidden"][row, 1, 0] = 1


def with_a_narrower_second_belief(rows: Rows) -> None:
    bits = np.unpackbits(rows["hidden"][:, 1], axis=1, bitorder="little")
    row = int(np.flatnonzero(bits.sum(axis=1) > 1)[0])
    bits[row, np.flatnonzero(bits[row])[0]] = 0
    rows["hidden"][:, 1] = np.packbits(bits, axis=1, bitorder="little")


def outside_the_domain(rows: Rows) -> None:
    row = int(np.flatnonzero(rows["visible"][:, 1] >= 0)[0])
    rows["visible"][row, 1] = 0


def without_a_row(rows: Rows) -> None:
    for name in set(rows) - {"domain"}:
        rows[name] = np.delete(rows[name], len(rows[name]) // 2, axis=0)


def with_a_row_twice(rows: Rows) -> None:
    for name in set(rows) - {"domain"}:
        rows[name] = np.concatenate([rows[name], rows[name][-1:]])


ROWS: dict[str, tuple[Callable[[Rows], None], set[str]]] = {
    "kinds swapped": (with_kinds_swapped, {"formats.md 2, navigation.npz"}),
    "an obstacle forgotten": (with_a_forgotten_obstacle, {"formats.md 2, navigation.npz"}),
    "an obstacle both seen and hidden": (with_an_obstacle_both_seen_and_hidden, {"formats.md 2, navigation.npz"}),
    "a narrower second belief": (with_a_narrower_second_belief, {"rules.md 4, belief"}),
    "an obstacle outside its domain": (outside_the_domain, {"formats.md 2, navigation.npz"}),
    "an answer without a row": (without_a_row, {"rules.md 4, belief", "rules.md 4, dead end"}),
    "a decision twice": (with_a_row_twice, {"formats.md 2, navigation.npz"}),
}


@pytest.mark.parametrize("name", ROWS)
def test_changed_rows_of_two_obstacles_are_refused(plan: Path, name: str) -> None:
    change, expected = ROWS[name]
    rows = read_rows(plan, "navigation.npz")
    change(rows)
    rewrite(plan, "navigation.npz", rows)
    assert expected & rules(verify_path(plan))


CLAIMS: dict[str, tuple[Callable[[Any], object], str]] = {
    "one kind instead of two": (lambda p: p.update(kinds=[[0, 1]]), "rules.md 4, kinds"),
    "kinds in another order": (lambda p: p.update(kinds=[[1], [0]]), "rules.md 4, kinds"),
    "a smaller second domain": (lambda p: p["obstacles"][1]["domain"].pop(), "rules.md 4, obstacle domain"),
    "a slower second obstacle": (lambda p: p["obstacles"][1].update(speed_cells=2), "formats.md 1, obstacles"),
    "starts exchanged": (
        lambda p: p["obstacles"][0].update(start=p["obstacles"][1]["start"]),
        "formats.md 1, obstacles",
    ),
    "another abstraction": (lambda p: p["belief"].update(abstraction="exact"), "rules.md 4, belief abstraction"),
}


@pytest.mark.parametrize("name", CLAIMS)
def test_wrong_claim_about_two_obstacles_is_refused(plan: Path, name: str) -> None:
    change, rule = CLAIMS[name]
    document = json.loads((plan / "plan.json").read_text())
    change(document)
    write_document(plan, document)
    assert rule in rules(verify_path(plan))


def test_regions_that_the_planner_chose_may_not_overlap(planned: Planner) -> None:
    plan = planned(obstacles=TWO, extra=AUTOMATIC)
    document = json.loads((plan / "plan.json").read_text())
    document["belief"]["regions"].append(document["belief"]["regions"][0][:1])
    write_document(plan, document)
    assert "rules.md 4, belief abstraction" in rules(verify_path(plan))


def test_too_many_observations_are_a_limit(tmp_path: Path) -> None:
    crowd = ", ".join(["{start_m: [4.5, 2.5]}"] * 15)
    scene = scene_of(tmp_path, f"obstacles: [{crowd}]", "navigation: {belief: single}")
    all_seen = replace(scene, sees=np.ones_like(scene.sees))
    obstacles = Obstacles(all_seen, Abstraction("single", ()))
    anywhere = (KindKnown((), obstacles.domain),)
    with pytest.raises(LimitExceeded, match="too many ways"):
        obstacles.turn(anywhere, 0, 0, waits=True)


def test_too_many_obstacles_of_a_kind_are_a_limit(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, "obstacles: [" + ", ".join(["{start_m: [4.5, 2.5]}"] * 16) + "]")
    with pytest.raises(LimitExceeded, match="at most 15"):
        Obstacles(scene, Abstraction("single", ()))
