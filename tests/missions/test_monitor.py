"""Obstacles that break their assumptions: noticed at once, logged, and planned around."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from surefoot.frames import Cell, Direction
from surefoot.missions.biped.mission import RunAnswer, run_mission
from surefoot.missions.biped.monitor import explained, reset, safe_order, violations
from surefoot.missions.biped.replanning import replanned
from surefoot.missions.biped.run_log import Run, read_run
from surefoot.missions.scenario.scene import BipedScene, read_biped_scene
from surefoot.navigation import ObstacleState, Order, Rules
from surefoot.verify import verify_path


@pytest.fixture(scope="module")
def scene(scenes: Path) -> BipedScene:
    """Return the two-room scene."""
    return read_biped_scene(scenes / "two_rooms_mission.yaml")


def cell(scene: BipedScene, row: int, column: int) -> int:
    return scene.grid.index(Cell(row, column))


def broken(scene: BipedScene, before: ObstacleState, order: Order, *seen: tuple[int, int]) -> list[str]:
    """Return what is wrong with an observation from cell (3, 4)."""
    rules, here = Rules(scene.problem), cell(scene, 3, 4)
    outcomes = rules.outcomes(
        here, here if order.waits else rules.arrival(here, order.direction, order)[0], order, before
    )
    places = (tuple(sorted(cell(scene, *place) for place in seen)),)
    found = violations(rules, here, order, before, outcomes, places)
    assert bool(found) == (explained(outcomes, places) is None)
    return [violation.violation for violation in found]


WAIT, MOVE = Order(Direction.WEST, waits=True), Order(Direction.SOUTH, waits=False)


def test_every_kind_of_violation_is_told(scene: BipedScene) -> None:
    seen = ObstacleState(((cell(scene, 3, 2),),), (0,))
    kinds = scene.problem.obstacle_kinds
    hidden = ObstacleState(((),), (kinds.mask((cell(scene, 5, 1),)),))
    assert not broken(scene, seen, WAIT, (3, 3))
    assert not broken(scene, seen, WAIT, (3, 2))
    assert broken(scene, seen, WAIT, (3, 4)) == ["collides"]
    assert broken(scene, seen, WAIT, (2, 4)) == ["jumps"]
    assert broken(scene, hidden, WAIT, (2, 4)) == ["appears"]
    assert broken(scene, hidden, WAIT, (2, 6)) == ["forbidden"]
    assert broken(scene, ObstacleState(((cell(scene, 3, 3),),), (0,)), WAIT) == ["vanishes"]


def test_nothing_is_known_after_a_reset_but_what_is_seen(scene: BipedScene) -> None:
    kinds, view = scene.problem.obstacle_kinds, cell(scene, 3, 4)
    (hidden,) = reset(kinds, view, ((),))
    assert hidden == kinds.kinds[0].within & ~kinds.seen_from[view]
    assert reset(kinds, view, ((cell(scene, 3, 2),),)) == (0,)


def test_the_robot_stops_but_not_on_stairs(scene: BipedScene) -> None:
    assert safe_order(scene.coarse, cell(scene, 3, 4), Direction.WEST) == Order(Direction.WEST, waits=True)
    assert safe_order(scene.coarse, cell(scene, 2, 6), Direction.WEST) == Order(Direction.WEST, waits=False)
    corner = safe_order(scene.coarse, cell(scene, 3, 1), Direction.WEST)
    assert corner.waits
    assert corner.direction is not Direction.EAST


def test_planning_again_starts_from_what_is_seen(scene: BipedScene) -> None:
    here, stairs = cell(scene, 2, 5), cell(scene, 2, 6)
    attempt = replanned(scene.problem, 1, here, Direction.WEST, 1, here, ((cell(scene, 1, 4),),))
    assert attempt.guide is not None
    start = attempt.guide.rules.start()
    assert start.visible == ((cell(scene, 1, 4),),)
    assert attempt.guide.decide(here, Direction.WEST, start, 1)
    assert replanned(scene.problem, 1, here, Direction.WEST, 1, here, ((here,),)).guide is None
    trespassing = replanned(scene.problem, 1, here, Direction.WEST, 1, here, ((cell(scene, 2, 4),),))
    assert trespassing.guide is None or stairs not in trespassing.guide.rules.kinds.cells


def run_broken(name: str, plan: Path, scenes: Path, out: Path) -> tuple[RunAnswer, Run]:
    script = scenes / "scripts" / f"two_rooms_{name}.yaml"
    answer = run_mission(
        scenes / "two_rooms_mission.yaml", plan, steps=120, seed=0, obstacle="scripted", script=script, out=out
    )
    return answer, read_run(out)


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("jump", ["jumps"]),
        ("appear", ["appears"]),
        ("trespass", ["forbidden", "forbidden"]),
        ("collide", ["collides"]),
    ],
)
def test_a_broken_assumption_is_noticed_at_once_and_planned_around(
    name: str, told: list[str], two_rooms_plan: Path, scenes: Path, tmp_path: Path
) -> None:
    answer, run = run_broken(name, two_rooms_plan, scenes, tmp_path / "run")
    assert answer.verified, answer.findings
    assert [violation.violation for violation in run.violations] == told
    assert (answer.assumption_violations, answer.replans) == (len(told), len(run.replans))
    assert min(answer.goals_reached) >= 1
    for violation in run.violations:
        stopped = run.turns[violation.turn]
        assert stopped.strategy == -1
        assert stopped.order.startswith("wait")
        if violation.cell is not None:
            assert violation.cell in stopped.obstacles
    for number, replan in enumerate(run.replans, start=1):
        assert run.turns[replan.turn].strategy == replan.strategy == number
    assert run.turns[-1].strategy == len(run.replans)


def test_no_broken_assumption_goes_unlogged(two_rooms_plan: Path, scenes: Path, tmp_path: Path) -> None:
    run_broken("jump", two_rooms_plan, scenes, tmp_path / "run")
    log = tmp_path / "run" / "run.jsonl"
    text = log.read_text()
    lines = text.splitlines(keepends=True)
    log.write_text("".join(line for line in lines if json.loads(line)["record"] != "violation"))
    assert not verify_path(tmp_path / "run").accepted
    assert '"breaks_assumptions": true' in text
    log.write_text(text.replace('"breaks_assumptions": true', '"breaks_assumptions": false'))
    assert not verify_path(tmp_path / "run").accepted
