"""Compares what ``plan.json`` claims with the derived scene; every difference is a refusal."""

from __future__ import annotations

import math
from dataclasses import dataclass

from surefoot.frames import Direction
from surefoot.verify.artefacts import PlanFile
from surefoot.verify.findings import Ledger
from surefoot.verify.navigation.belief import METHODS, Abstraction, abstraction_of
from surefoot.verify.scene.derived import Cell, Context, ObstacleKind, Scene, fine_distance_m
from surefoot.verify.scene.heights import TOLERANCE_M, CellProfile
from surefoot.verify.scene.scenario import HEADINGS, TURNS, WALKING_KEYS
from surefoot.verify.values import Fields

ORDERS = (*HEADINGS, "stop")
CLOSED_TURN_CELLS = 1e-3


@dataclass(frozen=True, slots=True)
class Claims:
    """What the games need of a plan, in the plan's own numbering, after the comparison with the scene.

    Attributes:
        profiles: index 0 is flat.
        contexts: in the order that ``action.npz`` counts.
        kinds: profile of each free cell.
        start: the start cell.
        heading: the heading there.
        fine: the fine cell there.
        goals: cells in the order of visiting.
        obstacles: where each obstacle starts.
        belief: the belief abstraction.
        walking: the numbers of the ``walking`` block.
        apex_speeds: least and most.
        straight: lengths of the straight moves, in fine cells.
        turns: lengths of the steps of a turn of type A and of type B, in fine cells.
    """

    profiles: tuple[CellProfile | None, ...]
    contexts: tuple[Context, ...]
    kinds: dict[Cell, int]
    start: Cell
    heading: Direction
    fine: Cell
    goals: tuple[Cell, ...]
    obstacles: tuple[Cell, ...]
    belief: Abstraction
    walking: dict[str, float]
    apex_speeds: tuple[float, float]
    straight: tuple[int, ...]
    turns: tuple[tuple[float, ...], tuple[float, ...]]

    @property
    def turn_steps(self) -> int:
        """Return how many steps a quarter turn has."""
        return round(90 / self.walking["turn_angle_deg"])

    def whole(self, name: str) -> int:
        """Return a whole number of the walking block."""
        return round(self.walking[name])


def compare(plan: PlanFile, scene: Scene, ledger: Ledger) -> Claims:
    """Compare a plan with the scene that its scenario and map describe.

    Returns:
        The plan's own numbering of what agrees; only to be relied on when the ledger stays empty.

    Raises:
        InputError: the plan is malformed.
    """
    fields = plan.fields
    if (
        plan.map_path.resolve() != scene.floor.path.resolve()
        or plan.image_path.resolve() != scene.floor.image_path.resolve()
    ):
        raise fields.wrong("map", "is not the map of the scenario")
    _compare_grid(fields.mapping("grid"), scene, ledger)
    _compare_robot(fields.mapping("robot"), scene, ledger)
    walking, straight, turns = _compare_walking(fields.mapping("walking"), scene, ledger)
    profiles, kinds = _compare_profiles(fields, scene, ledger)
    contexts = _compare_contexts(fields, scene, kinds, profiles, ledger)
    start = fields.mapping("start")
    fine_fields = start.mapping("fine")
    limit = round(walking["fine_cells"]) - 1
    fine = (fine_fields.whole("row", least=0, most=limit), fine_fields.whole("column", least=0, most=limit))
    claims = Claims(
        profiles=profiles,
        contexts=contexts,
        kinds=kinds,
        start=start.cell("cell"),
        heading=Direction(HEADINGS.index(start.text("heading", among=HEADINGS))),
        fine=fine,
        goals=fields.cells("goals"),
        obstacles=_compare_obstacles(fields, scene, ledger),
        belief=_compare_belief(fields.mapping("belief"), scene, ledger),
        walking=walking,
        apex_speeds=_pair(scene.scenario.walking["apex_speed_mps"]),
        straight=straight,
        turns=turns,
    )
    _compare_places(claims, start.number("moved_m", least=0), scene, ledger)
    return claims


