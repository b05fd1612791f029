"""``surefoot bench``: the benchmarks, one table."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from surefoot.cli.benchmarks.growth import answer_growth
from surefoot.cli.benchmarks.pushes import answer_pushes
from surefoot.cli.benchmarks.quadruped import FULL_SEEDS, SEEDS, Asked, answer_quadruped_bench
from surefoot.cli.benchmarks.regions import answer_table_1, region_figures
from surefoot.cli.benchmarks.scaling import answer_scaling
from surefoot.cli.benchmarks.table import figure_table
from surefoot.cli.output import AsJson, Say, answer, progress
from surefoot.errors import InputError

if TYPE_CHECKING:
    from surefoot.missions.bench.figures import Figure

Suite = Callable[[Say], "Iterable[Figure]"]


class Which(StrEnum):
    """What to measure."""

    ALL = "all"
    WALKING = "walking"
    NAVIGATION = "navigation"
    ACTION = "action"
    MISSION = "mission"
    MISSIONS = "missions"
    FOOTHOLDS = "footholds"
    GAITFREE = "gaitfree"
    REGIONS = "regions"
    TERRAIN = "terrain"
    TABLE1 = "table1"
    PUSHES = "pushes"
    SYNTHESIS = "synthesis"
    GROWTH = "growth"
    SCALING = "scaling"
    SKILLS = "skills"
    QUADRUPED = "quadruped"


def bench(
    which: Annotated[Which, typer.Argument(help="What to measure.")] = Which.ALL,
    picture: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="growth and scaling: a picture, PNG; quadruped: a folder for pictures."),
    ] = None,
    scene: Annotated[
        list[str] | None, typer.Option("--scene", help="quadruped: this scene only; may be given several times.")
    ] = None,
    seeds: Annotated[
        int | None,
        typer.Option("--seeds", min=1, max=1000, help=f"quadruped: how many maps of every scene; default {SEEDS}."),
    ] = None,
    full: Annotated[bool, typer.Option("--full", help=f"quadruped: {FULL_SEEDS} maps of every scene; hours.")] = False,
    keep: Annotated[
        Path | None,
        typer.Option("--keep", help="quadruped: a folder for results; given again, an interrupted campaign goes on."),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Measure speed and memory, walk a campaign, and compare with the paper and with the targets.

    Examples:
      surefoot bench
      surefoot bench navigation --json
      surefoot bench growth -o growth.png
      surefoot bench quadruped --scene rebar-7 --seeds 5
      surefoot bench quadruped --full --keep campaign/ -o pictures/

    Exit code 0: every target is met; 1: some is missed.
    """
    asked = Asked(tuple(scene or ()), seeds, full, keep, picture)
    if asked.given and which is not Which.QUADRUPED:
        raise InputError("--scene, --seeds, --full and --keep are options of: surefoot bench quadruped")
    with progress() as say:
        if which is Which.QUADRUPED:  # a campaign of many minutes: not among all the others
            answer_quadruped_bench(asked, say, as_json=as_json)
        if which is Which.TABLE1:
            answer_table_1(say, as_json=as_json)
        if which is Which.PUSHES:
            answer_pushes(say, as_json=as_json)
        if which is Which.GROWTH:
            answer_growth(say, picture, as_json=as_json)
        if which is Which.SCALING:
            answer_scaling(say, picture, as_json=as_json)
        figures = tuple(figure for suite in _suites(which) for figure in suite(say))
    met = all(figure.met is not False for figure in figures)
    answer({"figures": figures, "met": met}, figure_table(figures), yes=met, as_json=as_json)


def _suites(which: Which) -> tuple[Suite, ...]:
    """Return the functions that measure what was asked for."""
    suites: dict[Which, Suite] = {
        Which.REGIONS: region_figures,
        Which.FOOTHOLDS: _footholds,
        Which.GAITFREE: _gaits,
        Which.TERRAIN: _terrain,
        Which.SYNTHESIS: _synthesis,
        Which.SKILLS: _skills,
    }
    if which in suites:
        return (suites[which],)
    if which is Which.NAVIGATION:
        return (partial(_biped, which.value), _navigation)
    return (partial(_biped, which.value), *((_navigation, *suites.values()) if which is Which.ALL else ()))


def _biped(which: str, say: Say) -> Iterable[Figure]:
    from surefoot.missions.bench.biped import benchmarks

    return benchmarks(which, say)


def _navigation(say: Say) -> Iterable[Figure]:
    from surefoot.cli.benchmarks.navigation import navigation_figures

    return navigation_figures(say)


def _footholds(say: Say) -> Iterable[Figure]:
    from surefoot.cli.benchmarks.footholds import foothold_figures

    return foothold_figures(say)


def _gaits(say: Say) -> Iterable[Figure]:
    from surefoot.cli.benchmarks.gaits import gait_figures

    return gait_figures(say)


def _terrain(say: Say) -> Iterable[Figure]:
    from surefoot.cli.benchmarks.terrain import terrain_figures

    return terrain_figures(say)


def _synthesis(say: Say) -> Iterable[Figure]:
    from surefoot.cli.benchmarks.synthesis import synthesis_figures

    return synthesis_figures(say)


def _skills(say: Say) -> Iterable[Figure]:
    from surefoot.cli.benchmarks.skills import skill_figures

    return skill_figures(say)
