"""The terrain part of ``surefoot bench``: speed, and honesty against synthetic truth."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from surefoot.missions.bench.figures import Figure
    from surefoot.world.synthetic_terrain import SyntheticTerrain

SEEDS = range(8)
REPEATS = 5


def terrain_figures(say: Callable[[str], None]) -> Iterator[Figure]:
    """Measure the segmentation of large maps, and of noisy stairs and stones against what they truly are."""
    from surefoot.missions.bench.figures import Figure
    from surefoot.world.scanned_terrain import warm_up
    from surefoot.world.synthetic_terrain import stairs, stones

    warm_up()
    large: dict[str, SyntheticTerrain] = {
        "stairs": stairs(steps=27, width_m=9.9),
        "648 sparse stones": stones(rows=27, columns=24, gap_m=0.15),
        "1326 stones 5 cm apart": stones(rows=39, columns=34, gap_m=0.05),
        "1444 stones over a floor that shows": stones(rows=38, columns=38, gap_m=0.06),
    }
    for name, truth in large.items():
        say(f"segmenting 10 m x 10 m of {name}")
        wall_s, used_s = _times(truth)
        what = f"10 m x 10 m at 2 cm, {name}"
        yield Figure(f"{what}, processor time", used_s, "s", 1.0, "at most", "")
        yield Figure(f"{what}, by the clock", wall_s, "s", None, "at most", "")
    families: dict[str, Callable[[int], SyntheticTerrain]] = {
        "stairs": lambda seed: stairs(seed=seed, yaw_rad=0.1 * seed),
        "stairs, 2 % dropouts": lambda seed: stairs(seed=seed, yaw_rad=0.1 * seed, missing=0.02),
        "stones 20 cm, gaps 5 cm": lambda seed: stones(seed=seed, yaw_rad=0.1 * seed),
        "stones over holes": lambda seed: stones(seed=seed, yaw_rad=0.1 * seed, floor=False, missing=0.02),
        "stones 15 cm apart": lambda seed: stones(seed=seed, yaw_rad=0.1 * seed, gap_m=0.15, rows=3, columns=5),
    }
    for name, make in families.items():
        say(f"comparing {len(SEEDS)} scans of {name} with the truth")
        yield from _honesty(name, [make(seed) for seed in SEEDS])


def _honesty(name: str, truths: list[SyntheticTerrain]) -> Iterator[Figure]:
    from surefoot.missions.bench.figures import Figure
    from surefoot.world import segment_terrain
    from surefoot.world.terrain_truth import compare_with_truth

    terrains = [segment_terrain(truth.elevation) for truth in truths]
    found = [compare_with_truth(terrain, truth) for terrain, truth in zip(terrains, truths, strict=True)]
    what = f"{name}, 1 cm noise:"
    kept = min(one.kept_share for one in found)
    yield Figure(f"{what} true area kept, worst scan", 100 * kept, "%", 95.0, "at least", "")
    yield Figure(f"{what} points > 2 cm off", sum(one.points_off for one in found), "", 0, "at most", "")
    yield Figure(f"{what} points over holes", sum(one.points_over_holes for one in found), "", 0, "at most", "")
    pieces = statistics.mean(terrain.pieces_per_region for terrain in terrains)
    yield Figure(f"{what} pieces per region", pieces, "", None, "at most", "")


def _times(truth: SyntheticTerrain) -> tuple[float, float]:
    """Return the median times of some repetitions by the clock and of the processor [s]."""
    from surefoot.world import segment_terrain

    wall, used = [], []
    for _ in range(REPEATS):
        begin, busy = time.perf_counter(), time.process_time()
        segment_terrain(truth.elevation)
        wall.append(time.perf_counter() - begin)
        used.append(time.process_time() - busy)
    return statistics.median(wall), statistics.median(used)
