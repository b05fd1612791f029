"""The navigation rows of ``surefoot bench``: several obstacles in the two rooms, joint and separate, and halls."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import yaml

from surefoot.cli.output import Say

if TYPE_CHECKING:
    from surefoot.missions.bench.figures import Figure
    from surefoot.navigation.benchmarks import GameFigures

SCENE = "two_rooms"
CELL_M = 2.70351


@dataclass(frozen=True, slots=True)
class _Case:
    """Obstacles in the two rooms, and what is asked of planning them."""

    obstacles: int
    tracking: str
    most_s: float
    most_mb: float
    paper: str


CASES = (
    _Case(2, "joint", 3.0, 500.0, "34 min"),
    _Case(2, "separate", 10.0, 500.0, "85 min"),
    _Case(3, "joint", 5.0, 2000.0, "not attempted"),
    _Case(4, "joint", 30.0, 2000.0, "not attempted"),
)
HALLS = ((8, 6, 1), (8, 6, 2), (15, 10, 1), (15, 10, 2), (30, 15, 1), (60, 30, 1))


def navigation_figures(say: Say) -> Iterator[Figure]:
    """Measure whole plans of the two rooms, and the parts of their navigation games and of halls of all sizes."""
    from surefoot.missions.bench.biped import whole_process
    from surefoot.missions.bench.figures import Figure
    from surefoot.missions.scenario.scene import read_biped_scene
    from surefoot.navigation.benchmarks import hall, measured

    with tempfile.TemporaryDirectory(prefix="surefoot-bench-") as name:
        for case in CASES:
            what = f"two rooms, {case.obstacles} obstacles, {case.tracking}"
            say(f"planning: {what}")
            scenario = _scenario(Path(name), case)
            elapsed_s, peak_mb = whole_process(["plan", str(scenario), "-o", str(Path(name) / "plan"), "--json"])
            yield Figure(f"{what}: surefoot plan, whole process", elapsed_s, "s", case.most_s, "at most", case.paper)
            yield Figure(f"{what}: peak memory", peak_mb, "MB", case.most_mb, "at most", "")
            yield from _parts(what, measured(read_biped_scene(scenario).problem))
        for columns, rows, obstacles in HALLS:
            what = f"hall of {columns} x {rows} cells, {obstacles} obstacle{'s' if obstacles > 1 else ''}"
            say(f"solving: {what}")
            figures = measured(hall(columns, rows, obstacles))
            yield Figure(f"{what}: game, CPU", figures.total_s, "s", None, "at most", "not attempted")
            yield Figure(f"{what}: turns", figures.turns, "", None, "at most", "")


def _parts(what: str, game: GameFigures) -> Iterator[Figure]:
    """Return the size of a navigation game and the processor time of its parts."""
    from surefoot.missions.bench.figures import Figure

    for part, value, unit in (
        ("turns", game.turns, ""),
        ("edges", game.edges, ""),
        ("build, CPU", game.build_s, "s"),
        ("assumption, CPU", game.assumption_s, "s"),
        ("solve, CPU", game.solve_s, "s"),
        ("strategy, CPU", game.strategy_s, "s"),
    ):
        yield Figure(f"{what}: {part}", value, unit, None, "at most", "")


def _scenario(folder: Path, case: _Case) -> Path:
    """Write the two-room scenario with other obstacles, beside each other along the southern wall."""
    from surefoot.missions.scenario.shipped import copy_scene

    path = copy_scene(SCENE, folder)
    scenario = yaml.safe_load(path.read_text())
    (first,) = scenario["obstacles"]
    x, y = first["start_m"]
    scenario["obstacles"] = [{**first, "start_m": [x + place * CELL_M, y]} for place in range(case.obstacles)]
    scenario["navigation"] = {"belief_tracking": case.tracking}
    written = folder / f"{case.obstacles}_{case.tracking}.yaml"
    written.write_text(yaml.safe_dump(scenario))
    return written
