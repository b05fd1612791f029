"""``surefoot belief``: is belief necessary in a scenario?"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from surefoot.cli.output import AsJson, answer, progress

if TYPE_CHECKING:
    from surefoot.navigation import BeliefAnswer


def belief(
    scenario: Annotated[Path, typer.Argument(help="The scenario, a YAML file.", show_default=False)],
    turns: Annotated[int, typer.Option(min=1, max=10_000_000, help="Simulated turns for the throughput.")] = 20_000,
    seed: Annotated[int, typer.Option(min=0, help="Of the obstacles in them.")] = 0,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Draw both readings into this folder.", show_default=False)
    ] = None,
    time_limit_s: Annotated[
        float | None, typer.Option("--time-limit", min=0, help="Give up after so many seconds.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Tell what a scenario loses without belief: verdicts and goal visits.

    "Without belief" is one region over all free cells, in two ways: what the
    robot sees narrows it, or nothing does. Each is answered under the
    scenario's own rules and under the reading of the paper: the robot looks
    before it moves, grazed corners hide, every believed threat counts as an
    excuse to wait, and orders that force the obstacles to break their word
    are forbidden.

    Goal visits are those of the extracted strategies against random
    obstacles. A strategy is made to win, not to be quick: more knowledge can
    score worse (docs/navigation.md 5).

    Examples:
      surefoot belief scenes/two_rooms_mission.yaml
      surefoot belief my.yaml --turns 100000 -o pictures/ --json

    Exit code 0: with the scenario's belief it is realizable; 1: it is not;
    2: the scenario cannot be used; 3: a limit was reached.
    """
    from surefoot.compute import Deadline
    from surefoot.errors import LimitExceeded
    from surefoot.missions.scenario.scene import read_biped_scene
    from surefoot.navigation import belief_study, coarse_map

    with progress() as say:
        scene = read_biped_scene(scenario)
        corners_hide = coarse_map(scene.grid, scene.heights, scene.scenario.sensor.range_m, "hidden")
        say("solving the scenario with and without belief")
        answers = belief_study(scene.problem, corners_hide, turns, seed, Deadline.after(time_limit_s))
        pictures: tuple[Path, ...] = ()
        if output is not None:
            from surefoot.viewer.studies.belief import draw_belief_study

            say("drawing")
            pictures = draw_belief_study(scene, answers, output)
    value = {"answers": [_row(one) for one in answers], "pictures": pictures}
    if answers[0].realizable is None:
        raise LimitExceeded(answers[0].reason or "a limit was reached")
    answer(value, _lines(answers, pictures), yes=answers[0].realizable, as_json=as_json)


def _row(one: BeliefAnswer) -> dict[str, Any]:
    """Return an answer for the JSON object: all but the path."""
    played = one.throughput
    return {
        "reading": one.reading,
        "belief": one.belief,
        "realizable": one.realizable,
        "reason": one.reason,
        "decisions": one.decisions,
        "turns": one.turns,
        "simulated_turns": None if played is None else played.turns,
        "goal_visits": None if played is None else played.visits,
        "waits": None if played is None else played.waits,
        "longest_leg": None if played is None else played.longest_leg,
    }


def _lines(answers: tuple[BeliefAnswer, ...], pictures: tuple[Path, ...]) -> list[str]:
    """Return a table for a person."""
    lines = ["reading   belief      realizable  decisions     turns  goal visits  longest leg"]
    for one in answers:
        verdict = {True: "yes", False: "no", None: "unknown"}[one.realizable]
        played = one.throughput
        visits, leg = ("-", "-") if played is None else (str(played.visits), str(played.longest_leg))
        game = f"{one.reading:<8}  {one.belief:<10}  {verdict:<10}  {one.decisions:>9}  {one.turns:>8}"
        lines.append(f"{game}  {visits:>11}  {leg:>11}")
    lines += [f"  {one.reading}, {one.belief}: {one.reason}" for one in answers if one.reason]
    lines.append("  note: strategies are made to win, not to be quick; more knowledge can mean fewer goal visits")
    return [*lines, *(f"  picture: {path}" for path in pictures)]
