"""The simple biped in a scene: its parts, its footprints, and the contact of the foot that carries it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot.missions.biped.run_log import Step
from surefoot.viewer import style
from surefoot.viewer.browser.page import colour
from surefoot.viewer.robots.biped_body import biped_body
from surefoot.viewer.robots.bodies import SIMPLE, Chosen
from surefoot.viewer.robots.simple import weight_pose
from surefoot.viewer.sources.timeline import Timeline

FRICTION = 0.6
"""The slope of the cone that is drawn; a biped's plan assumes that its feet do not slip."""

_HUES = {"left": style.LEFT, "right": style.RIGHT}
_FORCE_M, _CONE_M = 0.6, 0.25


class BipedFigure:
    """Draws the robot of a run into a scene, and any moment of it.

    Args:
        scene: of a viser server.
        times: the run, sampled.
        steps: of the run.
        chosen: the body that is drawn.
    """

    def __init__(
        self,
        scene: Any,
        times: Timeline,
        steps: Sequence[Step],
        chosen: Chosen = SIMPLE,
    ) -> None:
        self.scene, self.foot = scene, (0.0, 0.0, 0.0)
        self.body = biped_body(scene, times, chosen)
        self.force = scene.add_cylinder("/contact/force", 0.015, _FORCE_M, colour(style.GREEN))
        vertices, faces = friction_cone(FRICTION, _CONE_M)
        self.cone = scene.add_mesh_simple("/contact/cone", vertices, faces, color=colour(style.GREEN), opacity=0.25)
        self._take(times, steps)

    def grow(self, times: Timeline, steps: Sequence[Step]) -> None:
        """Take over a longer log of the same run."""
        self.body.grow(times)
        self._take(times, steps)

    def _take(self, times: Timeline, steps: Sequence[Step]) -> None:
        self.stance_m = _stances(times, steps)
        self.weight = weight_pose(self.stance_m, times.com_m, _FORCE_M)
        for side, hue in _HUES.items():
            points = [step.next_foot_m for step in steps if step.stance != side]
            if points:
                raised = np.array(points) + np.array([0.0, 0.0, 0.01])
                looks: dict[str, Any] = {"point_size": 0.06, "precision": "float32"}
                self.scene.add_point_cloud(f"/footprints/{side}", raised, colour(hue), **looks)

    def show(self, frame: int) -> None:
        """Show a moment."""
        self.body.show(frame)
        self.force.position, self.force.wxyz = self.weight.position_m[frame], self.weight.wxyz[frame]
        place = tuple(self.stance_m[frame])
        if place != self.foot:
            self.cone.position = self.foot = place


def friction_cone(friction: float, height_m: float) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """Return vertices and faces of a cone that opens upwards with the slope of a friction coefficient."""
    turns = np.linspace(0.0, 2 * np.pi, 24, endpoint=False)
    rim = np.stack([friction * np.cos(turns), friction * np.sin(turns), np.ones(24)], axis=1) * height_m
    vertices = np.concatenate([[[0.0, 0.0, 0.0]], rim]).astype(np.float32)
    faces = np.array([(0, 1 + (k + 1) % 24, 1 + k) for k in range(24)], dtype=np.uint32)
    return vertices, faces


def _stances(times: Timeline, steps: Sequence[Step]) -> NDArray[np.float64]:
    """Return where the foot stands that carries the robot, at every moment."""
    switch_s = np.array([step.time_s + step.first_half_s for step in steps])[times.step]
    before, after = (np.array([getattr(step, name) for step in steps]) for name in ("foot_m", "next_foot_m"))
    early = (times.time_s < switch_s)[:, None]
    places: NDArray[np.float64] = np.where(early, before[times.step], after[times.step])
    return places
