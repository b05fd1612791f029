"""Several obstacles in one mission: how they move, what scripts may say, what is planned, walked and logged."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from surefoot.errors import InputError
from surefoot.frames import Cell, Direction
from surefoot.missions.biped.mission import run_mission
from surefoot.missions.biped.run_log import read_run
from surefoot.missions.obstacles.bodies import Body, bodies_of
from surefoot.missions.obstacles.policies import PATIENCE_TURNS, Adversary, Crowd, Policy, random_policies
from surefoot.missions.obstacles.scripts import read_script
from surefoot.missions.plans.document import read_plan_document
from surefoot.missions.plans.planning import plan_mission
from surefoot.missions.scenario.file import read_scenario
from surefoot.missions.scenario.scene import BipedScene, read_biped_scene
from surefoot.navigation import Order

DEPOT_1M_SCENE = Path(__file__).parents[1] / "scenes" / "depot_1m_mission.yaml"


@pytest.fixture(scope="module")
def fast(scenes: Path) -> BipedScene:
    """Return a scene with a fast obstacle and a slow one that differ in their domains."""
    return read_biped_scene(scenes / "two_rooms_fast_obstacle_mission.yaml")


@pytest.fixture(scope="module")
def pair_plan(scenes: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a plan of the two rooms with two obstacles."""
    out = tmp_path_factory.mktemp("pair") / "plan"
    assert plan_mission(scenes / "two_rooms_two_obstacles_mission.yaml", out).verified
    return out


def test_a_fast_obstacle_goes_two_cells_in_its_domain(fast: BipedScene) -> None:
    grid = fast.grid
    quick, slow = bodies_of(fast.problem)
    start = Cell(*grid.cell(quick.start))
    two_away = grid.index(Cell(start.row, start.column - 2))
    assert two_away in quick.next_cells(quick.start)
    beside = grid.index(Cell(start.row, start.column - 1))
    assert two_away not in quick.next_cells(quick.start, barred=beside)
    assert beside not in quick.next_cells(quick.start, barred=beside)
    assert len(slow.next_cells(slow.start)) < len(quick.next_cells(slow.start))
    assert set(slow.domain) < set(quick.domain)


def moves(scene: BipedScene, policies: tuple[Policy, ...], orders: list[tuple[int, Order]]) -> list[list[int]]:
    """Return where the obstacles are after each turn, the start first."""
    crowd = Crowd(bodies_of(scene.problem), policies)
    places = [list(crowd.cells)]
    for turn, (cell, order) in enumerate(orders):
        crowd.move(turn, cell, order)
        places.append(list(crowd.cells))
    return places


def hunters(scene: BipedScene, bodies: tuple[Body, ...]) -> tuple[Policy, ...]:
    return tuple(Adversary(scene.coarse, body, seed) for seed, body in enumerate(bodies))


@given(seed=st.integers(0, 1000), adversarial=st.booleans())
def test_obstacles_keep_their_domain_their_speed_and_off_a_standing_robot(
    fast: BipedScene, seed: int, adversarial: bool
) -> None:
    bodies = bodies_of(fast.problem)
    policies = hunters(fast, bodies) if adversarial else random_policies(seed, 2)
    cell = fast.grid.index(Cell(3, 4))
    order = Order(Direction.WEST, waits=True)
    places = moves(fast, policies, [(cell, order)] * 30)
    for before, after in pairwise(places):
        for body, here, there in zip(bodies, before, after, strict=True):
            assert there in body.next_cells(here, cell)
            assert there != cell


def test_adversaries_block_the_way_and_make_way_in_time(fast: BipedScene) -> None:
    bodies = bodies_of(fast.problem)
    cell, target = fast.grid.index(Cell(3, 4)), fast.grid.index(Cell(3, 3))
    places = moves(fast, hunters(fast, bodies), [(cell, Order(Direction.WEST, waits=True))] * PATIENCE_TURNS)
    assert any(target in cells for cells in places)
    for body, place in zip(bodies, places[-1], strict=True):
        assert not {cell, target} & set(body.next_cells(place))


