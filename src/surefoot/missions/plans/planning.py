"""Offline: from a scenario to a verified plan folder (docs/formats.md, section 2)."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from surefoot.compute import Deadline, peak_memory_mb
from surefoot.errors import CertificateRejected
from surefoot.missions.plans.trial import WALKS, Trial, needs_trial, trial_walks
from surefoot.missions.plans.writer import check_plan_folder, replaced_plan_folder, write_plan
from surefoot.missions.scenario.scene import BipedScene, read_biped_scene
from surefoot.navigation import (
    ActionRules,
    ActionStrategy,
    FineStart,
    NavigationStrategy,
    Order,
    Unrealizable,
    action_rules,
    build_action_game,
    build_navigation_game,
    order_context,
    solve_action,
    solve_navigation,
)
from surefoot.navigation.obstacle_play import Play
from surefoot.verdict import Verdict

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
        play: how the obstacles keep the robot from its goals, turn by turn, if they can.
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
    play: Play | None
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
    check_plan_folder(out)
    progress("reading the scenario and its map")
    scene = read_biped_scene(scenario_path)
    return _solved(scene, out, progress, deadline, begin)


def _solved(scene: BipedScene, out: Path, progress: Progress, deadline: Deadline, begin: float) -> PlanAnswer:
    """Solve both games, and save and verify the plan if they are won."""
    from surefoot.games import is_compiled, warm_up

    if not is_compiled():
        progress(_first_use("compiling the solver"))
    warm_up()
    clock = _Clock()
    navigation_states, navigation_verdict, navigation = _navigation(scene, clock, progress, deadline)
    first = Order(scene.problem.heading, waits=True) if navigation is None else navigation.first_order()
    rules = action_rules(scene.coarse, scene.library)
    action_states, action_verdict, action, start = _action(scene, rules, first, clock, progress, deadline)
    notes: list[str] = []
    if navigation is not None and action is not None and start is not None:
        notes += _start_notes(scene, start)
        if needs_trial(scene):
            progress("trying the walking numbers out")
            context = rules.contexts.index(order_context(scene.coarse, scene.problem.start, first))
            notes += _trial_notes(trial_walks(scene, rules, action, start, context))
        with replaced_plan_folder(out) as folder:
            progress(_work("saving and verifying the plan", "verify/plan/composition.py", "_walk"))
            statistics = {"navigation_states": navigation_states, "action_states": action_states}
            write_plan(folder, scene, rules, navigation, action, start, statistics)
            _verify(folder)
    else:
        notes += _older_note(out)
    reasons = [
        verdict.witness.reason for verdict in (navigation_verdict, action_verdict) if verdict.witness is not None
    ]
    return PlanAnswer(
        realizable=not reasons,
        navigation_states=navigation_states,
        action_states=action_states,
        build_s=clock.build_s,
        solve_s=clock.solve_s,
        total_s=time.perf_counter() - begin,
        peak_mb=peak_memory_mb(),
        verified=not reasons,
        witness="; ".join(reasons) or None,
        play=None if navigation_verdict.witness is None else navigation_verdict.witness.play,
        notes=tuple(notes),
        out=None if reasons else out,
    )


def _older_note(out: Path) -> list[str]:
    """Return that an older plan stays where the new one was to be, if so."""
    if not (out / "plan.json").is_file():
        return []
    return [f"the older plan in {out} was left as it is; it is not a plan of this scenario as it stands"]


def _navigation(
    scene: BipedScene, clock: _Clock, progress: Progress, deadline: Deadline
) -> tuple[int, Verdict[Unrealizable], NavigationStrategy | None]:
    """Return the size of the navigation game, its verdict and its strategy."""
    progress(_work("building the navigation game", "navigation/_game_kernels.py", "explore"))
    with clock.building():
        game = build_navigation_game(scene.problem, deadline)
    progress(f"solving the navigation game ({game.turns} turns of the obstacles)")
    with clock.solving():
        return game.turns, *solve_navigation(game, deadline)


def _action(
    scene: BipedScene, rules: ActionRules, first: Order, clock: _Clock, progress: Progress, deadline: Deadline
) -> tuple[int, Verdict[Unrealizable], ActionStrategy | None, FineStart | None]:
    """Return the size of the action game, its verdict, its strategy, and where the robot stands at the start."""
    progress(_work("building the action game", "navigation/_action_graph.py", "explore"))
    with clock.building():
        context = order_context(scene.coarse, scene.problem.start, first)
        game = build_action_game(rules, scene.problem.heading, context)
    progress(f"solving the action game ({game.states} states)")
    with clock.solving():
        return game.states, *solve_action(game, *_fine_place(scene), deadline)


def _work(what: str, source: str, kernel: str) -> str:
    """Return what is done, and that it is compiled before, where its largest compiled function is not kept yet."""
    from surefoot.games import is_kept

    kept = is_kept(Path(__file__).parents[2] / source, (kernel,))
    return what if kept else _first_use(f"compiling, then {what}")


def _first_use(what: str) -> str:
    return f"{what} (only the first run compiles; it takes some seconds)"


def _start_notes(scene: BipedScene, start: FineStart) -> list[str]:
    if start.moved_cells <= 1:
        return []
    moved_m = start.moved_cells * scene.walking.fine_cell_m
    return [f"the robot stands {moved_m:.2f} m from the requested start, where it can carry out its first order"]


def _trial_notes(trial: Trial) -> list[str]:
    if not trial.unsafe:
        return []
    return [
        f"the games are won, but in {trial.unsafe} of {WALKS} trial walks no safe step was left after a while "
        f"({trial.reason}): these step lengths, treads or bounds do not walk safely for ever"
    ]


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


def _fine_place(scene: BipedScene) -> tuple[float, float]:
    """Return where in its coarse cell the robot is asked to stand, in fine (rows, columns)."""
    grid = scene.grid
    cell = grid.cell(scene.problem.start)
    east, north = (float(value) for value in grid.to_grid(scene.scenario.start.position_m))
    west = grid.north_west_m[0] + cell.column * grid.cell_size_m
    top = grid.north_west_m[1] - cell.row * grid.cell_size_m
    fine_m = scene.walking.fine_cell_m
    return (top - north) / fine_m, (east - west) / fine_m


def _verify(folder: Path) -> None:
    from surefoot.verify import verify_path

    report = verify_path(folder)
    if not report.accepted:
        first = report.findings[0]
        raise CertificateRejected(f"the plan was refused: {first.rule}: {first.message} ({first.where})")
