"""``surefoot reach``: the robust controllable regions of one walking step."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from surefoot.cli.output import PICTURES, AsJson, answer, facts, progress, to_write

if TYPE_CHECKING:
    from surefoot.reach import Region, Settings

Pair = tuple[float, float]
Triple = tuple[float, float, float]


class Reading(StrEnum):
    """How the bound on the disturbance is read."""

    RATE = "rate"
    INSIDE_PHI = "inside_phi"
    JUMP = "jump"


def reach(
    step_length: Annotated[float, typer.Option(help="From apex to apex [m].", show_default=False)],
    apex_velocity: Annotated[
        Pair, typer.Option(metavar="LOW HIGH", help="Window at the next apex [m/s].", show_default=False)
    ],
    disturbance: Annotated[
        Reading,
        typer.Option(
            help="How the bound is read: an additive rate, a shift of the state inside the dynamics, or a jump of the "
            "state at every sample. The paper allows all three, so there is no default.",
            show_default=False,
        ),
    ],
    tau: Annotated[float, typer.Option(help="Sampling time [s].")] = 0.02,
    grid: Annotated[Pair, typer.Option(metavar="DX DV", help="Cell size [m] [m/s].")] = (0.002, 0.004),
    omega: Annotated[Triple, typer.Option(metavar="LOW HIGH STEP", help="Inputs that may be held [rad/s].")] = (
        2.8,
        3.5,
        0.02,
    ),
    disturbance_bound: Annotated[
        Pair, typer.Option(metavar="A B", help="rate: [m/s] [m/s^2]; inside_phi, jump: [m] [m/s].")
    ] = (0.01, 0.02),
    guard_omega: Annotated[float, typer.Option(help="Omega of the guard's tangent manifolds [rad/s].")] = 3.1,
    guard_velocity: Annotated[
        Pair, typer.Option(metavar="LOW HIGH", help="Apex velocities of the guard's tangent manifolds [m/s].")
    ] = (0.15, 0.70),
    height_change: Annotated[float, typer.Option(help="Height of the next foot over this one [m].")] = 0.0,
    level_com: Annotated[
        bool, typer.Option("--level-com", help="The CoM keeps its height, so omega changes with the foot's height.")
    ] = False,
    apex_height: Annotated[float, typer.Option(help="Of the CoM over the first foot [m]; for --level-com.")] = 0.985,
    first_foot: Annotated[float, typer.Option(help="Stance foot along the heading, seen from the apex [m].")] = 0.0,
    first_only: Annotated[
        bool, typer.Option("--first-only", help="Keep one winning omega per cell instead of all: faster.")
    ] = False,
    save: Annotated[Path | None, typer.Option(metavar="FILE", help="Save to FILE.json and FILE.npz.")] = None,
    plot: Annotated[
        Path | None,
        typer.Option(metavar="FILE", callback=to_write(*PICTURES), help="Draw the regions into a PNG file."),
    ] = None,
    pictures: Annotated[
        Path | None, typer.Option(metavar="FOLDER", help="Draw regions, pushed steps and a map of pushes in there.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Compute from which states a walking step surely succeeds, and which omega to hold there.

    Examples:
      surefoot reach --step-length 0.416 --apex-velocity 0.4 0.6 --disturbance rate
      surefoot reach --step-length 0.52 --apex-velocity 0.45 0.7 --disturbance rate --save step --plot step.png

    Exit code 0: both regions have states to start from; 1: one is empty, with
    the reason; 2: the input cannot be used.
    """
    from surefoot import reach as rooms
    from surefoot.reach.warming import warm_up

    settings = rooms.Settings(
        rooms.Disturbance(rooms.Reading(disturbance.value), *disturbance_bound),
        tau_s=tau,
        grid=rooms.GridSpec(*grid),
        omegas=rooms.OmegaSet(*omega),
        guard=rooms.GuardTube(guard_omega, *guard_velocity),
    )
    transition = rooms.Transition(
        step_length,
        apex_velocity,
        first_foot_m=first_foot,
        height_change_m=height_change,
        level_com=level_com,
        apex_height_m=apex_height,
    )
    with progress() as say:
        say("loading the compiled sweep")
        warm_up()
        region = rooms.synthesize(transition, settings, all_masks=not first_only)
        for note in region.notes:
            say(f"warning: {note}")
        files = _write(region, save, plot, pictures)
    value = _value(region, settings, files)
    answer(value, _lines(region, files), yes=region.emptied_by is None, as_json=as_json)


def _write(region: Region, save: Path | None, plot: Path | None, pictures: Path | None) -> list[Path]:
    files: list[Path] = []
    if save is not None:
        from surefoot.reach import save_region

        files.extend(save_region(region, save))
    if plot is not None:
        from surefoot.viewer.steps.regions import draw_region

        files.append(draw_region(region, plot))
    if pictures is not None and region.emptied_by is None:
        from surefoot.viewer.steps.regions import draw_all

        files.extend(draw_all(region, pictures))
    return files


def _value(region: Region, settings: Settings, files: list[Path]) -> dict[str, object]:
    from surefoot.reach import masks_sha256

    return {
        "cells": region.counts,
        "time_s": region.time_s,
        "sha256": masks_sha256(region),
        "area": region.area,
        "empty": region.emptied_by,
        "warnings": region.notes,
        "disturbance": settings.disturbance,
        "files": files,
    }


def _lines(region: Region, files: list[Path]) -> list[str]:
    reason = region.emptied_by
    head = "The step surely succeeds from the first half's region" if reason is None else f"Empty: {reason}"
    counts, area = region.counts, region.area
    return [
        head,
        *facts(
            {
                "target [cells]": counts["target"],
                "second half's region [cells]": counts["shws"],
                "guard [cells]": counts["guard"],
                "first half's region [cells]": counts["fhws"],
                "second half's region [m m/s]": f"{area['shws']:.4f}",
                "first half's region [m m/s]": f"{area['fhws']:.4f}",
                "time [ms]": 1e3 * region.time_s,
            }
        ),
        *(f"  warning: {note}" for note in region.notes),
        *(f"  {file}" for file in files),
    ]