WELL = "{format: 1, kind: obstacle-script, positions_m: [[[17.57, 4.06], [17.57, 6.76]], [[6.76, 4.06]]]}"


def script(folder: Path, text: str) -> Path:
    path = folder / "script.yaml"
    path.write_text(text)
    return path


def test_a_script_of_several_has_a_list_for_each(fast: BipedScene, tmp_path: Path) -> None:
    read = read_script(script(tmp_path, WELL), fast.grid, bodies_of(fast.problem))
    places = [tuple(fast.grid.cell(cell)) for tour in read.tours for cell in tour]
    assert places == [(5, 6), (4, 6), (5, 2)]
    assert not read.repeat
    assert not read.breaks_assumptions


def test_a_tour_begins_again_after_its_end(fast: BipedScene, tmp_path: Path) -> None:
    text = WELL.replace("positions_m", "repeat: true, positions_m").replace(
        "[6.76, 4.06]", "[6.76, 4.06], [4.06, 4.06]"
    )
    tours = read_script(script(tmp_path, text), fast.grid, bodies_of(fast.problem))
    away = (fast.problem.start, Order(Direction.EAST, waits=False))
    places = moves(fast, tours.policies(), [away] * 5)
    assert [fast.grid.cell(cells[1])[1] for cells in places] == [1, 2, 1, 2, 1, 2]


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (("[[6.76, 4.06]]", "[[12.17, 4.06]]"), r"script\.yaml:1: positions_m\[1\]\[0\]: the obstacle cannot go from"),
        ((", [[6.76, 4.06]]]", "]"), r"positions_m: holds positions of 1 obstacle; the scenario has 2"),
        (("[[6.76, 4.06]]", "7"), r"positions_m\[1\]: must be a list of \[x, y\]"),
        (("[17.57, 6.76]", "[17.57, 400]"), r"positions_m\[0\]\[1\]: lies in no free cell"),
        (("positions_m", "repeat: maybe, positions_m"), r"repeat: must be true or false"),
        (("[[6.76, 4.06]]", "[]"), r"positions_m\[1\]: must be a list of \[x, y\] in metres, of at least one"),
        (("positions_m", "speed: 2, positions_m"), r":1: speed: is not a known key; allowed are format, kind, pos"),
        (("positions_m", "position_m"), r"position_m: is not a known key \(did you mean positions_m\?\)"),
        (("[[6.76, 4.06]]", "[[6.76, 4.06], [9.46, 4.06], [9.46, 4.06]]"), None),
        (("positions_m", "repeat: true, positions_m"), None),
    ],
)
def test_what_a_script_must_not_say(
    change: tuple[str, str], complaint: str | None, fast: BipedScene, tmp_path: Path
) -> None:
    path = script(tmp_path, WELL.replace(*change))
    if complaint is None:
        assert read_script(path, fast.grid, bodies_of(fast.problem)).tours
        return
    with pytest.raises(InputError, match=complaint):
        read_script(path, fast.grid, bodies_of(fast.problem))


def test_a_plan_and_a_log_name_the_kinds(pair_plan: Path, scenes: Path, tmp_path: Path) -> None:
    document = read_plan_document(pair_plan)
    assert document["kinds"] == [[0, 1]]
    assert [obstacle["speed_cells"] for obstacle in document["obstacles"]] == [1, 1]
    scenario = scenes / "two_rooms_two_obstacles_mission.yaml"
    answer = run_mission(scenario, pair_plan, steps=120, seed=4, obstacle="adversarial", out=tmp_path / "run")
    assert answer.verified, answer.findings
    run = read_run(tmp_path / "run")
    assert run.header.kinds == ((0, 1),)
    assert {len(turn.obstacles) for turn in run.turns} == {2}
    for turn in run.turns:
        (seen,), (hidden,) = turn.visible, turn.hidden
        assert all(cell in turn.obstacles for cell in seen)
        assert (len(seen) == 2) == (not hidden)
        assert all(cell in (*seen, *hidden) for cell in turn.obstacles)


