"""``surefoot plan``: from a scenario to a verified plan, or why there is none."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from surefoot.cli.output import AsJson, answer, facts, progress

if TYPE_CHECKING:
    from surefoot.missions.plans.planning import PlanAnswer

_HOW = "How the obstacles win; cells are (row, column) as in the picture that surefoot view SCENARIO draws:"


def plan(
    scenario: Annotated[Path, typer.Argument(help="The scenario, a YAML file.", show_default=False)],
    output: Annotated[Path, typer.Option("-o", "--output", help="The folder for the plan.")] = Path("plan"),
    time_limit_s: Annotated[
        float | None, typer.Option("--time-limit", min=0, help="Give up building and solving after so many seconds.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Plan a scenario: build its two games, solve them, verify the strategies, save them.

    The plan holds an answer to every move that the obstacles may make. When
    there is no such plan, the answer names the goal that fails and from where,
    shows a play in which the obstacles win, and no folder is left behind.

    Examples:
      surefoot plan my.yaml
      surefoot plan my.yaml -o plan/ --json
      surefoot plan my.yaml --time-limit 60

    Exit code 0: realizable and verified; 1: not realizable; 2: the scenario or
    the map cannot be used; 3: the time limit was reached.
    """
    from surefoot.missions.plans.planning import plan_mission

    with progress() as say:
        planned = plan_mission(scenario, output, say, time_limit_s)
    yes = planned.realizable and planned.verified
    answer(planned, plan_lines(planned), yes=yes, as_json=as_json)


def plan_lines(planned: PlanAnswer) -> list[str]:
    """Return what a person wants to know about a plan."""
    if not planned.realizable:
        play = [] if planned.play is None else [_HOW, *(f"  {line}" for line in planned.play.lines())]
        return ["Not realizable: no strategy wins.", f"  {planned.witness}", *play, *_notes(planned.notes)]
    head = f"Realizable{' and verified' if planned.verified else ', but NOT verified'}: {planned.out}"
    return [
        head,
        *facts(
            {
                "navigation states": planned.navigation_states,
                "action states": planned.action_states,
                "time to build [s]": planned.build_s,
                "time to solve [s]": planned.solve_s,
                "time in all [s]": planned.total_s,
                "peak memory [MB]": planned.peak_mb,
            }
        ),
        *_notes(planned.notes),
    ]


def _notes(notes: tuple[str, ...]) -> list[str]:
    return [f"  note: {note}" for note in notes]
