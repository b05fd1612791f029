"""``surefoot demo``: the two-room scene of the paper, planned, walked and drawn."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from surefoot.cli.output import AsJson, answer, progress
from surefoot.cli.plan import plan_lines
from surefoot.cli.run import run_lines


def demo(
    output: Annotated[Path, typer.Option("-o", "--output", help="The folder for everything.")] = Path("demo"),
    steps: Annotated[int, typer.Option("-n", "--steps", min=1, help="How many walking steps.")] = 500,
    seed: Annotated[int, typer.Option(min=0, help="Seed of whatever is random.")] = 7,
    as_json: AsJson = False,
) -> None:
    """Plan and walk a two-room scene with stairs and an obstacle that hides, and draw what happened.

    Examples:
      surefoot demo
      surefoot demo -o demo/ --steps 200 --seed 3
    """
    from surefoot.missions.biped.mission import run_mission
    from surefoot.missions.plans.planning import plan_mission
    from surefoot.missions.scenario.shipped import copy_scene
    from surefoot.viewer import view_folder

    with progress() as say:
        scenario = copy_scene("two_rooms", output)
        planned = plan_mission(scenario, output / "plan", say)
        if not planned.realizable:
            answer({"plan": planned}, plan_lines(planned), yes=False, as_json=as_json)
        walked = run_mission(
            scenario,
            output / "plan",
            steps=steps,
            seed=seed,
            obstacle="adversarial",
            script=None,
            out=output / "run",
            progress=say,
        )
        say("drawing")
        pictures = (*view_folder(output / "plan", None), *view_folder(output / "run", None))
    lines = [*plan_lines(planned), *run_lines(walked), "Open these:", *(f"  {picture}" for picture in pictures)]
    yes = planned.verified and walked.succeeded
    answer({"plan": planned, "run": walked, "pictures": pictures}, lines, yes=yes, as_json=as_json)
