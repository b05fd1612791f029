"""``surefoot run``: walk a planned mission against an obstacle."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from surefoot.cli.output import AsJson, answer, facts, progress
from surefoot.cli.watching import watched
from surefoot.errors import InputError

if TYPE_CHECKING:
    from surefoot.missions.biped.mission import RunAnswer

_FINDINGS = 5
_BIPED = ("plan", "steps", "seed", "obstacle", "script", "pushes", "push_size", "push_side_size", "push_rate")
_QUADRUPED = ("library", "start", "goal", "classes", "events", "delay", "joint_reach")


class Obstacle(StrEnum):
    """Who moves the obstacles."""

    RANDOM = "random"
    ADVERSARIAL = "adversarial"
    SCRIPTED = "scripted"


def run(
    context: typer.Context,
    scenario: Annotated[
        Path, typer.Argument(help="The scenario, a YAML file; of a quadruped: its terrain.", show_default=False)
    ],
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
    library: Annotated[
        Path | None, typer.Option(help="Of a quadruped: the folder of its skills; default: none are made yet.")
    ] = None,
    start: Annotated[
        str | None, typer.Option(metavar="X,Y", help="Of a quadruped: where it starts, if the file does not say.")
    ] = None,
    goal: Annotated[
        str | None, typer.Option(metavar="X,Y", help="Of a quadruped: where it is to go, if the file does not say.")
    ] = None,
    classes: Annotated[
        str | None, typer.Option(help="Of a quadruped on a segmented terrain: classes; default: unstructured-8.")
    ] = None,
    events: Annotated[Path | None, typer.Option(help="Of a quadruped: what happens to its world, a YAML file.")] = None,
    delay: Annotated[
        str | None, typer.Option(metavar="S,...", help="Of a quadruped: seconds added to planning, in turns.")
    ] = None,
    joint_reach: Annotated[
        bool, typer.Option("--joint-reach", help="Of a quadruped: keep feet where its legs reach, by their joints.")
    ] = False,
    output: Annotated[Path, typer.Option("-o", "--output", help="The folder for the run.")] = Path("run"),
    view: Annotated[
        bool, typer.Option("--view", help="Show it in the browser, while it walks and until Ctrl-C.")
    ] = False,
    port: Annotated[
        int | None, typer.Option(min=1024, max=65535, help="Of --view: listen there; default: any free port.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Walk a planned mission, log every step and verify the log.

    Examples:
      surefoot run my.yaml --plan plan/
      surefoot run my.yaml --steps 500 --seed 7 --obstacle adversarial -o run/
      surefoot run my.yaml --obstacle scripted --script guard.yaml --json
      surefoot run my.yaml --pushes random --push-size 0.1 --push-rate 0.2
      surefoot run my.yaml --view --port 8080
      surefoot run terrain.yaml --library library/ -o run/
      surefoot run scan.json --start 0.4,0 --goal 4,0 --events events.yaml

    The scenario of a quadruped is its terrain: a terrain file, or what
    `surefoot terrain segment` wrote. Skills that its library lacks are looked
    for on the way. Its events are a YAML file (docs/formats.md 12):
      format: 1
      kind: quadruped-events
      events:
      - {at_segment: 3, obstacle_m: [[2.4, 1.6], [3.2, 2.4]]}
      - {at_s: 9, hole_m: [[4.1, 0.0], [4.4, 0.8]]}
      - {at_segment: 6, push_m: [0.8, 0.0]}

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

    A leg leads from one goal to the next: direct, as a loop (more moves than
    the shortest way), or with a wait. A decision is an order of the navigation
    strategy, a turn a quarter turn of the robot.

    Exit code 0: every goal was reached, nothing collided, no step was unsafe,
    no push made the robot fall, and the log is verified; 1: not so, and why;
    2: the input cannot be used, such as a plan that was made for another
    scenario.
    """
    from surefoot.cli.run_quadruped import answer_quadruped, is_quadruped, place

    quadruped = is_quadruped(scenario)
    _refuse_others(context, _BIPED if quadruped else _QUADRUPED, "biped" if quadruped else "quadruped")
    if quadruped:
        from surefoot.missions.quadruped.crossing import OnlineLimits
        from surefoot.missions.quadruped.mission import QuadrupedOrder

        ends, limits = (place(start, "--start"), place(goal, "--goal")), OnlineLimits(joint_reach=joint_reach)
        order = QuadrupedOrder(scenario, library, *ends, events=events, delay=delay, classes=classes, limits=limits)
        with watched(output, port, wanted=view):
            answer_quadruped(order, output, as_json=as_json)
    if (script is not None) != (obstacle is Obstacle.SCRIPTED):
        raise InputError("--script FILE and --obstacle scripted belong together; give both or neither")
    from surefoot.missions.biped.mission import run_mission
    from surefoot.missions.pushes.source import push_source

    sizes = {"size_mps": push_size, "side_size_mps": push_side_size, "rate": push_rate}
    source = push_source(pushes, seed, {name: value for name, value in sizes.items() if value is not None})
    with watched(output, port, wanted=view):
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
        answer(walked, run_lines(walked, pushed=source is not None), yes=walked.succeeded, as_json=as_json)


def _refuse_others(context: typer.Context, names: tuple[str, ...], of: str) -> None:
    """Refuse options of the other kind of robot, which would do nothing."""
    for name in names:
        source = context.get_parameter_source(name)
        if source is not None and source.name != "DEFAULT":
            raise InputError(f"is an option of a {of}'s mission only", key=f"--{name.replace('_', '-')}")


def run_lines(walked: RunAnswer, *, pushed: bool = False) -> list[str]:
    """Return what a person wants to know about a run, and about its pushes if somebody was to push."""
    head = "The mission was reached" if walked.succeeded else "The mission was NOT reached"
    return [
        f"{head}: {walked.out}",
        *(f"  {failure}" for failure in walked.failures),
        *facts(
            {
                "walking steps": walked.steps,
                "decisions": walked.decisions,
                "turns": walked.turns,
                "goals reached": walked.goals_reached,
                **{f"legs: {name}": legs for name, legs in walked.reactions.items()},
                "collisions": walked.collisions,
                "belief violations": walked.belief_violations,
                "assumptions seen broken": walked.assumption_violations,
                "plans made again": walked.replans,
                "unsafe steps": walked.unsafe_steps,
                "waypoint corrections": walked.waypoint_corrections,
                **(_push_lines(walked) if pushed else {}),
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
    """Return what became of the pushes."""
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