def _compare_grid(grid: Fields, scene: Scene, ledger: Ledger) -> None:
    frame, rule = scene.frame, "rules.md 1, grid"
    if (grid.whole("rows"), grid.whole("columns")) != (frame.rows, frame.columns):
        ledger.refuse(rule, f"the map holds {frame.rows} rows and {frame.columns} columns", "plan.json grid")
    own = {
        "north_west_m": frame.north_west_m,
        "cell_size_m": (frame.cell_size_m,),
        "origin_m": frame.origin_m,
        "rotation_rad": (frame.rotation_rad,),
    }
    for name, values in own.items():
        found = grid.numbers(name, 2) if len(values) == 2 else (grid.number(name),)
        if any(abs(a - b) > TOLERANCE_M for a, b in zip(found, values, strict=True)):
            ledger.refuse(rule, f"is {values}", f"plan.json grid.{name}")
    claimed = set(grid.cells("free"))
    derived = set(scene.kinds)
    for cells, text in ((claimed - derived, "is blocked"), (derived - claimed, "is free")):
        for cell in sorted(cells):
            ledger.refuse("rules.md 1, free cells", f"cell {cell} {text}", "plan.json grid.free")


def _compare_robot(robot: Fields, scene: Scene, ledger: Ledger) -> None:
    if robot.text("name") != scene.robot.name:
        ledger.refuse("formats.md 1, robot", f"the scenario's robot is {scene.robot.name}", "plan.json robot.name")
    for name in ("apex_height_m", "omega_radps", "foot_radius_m", "foot_half_length_m", "foot_half_width_m"):
        own = getattr(scene.robot, name)
        if not math.isclose(robot.number(name), own, rel_tol=1e-9):
            ledger.refuse("formats.md 2, robot", f"is {own}", f"plan.json robot.{name}")


def _compare_walking(
    walking: Fields, scene: Scene, ledger: Ledger
) -> tuple[dict[str, float], tuple[int, ...], tuple[tuple[float, ...], tuple[float, ...]]]:
    """Compare the walking block with the scenario's, and check that whole turns end on cell centres."""
    rule = "formats.md 1, walking"
    walking.only((*WALKING_KEYS, "fine_cell_m"))
    numbers: dict[str, float] = {}
    for name, own in scene.scenario.walking.items():
        found = walking.numbers(name) if isinstance(own, tuple) else (walking.number(name),)
        expected = own if isinstance(own, tuple) else (own,)
        slack = 1e-3 if name in TURNS else 1e-12  # the planner lets whole turns end exactly on cell centres
        if len(found) != len(expected) or any(
            not math.isclose(a, b, rel_tol=1e-12, abs_tol=slack) for a, b in zip(found, expected, strict=True)
        ):
            ledger.refuse(rule, f"is {own} by the scenario, not {walking.get(name)}", f"plan.json walking.{name}")
        if not isinstance(own, tuple):
            numbers[name] = float(own)
    fine_m = scene.frame.cell_size_m / numbers["fine_cells"]
    if not math.isclose(walking.number("fine_cell_m"), fine_m, rel_tol=1e-12):
        ledger.refuse(rule, f"is {fine_m}", "plan.json walking.fine_cell_m")
    numbers["fine_cell_m"] = fine_m
    steps = 90 / numbers["turn_angle_deg"] if numbers["turn_angle_deg"] > 0 else math.nan
    if not 1 <= steps <= 90 or abs(steps - round(steps)) > 1e-9:
        raise walking.wrong("turn_angle_deg", "has to divide 90")
    turn_a, turn_b = (_turn(walking, name, round(steps), ledger) for name in TURNS)
    straight = walking.wholes("straight_cells")
    if not straight or min(straight) < 1:
        raise walking.wrong("straight_cells", "has to be a list of lengths of at least one fine cell")
    return numbers, straight, (turn_a, turn_b)


