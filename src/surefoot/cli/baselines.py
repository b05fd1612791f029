"""``surefoot footholds baselines``: the planners that certified segments are compared with."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from surefoot.cli.output import AsJson, answer, progress

if TYPE_CHECKING:
    from surefoot.footholds.baselines import CertifiedRow, HorizonRow, NearestRow


def baselines(
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="A folder for the two pictures; default: none are drawn.")
    ] = None,
    seeds: Annotated[int, typer.Option("--seeds", min=1, max=1000, help="How many of every kind.")] = 10,
    time_limit_s: Annotated[
        float, typer.Option("--time-limit", min=0.1, max=300, help="Of one program, in seconds.")
    ] = 60.0,
    longest_s: Annotated[int, typer.Option("--horizon", min=1, max=5, help="The longest horizon, in seconds.")] = 5,
    as_json: AsJson = False,
) -> None:
    """Compare with one program over the whole way, and with the nearest foothold.

    The first table: horizons of 1 to 5 s of a repeated trot on stones and on
    bars, as one program and as segments of 2 and 3 s. The second: a heuristic
    that steps to the nearest bar, against certified segments, on bars with one
    widest gap.

    Examples:
      surefoot footholds baselines -o pictures/
      surefoot footholds baselines --seeds 3 --horizon 3 --json
    """
    from surefoot.footholds.baselines import measure_horizons, measure_nearest

    with progress() as say:
        horizons = measure_horizons(seeds, time_limit_s, range(1, longest_s + 1), say)
        heuristic, certified = measure_nearest(seeds, say=say)
    pictures: list[Path] = []
    if output is not None:
        from surefoot.viewer.studies.baselines import draw_horizons, draw_nearest

        output.mkdir(parents=True, exist_ok=True)
        pictures = [
            draw_horizons(horizons, output / "horizons.png"),
            draw_nearest(heuristic, certified, output / "nearest.png"),
        ]
    value = {"horizons": horizons, "nearest": heuristic, "certified": certified, "pictures": pictures}
    lines = [*_horizon_lines(horizons, seeds), "", *_nearest_lines(heuristic, certified), *map(str, pictures)]
    answer(value, lines, yes=True, as_json=as_json)


def _horizon_lines(rows: tuple[HorizonRow, ...], seeds: int) -> list[str]:
    from statistics import median

    head = f"{'CPU ms, median / worst of ' + str(seeds):<28}{'one program':>20}{'segments':>18}   not planned, censored"
    return [
        head,
        *(
            f"{row.field + f', {row.horizon_s} s':<28}"
            f"{f'{median(row.whole_ms):.0f} / {max(row.whole_ms):.0f}':>20}"
            f"{f'{median(row.segments_ms):.0f} / {max(row.segments_ms):.0f}':>18}"
            f"   {row.whole_infeasible} and {row.segments_infeasible}, {row.censored}"
            for row in rows
        ),
    ]


def _nearest_lines(heuristic: tuple[NearestRow, ...], certified: tuple[CertifiedRow, ...]) -> list[str]:
    lines = ["nearest foothold on bars      out of reach   worst    beside a bar   worst"]
    for row in heuristic:
        what = f"up to {row.widest_m:.2f} m, {row.speed_mps:g} m/s"
        lines.append(
            f"{what:<30}{row.beyond_reach:>11.0%}{100 * row.worst_beyond_m:>8.0f} cm"
            f"{row.off_polygon:>13.0%}{100 * row.worst_off_m:>7.0f} cm"
        )
    lines += ["", "certified segments            crossed   refused   unknown   CPU ms a segment"]
    for one in certified:
        lines.append(
            f"{f'up to {one.widest_m:.2f} m':<30}{one.crossed:>7}{one.refused:>10}{one.unknown:>10}"
            f"{one.segment_ms:>14.0f}"
        )
    return lines
