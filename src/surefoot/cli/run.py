"""``surefoot run``: walk a planned mission against an obstacle."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from surefoot.cli.output import AsJson, answer, facts, progress
from surefoot.errors import InputError

if TYPE_CHECKING:
    from surefoot.missions.biped import RunAnswer

_FINDINGS = 5


class Obstacle(StrEnum):
    """Who moves the obstacles."""

    RANDOM = "random"
    ADVERSARIAL = "adversarial"
    SCRIPTED = "scripted"


def run(
    scenario: Annotated[Path, typer.Argument(help="The scenario, a YAML file.", show_default=False)],
    plan: Annotated[Path, typer.Option("-p", "--plan", help="The folder of its plan.")] = Path("plan"),
    steps: Annotated[int, typer.Option("-n", "--steps", min=1, max=10_000_000, help="How many walking steps.")] = 500,
    seed: Annotated[int, typer.Option(min=0, help="Seed of whatever is random; the same seed, the same run.")] = 0,
    obstacle: Annotated[
        Obstacle, typer.Option(help="How obstacles move: at random, to block and hunt the robot, or as a file says.")
    ] = Obstacle.RANDOM,
    script: Annotated[
        Path | None, typer.Option(help="Where scripted obstacles are after each turn: a YAML file.")
    ] = None,
    pushes: Annotated[
        str | None, typer.Option(help="Push the robot: a YAML file that lists the pushes, or the word random.")
    ] = None,
    push_size: Annotated[
        float | None, typer.Option(help="Largest random jump of speed along the heading [m/s]; 0.2 by default.")
    ] = None,
    push_side_size: Annotated[
        float | None, typer.Option(help="Largest random jump of speed sideways [m/s]; 0.05 by default.")
    ] = None,
    push_rate: Annotated[
        float | None, typer.Option(help="Share of the steps that are pushed at random; 0.1 by default.")
    ] = None,
    output: Annotated[Path, typer.Option("-o", "--output", help="The folder for the run.")] = Path("run"),
    as_json: AsJson = False,
) -> None:
    """Walk a planned mission, log every step and verify the log.

    Examples:
      surefoot run my.yaml --plan plan/
      surefoot run my.yaml --steps 500 --seed 7 --obstacle adversarial -o run/
      surefoot run my.yaml --obstacle scripted --script guard.yaml --json
      surefoot run my.yaml --pushes random --push-size 0.1 --push-rate 0.2

    A script is a YAML file that says where an obstacle is after turn 0, after
    turn 1, and so on, in metres of the map; afterwards it stays there. In one
    turn it makes as many moves to neighbouring cells as its speed allows:
      format: 1
      kind: obstacle-script
      positions_m: [[9.5, 6.8], [9.5, 9.5], [9.5, 9.5], [12.2, 9.5]]
    With several obstacles positions_m holds one such list for each of them;
    with `repeat: true` the lists begin again after their ends; with
    `breaks_assumptions: true` obstacles go wherever the lists say, and the
    robot has to notice, stop and plan again.

    A push is a jump of the velocity of the centre of mass, ahead and to the
    left, at a share of a step; a file lists at most one for each step:
      format: 1
      kind: push-script
      pushes: [{step: 12, instant: 0.4, sagittal_mps: 0.2, lateral_mps: 0.05}]

    Exit code 0: every goal was reached, nothing collided, no step was unsafe,
    no push made the robot fall, and the log is verified; 1: not so; 2: the input cannot be used, such as a
    plan that was made for another scenario.
    """
    if (script is not None) != (obstacle is Obstacle.SCRIPTED):
        raise InputError("--script FILE and --obstacle scripted belong together; give both or neither")
    from surefoot.missions.biped import run_mission
    from surefoot.missions.pushes import push_source

    sizes = {"size_mps": push_size, "side_size_mps": push_side_size, "rate": push_rate}
    source = push_source(pushes, seed, {name: value for name, value in sizes.items() if value is not None})
    with progress() as say:
        walked = run_mission(
            scenario,
            plan,
            steps=steps,
            seed=seed,
            obstacle=obstacle.value,
            script=script,
            pushes=source,
            out=output,
            progress=say,
        )
    answer(walked, run_lines(walked), yes=walked.succeeded, as_json=as_json)


def run_lines(walked: RunAnswer) -> list[str]:
    """Return what a person wants to know about a run."""
    head = "The mission was reached" if walked.succeeded else "The mission was NOT reached"
    return [
        f"{head}: {walked.out}",
        *facts(
            {
                "walking steps": walked.steps,
                "turns": walked.turns,
                "goals reached": walked.goals_reached,
                "legs straight, around to see, with waits": tuple(walked.reactions.values()),
                "collisions": walked.collisions,
                "belief violations": walked.belief_violations,
                "assumptions seen broken": walked.assumption_violations,
                "plans made again": walked.replans,
                "unsafe steps": walked.unsafe_steps,
                "waypoint corrections": walked.waypoint_corrections,
                **_push_lines(walked),
                "share of alternating signs": walked.sign_alternation_share,
                "planning a step, mean [ms]": walked.plan_ms_mean,
                "planning a step, 95 % below [ms]": walked.plan_ms_p95,
                "log verified": walked.verified,
            }
        ),
        *finding_lines(walked),
        *(f"  note: {note}" for note in walked.notes),
    ]


def _push_lines(walked: RunAnswer) -> dict[str, object]:
    """Return what became of the pushes, if there were any."""
    if not walked.pushes:
        return {}
    return {
        "pushes": walked.pushes,
        "recovered in the region": walked.recovered_in_region,
        "recovered by a step": walked.recovered_by_step,
        "falls": walked.falls,
    }


def finding_lines(walked: RunAnswer) -> list[str]:
    """Return the first reasons why the log was not verified, and how many more there are."""
    if walked.verified:
        return []
    more = len(walked.findings) - _FINDINGS
    return [
        *(f"  not verified: {finding}" for finding in walked.findings[:_FINDINGS]),
        *([f"  and {more} more; all of them: surefoot verify {walked.out}"] if more > 0 else []),
    ]
