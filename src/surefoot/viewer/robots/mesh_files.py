"""Robots' own meshes: where the package that holds them is, and triangles few enough for a page."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, distribution
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import BackendMissing, InputError
from surefoot.viewer.robots.files import read_robot
from surefoot.viewer.robots.model import RobotModel, Visual

INSTALL = "pip install 'surefoot[meshes]'"
MOST_FACES = 30_000
"""Of a robot on a page; more are simplified."""

_PACKAGE = "example-robot-data"
_FILES = {
    "go2": "go2_description/urdf/go2.urdf",
    "cassie": "cassie_description/robots/cassie_v2.sdf",
}
_LEAST_FACES = 60
_GREY = (0.62, 0.65, 0.69)


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """Triangles of one colour: vertices (n, 3) in their link's frame, faces (m, 3), red, green and blue from 0 to 1."""

    link: str
    vertices_m: NDArray[np.float32]
    faces: NDArray[np.uint32]
    rgb: tuple[float, float, float]


def package_folder() -> Path | None:
    """Return the folder that addresses of models begin in; None if a package is missing that is needed to read them."""
    if not all(find_spec(name) for name in ("trimesh", "collada", "fast_simplification")):
        return None
    try:
        folder = Path(str(distribution(_PACKAGE).locate_file("cmeel.prefix/share")))
    except PackageNotFoundError:
        return None
    return folder if folder.is_dir() else None


def own_model(robot: str) -> RobotModel | None:
    """Return a robot's own model; None if it has none, or if it is not installed."""
    folder = package_folder()
    if robot not in _FILES or folder is None:
        return None
    return read_robot(folder / _PACKAGE / "robots" / _FILES[robot], folder)


def model_of(robot: str) -> RobotModel:
    """Return the model of a robot that has one.

    Raises:
        BackendMissing: it is not installed.
    """
    model = own_model(robot)
    if model is None:
        raise BackendMissing(_PACKAGE, INSTALL)
    return model


def parts_of(model: RobotModel, most_faces: int = MOST_FACES) -> tuple[Part, ...]:
    """Return the triangles of a robot, all shapes simplified by the same share when they are too many.

    Raises:
        InputError: a mesh cannot be read.
    """
    loaded = {path: _loaded(path) for path in {visual.mesh for visual in model.visuals} if path is not None}
    shapes = [(visual, mesh, rgb) for visual in model.visuals for mesh, rgb in _shapes(visual, loaded)]
    share = min(1.0, most_faces / max(1, sum(len(mesh.faces) for _, mesh, _ in shapes)))
    return tuple(_part(visual, _simplified(mesh, share), rgb) for visual, mesh, rgb in shapes)


def _part(visual: Visual, mesh: Any, rgb: tuple[float, float, float]) -> Part:
    vertices = mesh.vertices @ (visual.pose[:3, :3] * _scale(visual)).T + visual.pose[:3, 3]
    faces = mesh.faces if np.prod(visual.size) > 0 else mesh.faces[:, ::-1]  # a mirrored mesh is inside out
    return Part(visual.link, vertices.astype(np.float32), faces.astype(np.uint32), rgb)


def _scale(visual: Visual) -> NDArray[np.float64]:
    return np.array(visual.size) if visual.mesh is not None else np.ones(3)


def _shapes(visual: Visual, loaded: Mapping[Path, tuple[Any, ...]]) -> Iterator[tuple[Any, tuple[float, float, float]]]:
    """Yield the meshes of a visual with their colours."""
    import trimesh

    if visual.mesh is None:
        yield trimesh.creation.box(visual.size), visual.rgb or _GREY
        return
    for mesh in loaded[visual.mesh]:
        yield mesh, visual.rgb or _colour(mesh)


def _loaded(path: Path) -> tuple[Any, ...]:
    """Return the meshes of a file, in its frame."""
    import trimesh

    try:
        meshes = tuple(one for one in trimesh.load_scene(path).dump() if len(getattr(one, "faces", ())))
    except (OSError, ValueError, KeyError, IndexError, AttributeError, TypeError) as problem:
        raise InputError(f"is no mesh that can be read ({problem})", source=path) from problem
    if not meshes:
        raise InputError("holds no triangles", source=path)
    return meshes


def _colour(mesh: Any) -> tuple[float, float, float]:
    material = getattr(mesh.visual, "material", None)
    if material is None:
        return _GREY
    red, green, blue = (float(one) / 255 for one in material.main_color[:3])
    return red, green, blue


def _simplified(mesh: Any, share: float) -> Any:
    """Return a mesh with its equal vertices merged and about a share of its faces."""
    import trimesh

    merged = trimesh.Trimesh(mesh.vertices, mesh.faces, process=True)
    merged.merge_vertices()
    wanted = max(_LEAST_FACES, round(share * len(mesh.faces)))
    return merged if len(merged.faces) <= wanted else merged.simplify_quadric_decimation(face_count=wanted)
