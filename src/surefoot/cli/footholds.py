"""``surefoot footholds``: footholds, forces, base motion and, if it is free, the gait; or a proof of infeasibility."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from surefoot.cli.failures import ExitCode
from surefoot.cli.output import PICTURES, AsJson, answer, apart, facts, jsonable, to_write

if TYPE_CHECKING:
    from surefoot.footholds import FreeAnswer, Problem, Solution

app = typer.Typer(help="Footholds for a gait: solve, retarget, animate, print the schema.", rich_markup_mode="rich")

_ProblemFile = Annotated[
    Path, typer.Argument(metavar="PROBLEM", help="A problem file, YAML or JSON.", show_default=False)
]


@app.command("solve")
def solve(
    problem: _ProblemFile,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", callback=to_write(".json"), help="The plan file to write.")
    ] = None,
    plot: Annotated[
        Path | None, typer.Option("--plot", callback=to_write(*PICTURES), help="A picture (PNG) to draw.")
    ] = None,
    time_limit_s: Annotated[
        float | None, typer.Option("--time-limit", min=1e-3, max=86400, help="Overrides the file's, in seconds.")
    ] = None,
    moved: Annotated[
        bool, typer.Option("--retarget", help="Move the goal to the nearest feasible stance first.")
    ] = False,
    gap: Annotated[float | None, typer.Option("--gap", min=1e-9, max=0.99, help="Overrides the file's.")] = None,
    first: Annotated[bool, typer.Option("--first", help="Stop at the first plan.")] = False,
    gait: Annotated[
        Path | None,
        typer.Option(
            "--gait", callback=to_write(), help="A gait file to write, as OCS2 users read it.", show_default=False
        ),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Find the best footholds, forces and base motion, or prove that there are none.

    Examples:
      surefoot footholds solve problem.yaml -o plan.json --plot plan.png
      surefoot footholds solve problem.yaml --json
      surefoot footholds solve leap.yaml --gait leap.info

    With `gait: free` in the problem the gait is found too: the search goes on
    until the time limit, or until the gap to a bound over all gaits is small
    enough; --first takes the first plan.

    Exit code 0: feasible; 1: infeasible, with the reason; 2: the problem file
    cannot be used; 3: unknown, a limit was reached.
    """
    from dataclasses import replace

    from surefoot.footholds import read_problem, retargeted, write_plan
    from surefoot.footholds import retarget as retarget_goal
    from surefoot.footholds import solve as solve_problem

    apart(problem, output, gait)
    read = read_problem(problem)
    if time_limit_s is not None:
        read = replace(read, options=replace(read.options, time_limit_s=time_limit_s))
    if gap is not None:
        read = replace(read, options=replace(read.options, gap=gap))
    if first:
        read = replace(read, options=replace(read.options, first_plan=True))
    if moved:
        found = retarget_goal(read)
        read = retargeted(read, found) if found.position_m is not None else read
    solution = solve_problem(read)
    if output is not None:
        write_plan(output, read, solution)
    if gait is not None:
        _write_gait(gait, read, solution)
    if plot is not None:
        from surefoot.footholds.plan_file import plan_document
        from surefoot.viewer.terrain.footholds import draw_plan

        draw_plan(plan_document(read, solution, plot.parent), plot)
    _say(read, solution, as_json=as_json)


def _write_gait(path: Path, problem: Problem, solution: Solution) -> None:
    """Write the gait that was found, or that was given; nothing without a plan."""
    from surefoot.compute import write_text_whole
    from surefoot.footholds import Gait
    from surefoot.footholds.gaits import gait_text

    gait = problem.gait if solution.free is None else solution.free.gait
    if solution.plan is not None and isinstance(gait, Gait):
        write_text_whole(path, gait_text(gait))


