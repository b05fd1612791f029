"""The ground of a quadruped's run as a scene: terrain that changes on the way, obstacles, the way point, the goal."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot.skills.patches import Rectangle
from surefoot.viewer import style
from surefoot.viewer.browser.page import add_solid, colour
from surefoot.viewer.browser.solids import slab, together
from surefoot.viewer.sources.ground import OBSTACLE_M, RunGround

Array = NDArray[np.float64]

_PIT_M, _MARGIN_M = 0.30, 0.4
"""How far below the lowest ground, and beyond the outermost, the bottom of the pit is drawn."""
_THIN_M, _BAR_M = 0.05, 0.04
"""Polygons with less area per half of their outline are bars, drawn as thick as that; the others stand in the pit."""
_LEVELS = 6
_LOW, _HIGH, _PIT = (176, 164, 142), (240, 235, 224), "#4b4843"


class GroundScene:
    """Draws a ground into a scene, and any moment of it.

    Args:
        scene: of a viser server.
        ground: of a run.
    """

    def __init__(self, scene: Any, ground: RunGround) -> None:
        self.scene, self.ground = scene, ground
        self.phase = self.way_point = -1
        points = np.concatenate([one for phase in ground.phases for one in phase.polygons_m])
        self.low_m, self.high_m = points.min(axis=0), points.max(axis=0)
        self._add_pit()
        self.solids = self._add_polygons()
        self.boxes = [self._add_obstacle(number, box) for number, box in enumerate(ground.phases[-1].obstacles)]
        self.marks = [self._add_way_point(number) for number in range(len(ground.way_points))]
        scene.add_cylinder("/goal", 0.16, 0.012, colour(style.GOAL), position=ground.goal_m, opacity=0.85)
        scene.add_label("/goal/name", "goal", position=(0.0, 0.0, 0.1))

    def grow(self, ground: RunGround) -> None:
        """Take over the ground of a longer log: new way points, and what happened to the world."""
        happened = len(ground.phases) > len(self.ground.phases)
        self.ground, self.way_point = ground, -1
        if happened:
            for node in (*(node for _, node in self.solids), *self.boxes):
                node.remove()
            self.solids, self.phase = self._add_polygons(), -1
            self.boxes = [self._add_obstacle(number, box) for number, box in enumerate(ground.phases[-1].obstacles)]
        self.marks += [self._add_way_point(number) for number in range(len(self.marks), len(ground.way_points))]

    def show(self, time_s: float) -> None:
        """Show the world at a moment; only what has changed is sent."""
        phase = sum(one.begin_s <= time_s for one in self.ground.phases[1:])
        if phase != self.phase:
            self.phase = phase
            for (first, last), node in self.solids:
                node.visible = first <= phase <= last
            for number, node in enumerate(self.boxes):
                node.visible = number < len(self.ground.phases[phase].obstacles)
        way_point = max(sum(one.begin_s <= time_s for one in self.ground.way_points) - 1, 0)
        if way_point != self.way_point:
            self.way_point = way_point
            for number, node in enumerate(self.marks):
                node.visible = number == way_point

    def _add_pit(self) -> None:
        """Draw what lies below the ground, so that gaps show."""
        (x, y), (wide, deep) = (self.low_m + self.high_m)[:2] / 2, (self.high_m - self.low_m)[:2] + 2 * _MARGIN_M
        size_m = (float(wide), float(deep), 0.02)
        place = (float(x), float(y), float(self.low_m[2]) - _PIT_M - 0.01)
        self.scene.add_box("/ground/pit", colour(_PIT), size_m, position=place, cast_shadow=False)

    def _add_polygons(self) -> list[tuple[tuple[int, int], Any]]:
        """Draw polygons, those together that have about one height and are there in the same phases."""
        found: dict[bytes, tuple[Array, list[int]]] = {}
        for number, phase in enumerate(self.ground.phases):
            for polygon in phase.polygons_m:
                found.setdefault(polygon.tobytes(), (polygon, []))[1].append(number)
        groups: dict[tuple[tuple[int, int], int], list[Array]] = defaultdict(list)
        for polygon, phases in found.values():
            groups[(phases[0], phases[-1]), self._level(polygon)].append(polygon)
        return [(phases, self._add_group(phases, level, some)) for (phases, level), some in groups.items()]

    def _add_group(self, phases: tuple[int, int], level: int, polygons: Sequence[Array]) -> Any:
        share = level / (_LEVELS - 1)
        red, green, blue = (round(low + share * (high - low)) for low, high in zip(_LOW, _HIGH, strict=True))
        name, bottom_m = f"/ground/{phases[0]}-{phases[1]}/{level}", float(self.low_m[2]) - _PIT_M
        solid = together([slab(one, _BAR_M if _is_bar(one) else one[:, 2] - bottom_m) for one in polygons])
        return add_solid(self.scene, name, solid, f"#{red:02x}{green:02x}{blue:02x}", cast_shadow=False)

    def _level(self, polygon: Array) -> int:
        span_m = float(self.high_m[2] - self.low_m[2])
        share = (float(polygon[:, 2].mean()) - float(self.low_m[2])) / span_m if span_m > 1e-3 else 1.0
        return round(share * (_LEVELS - 1))

    def _add_obstacle(self, number: int, box: Rectangle) -> Any:
        size_m = (box.east - box.west, box.north - box.south, OBSTACLE_M + _PIT_M)
        centre = ((box.west + box.east) / 2, (box.south + box.north) / 2, float(self.low_m[2]) + size_m[2] / 2 - _PIT_M)
        return self.scene.add_box(f"/obstacles/{number}", colour(style.OBSTACLE), size_m, position=centre)

    def _add_way_point(self, number: int) -> Any:
        place = self.ground.way_points[number].place_m + np.array([0.0, 0.0, 0.006])
        name = f"/way_points/{number}"
        node = self.scene.add_cylinder(name, 0.10, 0.012, colour(style.BLUE), position=place, opacity=0.85)
        self.scene.add_label(f"{name}/name", "way point", position=(0.0, 0.0, 0.08))
        return node


def _is_bar(polygon: Array) -> bool:
    after = np.roll(polygon, -1, axis=0)
    area = abs(float((polygon[:, 0] * after[:, 1] - polygon[:, 1] * after[:, 0]).sum())) / 2
    around = float(np.linalg.norm(after - polygon, axis=1).sum())
    return area / (around / 2) < _THIN_M
