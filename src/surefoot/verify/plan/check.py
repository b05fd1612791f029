"""Verifies a plan folder: the scene derived again, both strategies, and their composition."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from surefoot.errors import InputError
from surefoot.verify.artefacts import PlanFile, read_plan
from surefoot.verify.findings import Ledger
from surefoot.verify.navigation.belief import Obstacles
from surefoot.verify.navigation.claims import Claims, compare
from surefoot.verify.navigation.decisions import WAIT, Table, read_table
from surefoot.verify.navigation.liveness import check_liveness
from surefoot.verify.navigation.play import explore, start_decision
from surefoot.verify.navigation.true_product import check_true_obstacles
from surefoot.verify.plan.action import ActionTable, check_action, read_action_table, start_core
from surefoot.verify.plan.composition import check_composition, context_of
from surefoot.verify.scene.derived import Scene, derive_scene
from surefoot.verify.scene.scenario import read_scenario


@dataclass(frozen=True, slots=True)
class Opened:
    """A plan folder after its claims have been compared with the scene."""

    plan: PlanFile
    scene: Scene
    claims: Claims


def open_plan(folder: Path, ledger: Ledger) -> Opened:
    """Read a plan folder and its inputs, and compare what it claims with the scene that they describe."""
    plan = read_plan(folder)
    scenario = read_scenario(plan.scenario_path)
    try:
        scene = derive_scene(scenario)
    except InputError as problem:
        if problem.source is not None:
            raise
        raise InputError(problem.message, source=scenario.path, key=problem.key) from problem
    return Opened(plan, scene, compare(plan, scene, ledger))


def check_plan(folder: Path, ledger: Ledger) -> None:
    """Verify a plan folder.

    Raises:
        InputError: a file is missing, truncated, stale or malformed.
        LimitExceeded: a product is too large to be walked.
    """
    opened = open_plan(folder, ledger)
    scene, claims = opened.scene, opened.claims
    if ledger.total:
        return
    table = open_table(opened, ledger)
    action = read_action_table(opened.plan, claims, ledger)
    if table is None or action is None:
        return
    _check_games(scene, claims, table, action, ledger)


def open_table(opened: Opened, ledger: Ledger) -> Table | None:
    """Return the rows of a plan's navigation strategy; None when some are malformed."""
    obstacles = Obstacles(opened.scene, opened.claims.belief)
    source = opened.plan.path.parent / "navigation.npz"
    return read_table(opened.plan.navigation, source, obstacles, len(opened.claims.goals), ledger)


def _check_games(scene: Scene, claims: Claims, table: Table, action: ActionTable, ledger: Ledger) -> None:
    """Check both strategies; what builds on a closed play waits for one."""
    play = explore(scene, claims, start_decision(scene, claims, table.obstacles), table, ledger)
    ledger.counts["navigation_decisions"] = len(table.orders)
    ledger.counts["navigation_answers"] = len(play.successors)
    if play.closed:
        check_liveness(play, ledger)
        if claims.obstacles:
            check_true_obstacles(play, [scene.index(start) for start in claims.obstacles], ledger)
    order = int(table.orders[play.start]) if play.start >= 0 else -1
    first = context_of(scene, claims, scene.index(claims.start), order) if 0 <= order < 2 * WAIT else -1
    check_action(claims, action, [first] if first >= 0 else [], ledger)
    if play.closed:
        check_composition(scene, claims, play, action, start_core(claims), ledger)
