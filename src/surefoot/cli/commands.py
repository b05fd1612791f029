"""The tree of commands."""

from __future__ import annotations

from typing import Annotated

import typer

from surefoot.cli import (
    baselines,
    belief,
    bench,
    demo,
    doctor,
    explain,
    export,
    footholds,
    plan,
    reach,
    run,
    scenario,
    simulate,
    skills,
    skills_terrain,
    synth,
    terrain,
    verify,
    view,
)

_HELP = """Plans for legged robots that provably neither fall nor collide, and get their task done.

A first hour:

  surefoot demo -o demo/                       a scene, planned and walked
  surefoot scenario init map.yaml -o my.yaml   a scenario for a map of yours
  surefoot plan my.yaml -o plan/               build, solve, verify, save
  surefoot run my.yaml --plan plan/ -o run/    walk it among moving obstacles
  surefoot view run/                           pictures of the run

A quadruped on stones, gaps or rebar:

  surefoot skills terrain unstructured-4 -o ground.yaml   ground, made up
  surefoot terrain segment scan.png --help                or from a scan
  surefoot skills synthesize ground.yaml -o library/      what it can do there
  surefoot run ground.yaml --library library/ -o walk/    walk there

Any specification (GR(1)):

  surefoot synth spec.structuredslugs -o strategy.json    realizable? strategy
  surefoot explain spec.structuredslugs                   if not, why

Exit codes: 0 yes, 1 no (such as not realizable), 2 bad input,
3 a limit was reached, 4 a bug in Surefoot, 130 interrupted (Ctrl-C).
"""

app = typer.Typer(
    help=_HELP,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _print_version(wanted: bool) -> None:
    if wanted:
        from surefoot import __version__

        print(f"surefoot {__version__}")
        raise typer.Exit


@app.callback(help=_HELP)
def _options(
    _version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version and leave.")
    ] = False,
) -> None:
    """Take the options that stand before a command."""


app.add_typer(scenario.app, name="scenario")
app.command("plan")(plan.plan)
app.command("run")(run.run)
app.command("view")(view.view)
app.command("verify")(verify.verify)
app.command("belief")(belief.belief)
app.command("synth")(synth.synth)
app.command("explain")(explain.explain)
app.command("simulate")(simulate.simulate)
app.command("export")(export.export)
app.command("demo")(demo.demo)
app.command("reach")(reach.reach)
footholds.app.command("baselines")(baselines.baselines)
app.add_typer(footholds.app, name="footholds")
app.add_typer(terrain.app, name="terrain")
skills_terrain.app.command("synthesize")(skills.synthesize)
skills_terrain.app.command("show")(skills.show)
app.add_typer(skills_terrain.app, name="skills")
app.command("bench")(bench.bench)
app.command("doctor")(doctor.doctor)