def _turn(walking: Fields, name: str, steps: int, ledger: Ledger) -> tuple[float, ...]:
    """Return the lengths of the steps of a turn, which has to end on a cell centre."""
    lengths = walking.numbers(name, steps)
    angle = math.radians(walking.number("turn_angle_deg"))
    ahead = sum(length * math.cos((i + 1) * angle) for i, length in enumerate(lengths))
    aside = sum(length * math.sin((i + 1) * angle) for i, length in enumerate(lengths))
    rest = max(abs(value - round(value)) for value in (ahead, aside))
    if min(lengths) <= 0 or rest > CLOSED_TURN_CELLS:
        ledger.refuse(
            "rules.md 5, turn types", "a whole turn does not end on a cell centre", f"plan.json walking.{name}"
        )
    return lengths


def _compare_profiles(
    fields: Fields, scene: Scene, ledger: Ledger
) -> tuple[tuple[CellProfile | None, ...], dict[Cell, int]]:
    """Match the plan's profiles with the derived ones; return them and the cells' kinds in the plan's order."""
    rule, listed = "rules.md 2, profiles", fields.items("profiles")
    if not listed or listed[0] is not None:
        raise fields.wrong("profiles", "has to begin with null, the flat one")
    place = "plan.json profiles"
    read = [_profile(Fields.of(value, fields.source, f"profiles[{i + 1}]")) for i, value in enumerate(listed[1:])]
    if len(read) > 1000:
        raise fields.wrong("profiles", "has to be a list of at most 1000 profiles")
    number: dict[int, int] = {0: 0}
    for own, profile in enumerate(scene.profiles):
        if profile is None:
            continue
        found = [index + 1 for index, claimed in enumerate(read) if profile.same(claimed)]
        if len(found) != 1:
            ledger.refuse(rule, f"a profile of the map is listed {len(found)} times instead of once", place)
        number[own] = found[0] if found else 0
    if len(read) != len(scene.profiles) - 1:
        ledger.refuse(rule, f"the map has {len(scene.profiles) - 1} profiles of stairs, not {len(read)}", place)
    return (None, *read), {cell: number[kind] for cell, kind in scene.kinds.items()}


def _profile(fields: Fields) -> CellProfile:
    fields.only(("up", "heights_m", "gain_m", "admissible"))
    admissible = fields.items("admissible")
    if not all(isinstance(value, bool) for value in admissible):
        raise fields.wrong("admissible", "has to be a list of true and false")
    return CellProfile(
        Direction(HEADINGS.index(fields.text("up", among=HEADINGS))),
        fields.numbers("heights_m"),
        fields.number("gain_m"),
        tuple(bool(value) for value in admissible),
    )


def _compare_contexts(
    fields: Fields,
    scene: Scene,
    kinds: dict[Cell, int],
    profiles: tuple[CellProfile | None, ...],
    ledger: Ledger,
) -> tuple[Context, ...]:
    """Compare the contexts with those of the map; return them in the plan's order."""
    number = {scene.kinds[cell]: kinds[cell] for cell in scene.kinds}
    derived = {(number[here], order, number.get(there, 0)) for here, order, there in scene.contexts}
    listed: list[Context] = []
    for entry in fields.mappings("contexts"):
        entry.only(("here", "order", "there"))
        here, there = (entry.whole(name, least=0, most=len(profiles) - 1) for name in ("here", "there"))
        listed.append((here, ORDERS.index(entry.text("order", among=ORDERS)), there))
    if len(set(listed)) != len(listed):
        ledger.refuse("rules.md 5, contexts", "a context is listed twice", "plan.json contexts")
    for contexts, text in ((derived - set(listed), "is missing"), (set(listed) - derived, "is none of the map's")):
        for here, order, there in sorted(contexts):
            name = f"{here} {ORDERS[order]} {there}"
            ledger.refuse("rules.md 5, contexts", f"context {name} {text}", "plan.json contexts")
    return tuple(listed)