def _say(problem: Problem, solution: Solution, *, as_json: bool) -> None:
    from surefoot.footholds.plan_file import answer_of, values_of

    value = {**answer_of(solution), "values": values_of(problem)}
    lines = _lines(solution)
    if solution.verdict == "unknown":
        print(json.dumps(jsonable(value)) if as_json else "\n".join(lines))
        raise typer.Exit(int(ExitCode.UNKNOWN))
    answer(value, lines, yes=solution.verdict == "feasible", as_json=as_json)


def _lines(solution: Solution) -> list[str]:
    shown: dict[str, Any] = {}
    if solution.plan is not None:
        shown = {
            "objective": solution.objective,
            "bound": "none" if solution.bound is None else solution.bound,
            "gap": "none" if solution.gap is None else solution.gap,
            "gap without gravity": "none" if solution.net_gap is None else solution.net_gap,
            "worst residual": solution.max_residual,
        }
    if solution.free is not None:
        shown |= _free_facts(solution.free)
    shown |= {"time to solve [ms]": solution.solve_ms, "time to certify [ms]": solution.certify_ms}
    shown |= {"convex programs": solution.nodes, "certificate": solution.certificate}
    head = solution.verdict.capitalize() + (f" ({solution.limit})" if solution.limit else "")
    why = [f"  because: {lack.text}" for lack in solution.explanation.lacks[:4]] if solution.explanation else []
    return [head, *why, *facts(shown), *(f"  note: {note}" for note in solution.notes)]


def _free_facts(free: FreeAnswer) -> dict[str, Any]:
    shown: dict[str, Any] = {"gaits tried": free.templates_tried}
    if free.gait is not None:
        shown |= {"gait": " ".join(free.gait.modes), "switching times [s]": list(free.gait.switching_times_s)}
        shown |= {"proposed by": free.origin, "first plan after [s]": free.first_feasible_s}
    return shown


@app.command("retarget")
def retarget(problem: _ProblemFile, as_json: AsJson = False) -> None:
    """Find the standing pose nearest to the goal in which all feet are on polygons.

    The orientation stays; the base moves by at most 15, 10 and 10 cm.

    Examples:
      surefoot footholds retarget problem.yaml

    Exit code 0: found; 1: there is none; 2: the problem file cannot be used.
    """
    from surefoot.footholds import read_problem
    from surefoot.footholds import retarget as find

    found = find(read_problem(problem), why=True)
    shown: dict[str, Any] = {}
    if found.position_m is not None and found.feet_m is not None:
        shown = {"position [m]": found.position_m.tolist(), "moved [m]": found.shift_m, "polygons": found.polygons}
    why = [f"  because: {found.reason}"] if found.reason else []
    lines = [found.verdict.capitalize(), *why, *facts({**shown, "time to solve [ms]": found.solve_ms})]
    answer(found, lines, yes=found.verdict == "feasible", as_json=as_json)


@app.command("animate")
def animate(
    plan: Annotated[Path, typer.Argument(metavar="PLAN", help="A plan file.", show_default=False)],
    output: Annotated[
        Path, typer.Option("-o", "--output", callback=to_write(".gif"), help="The animation (GIF) to write.")
    ] = Path("plan.gif"),
    as_json: AsJson = False,
) -> None:
    """Animate a plan: terrain, base, feet and forces over time.

    Examples:
      surefoot footholds animate plan.json -o plan.gif
    """
    from surefoot.viewer.terrain.footholds import animate_plan

    frames = animate_plan(plan, output)
    answer(
        {"animation": str(output), "frames": frames}, [f"Wrote {output} ({frames} frames)"], yes=True, as_json=as_json
    )


@app.command("schema")
def schema(as_json: AsJson = False) -> None:
    """Print the JSON Schema of a problem file (for editors and for other programs).

    Examples:
      surefoot footholds schema > problem.schema.json
    """
    from surefoot.footholds import problem_schema

    printed = problem_schema()
    answer(printed, json.dumps(printed, indent=2).splitlines(), yes=True, as_json=as_json)