def test_told_apart_they_are_kinds_of_their_own(scenes: Path, tmp_path: Path) -> None:
    text = (scenes / "two_rooms_two_obstacles_mission.yaml").read_text().replace("map: ", f"map: {scenes}/")
    path = tmp_path / "mission.yaml"
    path.write_text(text + "navigation: {belief_tracking: separate}\n")
    kinds = read_biped_scene(path).problem.obstacle_kinds
    assert [kind.obstacles for kind in kinds] == [(0,), (1,)]


def test_automatic_regions_are_chosen_from_the_map(scenes: Path, tmp_path: Path) -> None:
    text = (scenes / "two_rooms_mission.yaml").read_text().replace("map: ", f"map: {scenes}/")
    path = tmp_path / "mission.yaml"

    def regions(precision: float) -> int:
        path.write_text(text + f"navigation: {{belief: automatic, belief_precision: {precision}}}\n")
        return len(read_biped_scene(path).problem.regions)

    assert regions(0.0) < regions(0.5) < regions(1.0)


Walk = Callable[[str, str, int, int], None]


@pytest.fixture(scope="module")
def walked(scenes: Path, tmp_path_factory: pytest.TempPathFactory) -> Walk:
    """Return a function that plans a scene once, walks it, and demands that nothing goes wrong."""
    folder = tmp_path_factory.mktemp("walked")

    def walk(scene: str, policy: str, seed: int, steps: int) -> None:
        scenario, plan = scenes / f"{scene}_mission.yaml", folder / scene
        if not plan.exists():
            assert plan_mission(scenario, plan).verified
        answer = run_mission(scenario, plan, steps=steps, seed=seed, obstacle=policy, out=folder / "run")
        assert answer.verified, answer.findings
        assert answer.steps == steps
        assert (answer.collisions, answer.unsafe_steps, answer.belief_violations) == (0, 0, 0)
        assert (answer.assumption_violations, answer.replans) == (0, 0)

    return walk


@pytest.mark.parametrize("policy", ["random", "adversarial"])
def test_obstacles_that_differ_are_walked_around(policy: str, walked: Walk) -> None:
    walked("two_rooms_fast_obstacle", policy, 2, 250)


@pytest.mark.campaign
@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("policy", ["random", "adversarial"])
@pytest.mark.parametrize(
    "scene", ["two_rooms_two_obstacles", "two_rooms_three_obstacles", "two_rooms_fast_obstacle", "laboratory"]
)
def test_ensembles_of_several_obstacles(scene: str, policy: str, seed: int, walked: Walk) -> None:
    walked(scene, policy, seed, 500)


@pytest.mark.campaign
@pytest.mark.parametrize("policy", ["random", "adversarial"])
def test_three_obstacles_in_a_real_depot(policy: str, tmp_path: Path) -> None:
    scenario = DEPOT_1M_SCENE
    if not read_scenario(scenario).map_path.is_file():
        pytest.skip("the depot map in ../shared/data is absent")
    assert plan_mission(scenario, tmp_path / "plan").verified
    answer = run_mission(scenario, tmp_path / "plan", steps=1500, seed=1, obstacle=policy, out=tmp_path / "run")
    assert answer.succeeded, answer.findings
    assert answer.belief_violations == 0


@pytest.mark.campaign
def test_the_laboratory_among_robots_on_errands(scenes: Path, tmp_path: Path) -> None:
    scenario = scenes / "laboratory_mission.yaml"
    assert plan_mission(scenario, tmp_path / "plan").verified
    answer = run_mission(
        scenario,
        tmp_path / "plan",
        steps=500,
        seed=0,
        obstacle="scripted",
        script=scenes / "scripts" / "laboratory_errands.yaml",
        out=tmp_path / "run",
    )
    assert answer.succeeded, answer.findings
    assert answer.belief_violations == 0