def _compare_obstacles(fields: Fields, scene: Scene, ledger: Ledger) -> tuple[Cell, ...]:
    """Compare the obstacles' domains, speeds and starts, and how they are told apart; return the starts."""
    listed = fields.mappings("obstacles")
    if len(listed) != scene.obstacles:
        raise fields.wrong("obstacles", f"has to list the scenario's {scene.obstacles}")
    if fields.lists_of_wholes("kinds") != tuple(kind.members for kind in scene.obstacle_kinds):
        ledger.refuse("rules.md 4, kinds", "are not the scenario's", "plan.json kinds")
    starts: dict[int, Cell] = {}
    for kind in scene.obstacle_kinds:
        for number in kind.members:
            starts[number] = _compare_obstacle(listed[number], kind, number, scene, ledger)
    return tuple(starts[number] for number in range(scene.obstacles))


def _compare_obstacle(fields: Fields, kind: ObstacleKind, number: int, scene: Scene, ledger: Ledger) -> Cell:
    fields.only(("start", "domain", "speed_cells"))
    where, start = f"plan.json obstacles[{number}]", fields.cell("start")
    if set(fields.cells("domain")) != {scene.cell(index) for index in kind.domain}:
        ledger.refuse("rules.md 4, obstacle domain", "is not the scenario's", f"{where}.domain")
    if fields.whole("speed_cells") != kind.speed_cells:
        ledger.refuse("formats.md 1, obstacles", "is not the scenario's speed", f"{where}.speed_cells")
    if not scene.frame.holds(start, scene.scenario.obstacles[number].start_m):
        ledger.refuse("formats.md 1, obstacles", "does not hold the start position", f"{where}.start")
    if not scene.inside(start) or scene.index(start) not in kind.domain:
        raise fields.wrong("start", "is outside the obstacle's domain")
    return start


def _compare_belief(fields: Fields, scene: Scene, ledger: Ledger) -> Abstraction:
    """Compare the belief abstraction; regions that the planner chose may be any disjoint sets of free cells."""
    fields.only(("abstraction", "regions"))
    listed = fields.lists_of_cells("regions")
    if not all(cell in scene.kinds for cells in listed for cell in cells):
        raise fields.wrong("regions", "has to be lists of free cells")
    sets = [frozenset(scene.index(cell) for cell in cells) for cells in listed]
    found = Abstraction(fields.text("abstraction", among=tuple(METHODS)), tuple(sets))
    expected = abstraction_of(scene)
    if expected is None:
        if found.method != "regions" or sum(map(len, sets)) != len(frozenset().union(*sets)):
            text = "has to be regions that do not overlap"
            ledger.refuse("rules.md 4, belief abstraction", text, "plan.json belief")
    elif found != expected:
        ledger.refuse("rules.md 4, belief abstraction", "is not the scenario's", "plan.json belief")
    return found


def _compare_places(claims: Claims, moved_m: float, scene: Scene, ledger: Ledger) -> None:
    """Compare start and goals with the scenario's positions."""
    scenario = scene.scenario
    for cell, name in [(claims.start, "start"), *((goal, "goals") for goal in claims.goals)]:
        if cell not in scene.kinds:
            ledger.refuse("rules.md 1, free cells", f"cell {cell} is blocked", f"plan.json {name}")
    if not scene.frame.holds(claims.start, scenario.start_m) or claims.heading != scenario.start_heading:
        ledger.refuse("formats.md 1, start", "is not the scenario's start", "plan.json start")
    if abs(fine_distance_m(scene, claims.start, claims.fine, scenario.start_m) - moved_m) > TOLERANCE_M:
        ledger.refuse("formats.md 2, start", "is not the distance to the requested position", "plan.json start.moved_m")
    if len(claims.goals) != len(scenario.goals_m) or not all(
        scene.frame.holds(cell, point) for cell, point in zip(claims.goals, scenario.goals_m, strict=False)
    ):
        ledger.refuse("formats.md 1, goals", "are not the scenario's goals", "plan.json goals")


def _pair(values: float | tuple[float, ...]) -> tuple[float, float]:
    """Return two numbers of the walking block."""
    if not isinstance(values, tuple):
        raise TypeError(values)
    return values[0], values[1]
