"""Offline: from a scenario to a verified plan folder (docs/formats.md, section 2)."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from surefoot import __version__
from surefoot.compute import Deadline, peak_memory_mb, sha256_of, write_text_whole
from surefoot.errors import CertificateRejected, InputError
from surefoot.frames import Cell, Direction
from surefoot.missions.biped_scene import BipedScene, read_biped_scene

Progress = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class PlanAnswer:
    """What planning found.

    Attributes:
        realizable: whether both games have winning strategies.
        navigation_states: nodes of the navigation game at which the obstacles move.
        action_states: states of the action game.
        build_s: time to build both games [s].
        solve_s: time to solve both games and extract the strategies [s].
        total_s: time of everything, verification included [s].
        peak_mb: largest resident size of the process [MB].
        verified: whether the independent checkers accepted the saved plan.
        witness: why the scenario is unrealizable, if it is.
        notes: what the user should know about the plan.
        out: the plan folder, None when there is none.
    """

    realizable: bool
    navigation_states: int
    action_states: int
    build_s: float
    solve_s: float
    total_s: float
    peak_mb: float
    verified: bool
    witness: str | None
    notes: tuple[str, ...]
    out: Path | None


def plan_mission(
    scenario_path: Path | str, out: Path | str, progress: Progress = lambda _: None, time_limit_s: float | None = None
) -> PlanAnswer:
    """Build both games of a scenario, solve them, verify the strategies and save them.

    Args:
        scenario_path: the scenario file.
        out: the plan folder; an older plan there is replaced, any other folder with content is refused.
        progress: is told what happens, a sentence at a time.
        time_limit_s: when to give up.

    Raises:
        InputError: if the scenario or its map cannot be used.
        LimitExceeded: if the time limit passes.
        CertificateRejected: if a checker refuses the plan; a bug of ours.
    """
    begin = time.perf_counter()
    scenario_path, out = Path(scenario_path), Path(out)
    deadline = Deadline.after(time_limit_s)
    _check_folder(out)
    progress("reading the scenario and its map")
    scene = read_biped_scene(scenario_path)
    return _solved(scene, out, progress, deadline, begin)


def _solved(scene: BipedScene, out: Path, progress: Progress, deadline: Deadline, begin: float) -> PlanAnswer:
    from surefoot.games import is_compiled, warm_up
    from surefoot.navigation import (
        Order,
        action_rules,
        build_action_game,
        build_navigation_game,
        order_context,
        solve_action,
        solve_navigation,
    )

    if not is_compiled():
        progress("compiling the solver (only the first run does; it takes some seconds)")
    warm_up()
    notes: list[str] = []
    clock = _Clock()
    progress("building the navigation game")
    with clock.building():
        game = build_navigation_game(scene.problem, deadline)
    progress(f"solving the navigation game ({game.turns} turns of the obstacles)")
    with clock.solving():
        verdict, navigation = solve_navigation(game, deadline)
    first = Order(scene.problem.heading, waits=True) if navigation is None else navigation.first_order()
    progress("building the action game")
    rules = action_rules(scene.coarse, scene.library)
    with clock.building():
        context = order_context(scene.coarse, scene.problem.start, first)
        action_game = build_action_game(rules, scene.problem.heading, context)
    progress(f"solving the action game ({action_game.states} states)")
    with clock.solving():
        row, column = _fine_place(scene)
        action_verdict, action, start = solve_action(action_game, row, column, deadline)
    witness = _witness(verdict.witness, action_verdict.witness)

    def answer(*, verified: bool, where: Path | None) -> PlanAnswer:
        return PlanAnswer(
            realizable=witness is None,
            navigation_states=game.turns,
            action_states=action_game.states,
            build_s=clock.build_s,
            solve_s=clock.solve_s,
            total_s=time.perf_counter() - begin,
            peak_mb=peak_memory_mb(),
            verified=verified,
            witness=witness,
            notes=tuple(notes),
            out=where,
        )

    if navigation is None or action is None or start is None:
        return answer(verified=False, where=None)
    if start.moved_cells > 1:
        moved_m = start.moved_cells * scene.walking.fine_cell_m
        notes.append(f"the robot stands {moved_m:.2f} m from the requested start, to keep clear of the cell's sides")
    document = _document(scene, rules, start, game.turns, action_game.states)
    arrays = {"navigation.npz": navigation.arrays(), "action.npz": action.arrays()}
    with _replaced_folder(out) as folder:
        progress("saving and verifying the plan")
        _save(folder, document, arrays)
        _verify(folder)
    return answer(verified=True, where=out)


class _Clock:
    """Adds up how long building and solving take."""

    def __init__(self) -> None:
        self.build_s = 0.0
        self.solve_s = 0.0

    @contextmanager
    def building(self) -> Iterator[None]:
        begin = time.perf_counter()
        yield
        self.build_s += time.perf_counter() - begin

    @contextmanager
    def solving(self) -> Iterator[None]:
        begin = time.perf_counter()
        yield
        self.solve_s += time.perf_counter() - begin


def _witness(navigation: Any, action: Any) -> str | None:
    parts = []
    if navigation is not None:
        parts.append(f"navigation game: {navigation.reason}")
    if action is not None:
        parts.append(f"action game: {action.reason}")
    return "; ".join(parts) or None


def _fine_place(scene: BipedScene) -> tuple[float, float]:
    """Return where in its coarse cell the robot is asked to stand, in fine (rows, columns)."""
    grid = scene.grid
    cell = grid.cell(scene.problem.start)
    east, north = (float(value) for value in grid.to_grid(scene.scenario.start.position_m))
    west = grid.north_west_m[0] + cell.column * grid.cell_size_m
    top = grid.north_west_m[1] - cell.row * grid.cell_size_m
    fine_m = scene.walking.fine_cell_m
    return (top - north) / fine_m, (east - west) / fine_m


def _document(scene: BipedScene, rules: Any, start: Any, navigation_states: int, action_states: int) -> dict[str, Any]:
    """Return the content of plan.json, without the paths and hashes of files."""
    grid, problem = scene.grid, scene.problem
    robot = scene.robot

    def cells(indices: Any) -> list[list[int]]:
        return [list(grid.cell(index)) for index in indices]

    return {
        "kind": "biped-plan",
        "format": 1,
        "surefoot": __version__,
        "made": datetime.now(UTC).isoformat(timespec="seconds"),
        "realizable": True,
        "grid": {
            "rows": grid.rows,
            "columns": grid.columns,
            "north_west_m": list(grid.north_west_m),
            "cell_size_m": grid.cell_size_m,
            "origin_m": list(grid.origin_m),
            "rotation_rad": grid.rotation_rad,
            "free": [list(cell) for cell in grid.free_cells()],
        },
        "walking": asdict(scene.walking),
        "robot": {
            "name": robot.name,
            "apex_height_m": robot.apex_height_m,
            "omega_radps": robot.omega_radps,
            "foot_radius_m": robot.foot_radius_m,
            "foot_half_length_m": robot.foot_half_length_m,
            "foot_half_width_m": robot.foot_half_width_m,
        },
        "profiles": [
            None
            if profile is None
            else {
                "up": profile.up.name.lower(),
                "heights_m": list(profile.heights_m),
                "gain_m": profile.gain_m,
                "admissible": list(profile.admissible),
            }
            for profile in scene.heights.profiles
        ],
        "contexts": [
            {"here": here, "order": "stop" if order == 4 else Direction(order).name.lower(), "there": there}
            for here, order, there in rules.contexts
        ],
        "start": {
            "cell": list(grid.cell(problem.start)),
            "heading": problem.heading.name.lower(),
            "fine": {"row": start.row, "column": start.column},
            "moved_m": start.moved_cells * scene.walking.fine_cell_m,
        },
        "goals": cells(problem.goals),
        "obstacles": [
            {"start": list(Cell(*grid.cell(cell))), "domain": cells(problem.domain.cells)}
            for cell in problem.obstacle_starts
        ],
        "statistics": {"navigation_states": navigation_states, "action_states": action_states},
        "inputs": {"scenario": scene.path, "map": scene.occupancy.path, "image": scene.occupancy.image_path},
    }


def _save(folder: Path, document: dict[str, Any], arrays: dict[str, dict[str, Any]]) -> None:
    from surefoot.navigation import save_arrays

    for name, content in arrays.items():
        save_arrays(folder / name, content)
    inputs = document.pop("inputs")
    document["scenario"] = reference(inputs["scenario"], folder)
    image = reference(inputs["image"], folder)
    document["map"] = {
        **reference(inputs["map"], folder),
        "image_path": image["path"],
        "image_sha256": image["sha256"],
    }
    document["files"] = {name: sha256_of(folder / name) for name in arrays}
    document["verified"] = True
    write_text_whole(folder / "plan.json", json.dumps(document, indent=1) + "\n")


def reference(path: Path, folder: Path) -> dict[str, str]:
    """Return path (relative to a folder) and hash of an input."""
    return {"path": os.path.relpath(path.resolve(), folder.resolve()), "sha256": sha256_of(path)}


def _verify(folder: Path) -> None:
    from surefoot.verify import verify_path

    report = verify_path(folder)
    if not report.accepted:
        first = report.findings[0]
        raise CertificateRejected(f"the plan was refused: {first.rule}: {first.message} ({first.where})")


def _check_folder(out: Path) -> None:
    """Refuse to plan into a folder that holds something else than an older plan."""
    if out.exists() and not out.is_dir():
        raise InputError("is a file; name a folder for the plan", source=out)
    if out.is_dir() and any(out.iterdir()) and not (out / "plan.json").is_file():
        raise InputError("is a folder with other content; name a new one or one with an older plan", source=out)


@contextmanager
def _replaced_folder(out: Path) -> Iterator[Path]:
    """Give a new folder beside ``out`` that takes its place when the block ends without an error."""
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        folder = Path(tempfile.mkdtemp(dir=out.parent, prefix=f".{out.name}."))
    except OSError as problem:
        raise InputError(f"cannot be written: {problem.strerror}", source=out) from problem
    try:
        yield folder
        folder.chmod(0o755)
        if out.exists():
            shutil.rmtree(out)
        folder.rename(out)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
