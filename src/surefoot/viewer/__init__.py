"""Pictures of scenarios, plans and runs, good enough for a paper, and pages that show them in motion."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from surefoot.errors import InputError

if TYPE_CHECKING:
    from surefoot.viewer.maps.answers import Asked

__all__ = [
    "view_answers",
    "view_bag",
    "view_folder",
    "view_page",
    "view_plan",
    "view_run",
    "view_scenario",
    "view_step",
]


def view_run(run_dir: Path, out: Path | None = None) -> tuple[Path, ...]:
    """Draw a run: the map with path and feet, the belief, the phase space, the keyframes.

    Args:
        run_dir: the folder of the run.
        out: where the pictures belong; None means the run's folder.

    Returns:
        The pictures that were written, PNG.

    Raises:
        InputError: if the run, its plan, scenario or map cannot be read.
    """
    from surefoot.viewer.runs import draw_run

    return draw_run(run_dir, run_dir if out is None else out)


def view_step(run_dir: Path, step: int, out: Path | None = None) -> tuple[Path, ...]:
    """Draw one step of a run: its phase plane, with a push if there was one, and the action strategy around it.

    Args:
        run_dir: the folder of the run.
        step: number of the step, counted from 0.
        out: the folder for the picture; None means the run's folder.
    """
    from surefoot.viewer import kinds
    from surefoot.viewer.steps.pushed import draw_step

    kinds.demand(run_dir, "--step")
    return draw_step(run_dir, step, run_dir if out is None else out)


def view_plan(plan_dir: Path, out: Path | None = None) -> tuple[Path, ...]:
    """Draw a plan: its grid, start, goals, where obstacles may be, belief regions, stairs; and a play of its strategy.

    Args:
        plan_dir: the folder of the plan.
        out: the folder for the pictures; None means the plan's folder.
    """
    from surefoot.viewer.maps.plans import draw_plan

    return draw_plan(plan_dir, plan_dir if out is None else out)


def view_answers(plan_dir: Path, asked: Asked, out: Path | None = None) -> tuple[Path, ...]:
    """Draw what a plan's strategy does in one robot state, a small map for everything it may know of the obstacles.

    Args:
        plan_dir: the folder of the plan.
        asked: the robot state.
        out: the folder for the picture; None means the current folder.
    """
    from surefoot.viewer import kinds
    from surefoot.viewer.maps.answers import draw_answers

    kinds.demand(plan_dir, "--cell")
    return draw_answers(plan_dir, asked, Path() if out is None else out)


def view_scenario(scenario: Path, out: Path | None = None) -> tuple[Path, ...]:
    """Draw a scenario: the same as for a plan, before there is one.

    Args:
        scenario: the scenario file.
        out: the folder for the picture; None means beside the scenario.
    """
    from surefoot.viewer.maps.plans import draw_scenario

    return draw_scenario(scenario, scenario.parent if out is None else out)


def view_page(path: Path, out: Path, body: str | None = None, say: Callable[[str], None] | None = None) -> Path:
    """Write a run, a foothold plan or a strategy as one page that opens from a file, without a network.

    Args:
        path: the folder of the run or of the plan, or the file of the foothold plan.
        out: the HTML file.
        body: ``simple`` or ``meshes``; None takes the robot's own meshes if they are installed.
        say: is told what is drawn otherwise than it was planned.

    Returns:
        The HTML file.

    Raises:
        InputError: if it cannot be read, or holds nothing that moves.
        BackendMissing: if viser is not installed, or meshes are asked for and are not.
    """
    from surefoot.viewer import kinds
    from surefoot.viewer.pages.gr1 import write_gr1_page, write_gr1_ranking_page
    from surefoot.viewer.pages.replay import write_motion
    from surefoot.viewer.remarks import silent
    from surefoot.viewer.robots.bodies import Body

    kind = kinds.demand(path, "--html")
    if kind in (kinds.STRATEGY, kinds.RANKING):
        if body is not None:
            raise InputError("--body belongs to runs and foothold plans; a strategy is shown without a robot")
        return (write_gr1_page if kind is kinds.STRATEGY else write_gr1_ranking_page)(path, out)
    return write_motion(path, out, None if body is None else Body(body), say or silent)


def view_bag(path: Path, out: Path, say: Callable[[str], None] | None = None) -> Path:
    """Write a run or a foothold plan as an MCAP file of ROS 2 messages.

    Args:
        path: the folder of the run, or the file of the foothold plan.
        out: the MCAP file.
        say: is told what is recorded otherwise than it was planned.

    Returns:
        The MCAP file.

    Raises:
        InputError: if it cannot be read, or holds nothing that moves.
        BackendMissing: if the packages that write it are not installed.
    """
    from surefoot.viewer import kinds

    if kinds.demand(path, "--mcap") in (kinds.FOOTHOLDS, kinds.QUADRUPED_RUN):
        from surefoot.viewer.bags.footholds import write_foothold_bag
        from surefoot.viewer.remarks import silent

        return write_foothold_bag(path, out, say or silent)
    from surefoot.viewer.bags.run import write_run_bag

    return write_run_bag(path, out)


def view_folder(path: Path, out: Path | None = None) -> tuple[Path, ...]:
    """Draw whatever stands at a path: a run, a plan, a scenario, ground, footholds, the regions of a step, a library.

    Args:
        path: the folder or the file.
        out: the folder for the pictures; None means beside what is drawn.

    Raises:
        InputError: if it cannot be read, or has no pictures.
    """
    from surefoot.viewer import kinds, single

    kind = kinds.demand(path, "")
    beside = (path if path.is_dir() else path.parent) if out is None else out
    if kind in (kinds.BIPED_RUN, kinds.QUADRUPED_RUN):
        return view_run(path, beside)
    if kind is kinds.PLAN:
        return view_plan(path, beside)
    if kind is kinds.SCENARIO:
        return view_scenario(path, beside)
    draw = {
        kinds.LIBRARY: single.draw_library,
        kinds.FOOTHOLDS: single.draw_footholds,
        kinds.REGIONS: single.draw_regions,
        kinds.QUADRUPED_TERRAIN: single.draw_ground,
        kinds.TERRAIN: single.draw_ground,
    }[kind]
    return draw(path, beside)
