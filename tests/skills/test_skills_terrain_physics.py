from __future__ import annotations

import json
import threading
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from surefoot.compute import Deadline, each_answer, process_pool
from surefoot.errors import InputError
from surefoot.skills.classes import class_set
from surefoot.skills.physics import (
    Limits,
    PhysicsOfClasses,
    all_primitives,
    check_crossing,
    crossing_problem,
    free_regions,
    start_primitives,
)
from surefoot.skills.values import CheckResult, Direction, Physics, Primitive
from surefoot.verify import verify_path

U8 = class_set("unstructured-8")


def asked(physics: PhysicsOfClasses, *names: str) -> dict[str, CheckResult]:
    return {one.primitive.name: one for one in physics([Primitive.parse(name) for name in names])}


def facts_of(results: Iterable[CheckResult]) -> list[tuple[str, str, str, str, float]]:
    return sorted((r.primitive.name, r.verdict.value, r.gait, r.explanation, r.cost) for r in results)


def test_a_trot_walks_on_flat_ground_and_the_plan_is_verified(tmp_path: Path) -> None:
    result = asked(PhysicsOfClasses(U8), "forward flat->flat")["forward flat->flat"]
    assert (result.verdict, result.gait, result.horizon_s) == (Physics.FEASIBLE, "trot-2s", 2.0)
    assert result.plan is not None
    (tmp_path / "plan.json").write_text(result.plan)
    assert verify_path(tmp_path / "plan.json").accepted
    motion = json.loads(result.plan)["motion"]
    assert np.allclose(motion["base_m"][-1], [0.8, 0.0, 0.29], atol=1e-3)


def test_a_gap_needs_a_leap_and_says_why_a_trot_fails() -> None:
    trots = asked(PhysicsOfClasses(U8), "forward gap->flat")["forward gap->flat"]
    assert trots.verdict is Physics.INFEASIBLE
    assert "reach short by" in trots.explanation
    assert trots.explanation.startswith("trot-3s: ")
    leaps = PhysicsOfClasses(U8, limits=Limits(gaits=("trot-2s", "leap-1.5s")))
    assert asked(leaps, "forward gap->flat")["forward gap->flat"].gait == "leap-1.5s"


def test_only_the_difference_of_heights_counts() -> None:
    physics = PhysicsOfClasses(U8)
    pairs = [
        ("flat->flat", "high->high"),
        ("flat->flat", "low->low"),
        ("flat->high", "low->flat"),
        ("gap->flat", "high gap->high"),
        ("flat->low gap", "high->gap"),
    ]
    for a, b in pairs:
        assert physics.crossing(Primitive.parse(f"left {a}")) == physics.crossing(Primitive.parse(f"left {b}"))
    up, down = (physics.crossing(Primitive.parse(f"forward {one}")) for one in ("flat->high", "flat->low"))
    assert (up.rise_m, down.rise_m) == (0.15, -0.15)
    twice = asked(physics, "forward flat->flat", "forward high->high")
    assert len({one.plan for one in twice.values()}) == 1  # answered once


@pytest.mark.parametrize("name", ["forward flat->high", "forward flat->low", "backward flat->high"])
def test_feet_keep_clear_of_the_edge_of_a_step(name: str, tmp_path: Path) -> None:
    physics = PhysicsOfClasses(U8)
    crossing = physics.crossing(Primitive.parse(name))
    regions = free_regions(crossing)
    assert len(regions) == 2
    way = 1.0 if name.startswith("forward") else -1.0
    feet = [np.array([way * 0.1, 0.0, 0.0]), np.array([way * 0.7, 0.0, crossing.rise_m])]
    for foot in feet:
        assert any((matrix @ foot <= bound + 1e-9).all() for matrix, bound in regions), foot
    edge = np.array([way * 0.4, 0.0, max(crossing.rise_m, 0.0) - 0.02])
    assert not any((matrix @ edge <= bound).all() for matrix, bound in regions)
    result = check_crossing(Primitive.parse(name), crossing, physics.limits)
    assert result.plan is not None
    (tmp_path / "plan.json").write_text(result.plan)
    assert verify_path(tmp_path / "plan.json").accepted


def test_the_start_stands_on_the_ground_of_its_cell() -> None:
    for rules in map(class_set, ("unstructured-8", "rebar-14")):
        physics = PhysicsOfClasses(rules)
        for name in rules.names:
            problem = crossing_problem(physics.crossing(Primitive(Direction.LEFT, name, name)), physics.limits)
            if isinstance(problem, str):
                assert "cannot stand" in problem
            else:
                assert min(problem.start_polygons) >= 0
                assert float(np.abs(problem.start_m[:2]).max()) <= 0.15 + 1e-9


def test_a_class_without_footing_is_infeasible_in_words() -> None:
    small = PhysicsOfClasses(class_set("rebar-14"), cell_m=0.3)
    result = asked(small, "forward none-sparse->none-sparse")["forward none-sparse->none-sparse"]
    assert result.verdict is Physics.INFEASIBLE
    assert "cannot stand at the centre of the cell that it leaves" in result.explanation


def test_the_first_skills_are_about_those_of_the_paper() -> None:
    quick = Limits(explain=False)
    with ThreadPoolExecutor(1) as executor:
        rules = class_set("unstructured-4")
        results = list(PhysicsOfClasses(rules, limits=quick, executor=executor)(start_primitives(rules)))
    feasible = [one for one in results if one.verdict is Physics.FEASIBLE]
    assert 18 <= len(feasible) <= 20
    assert {one.primitive.direction for one in feasible} == set(Direction)
    assert not any(one.verdict is Physics.UNKNOWN for one in results)


def test_processes_threads_and_repetition_give_the_same_answers() -> None:
    names = ["forward flat->flat", "left flat->sparse", "backward gap->gap", "forward flat->dense"]
    primitives = [Primitive.parse(name) for name in names]
    limits = Limits(explain=False)
    alone = [next(iter(PhysicsOfClasses(U8, limits=limits)([one]))) for one in primitives]
    processes = PhysicsOfClasses(U8, limits=limits, workers=2)(primitives)
    assert facts_of(processes) == facts_of(alone)


def test_a_deadline_leaves_questions_open() -> None:
    with ThreadPoolExecutor(1) as executor:
        late = PhysicsOfClasses(U8, limits=Limits(deadline_s=0.0), executor=executor)
        results = list(late([Primitive.parse("forward flat->flat"), Primitive.parse("forward flat->dense")]))
    assert {one.verdict for one in results} == {Physics.UNKNOWN}
    assert {one.explanation for one in results} == {"the deadline of 0 s was reached"}


def test_what_does_not_exist_is_refused() -> None:
    with pytest.raises(InputError, match="there is no class 'mud'"):
        list(PhysicsOfClasses(U8)([Primitive.parse("forward flat->mud")]))
    with pytest.raises(InputError, match="there is no gait 'free-99s'"):
        PhysicsOfClasses(U8, limits=Limits(gaits=("free-99s",)))
    assert len(all_primitives(U8)) == 256


def test_a_hopeless_search_is_unknown_not_infeasible() -> None:
    physics = PhysicsOfClasses(U8, limits=Limits(time_limit_s=1e-9, explain=False))
    result = asked(physics, "forward flat->dense")["forward flat->dense"]
    assert result.verdict is Physics.UNKNOWN
    assert "the limit of 1e-09 s of processor time was reached" in result.explanation


def double(number: int) -> int:
    return 2 * number


def test_the_pool_answers_each_item() -> None:
    before = set(threading.enumerate())
    with process_pool(2) as executor:
        assert sorted(each_answer(executor, double, [3, 4, 5], Deadline())) == [(0, 6), (1, 8), (2, 10)]
    assert set(threading.enumerate()) <= before  # a thread that outlives its pool may print a traceback at exit
