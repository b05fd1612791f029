"""The example scenes that come with Surefoot."""

from __future__ import annotations

from pathlib import Path

from surefoot.compute import written_whole
from surefoot.errors import InputError
from surefoot.missions.scenario.file import read_scenario
from surefoot.world import read_occupancy_map

_SUFFIX = "_mission.yaml"


def scene_names() -> tuple[str, ...]:
    """Return the names of the scenes that exist."""
    return tuple(sorted(path.name.removesuffix(_SUFFIX) for path in _folder().glob(f"*{_SUFFIX}")))


def scene_path(name: str) -> Path:
    """Return the scenario file of a scene.

    Raises:
        InputError: if there is no such scene; the message lists those that exist.
    """
    path = _folder() / f"{name}{_SUFFIX}"
    if name not in scene_names():
        raise InputError(f"no scene {name!r}; there are {', '.join(scene_names()) or 'none in this installation'}")
    return path


def copy_scene(name: str, folder: Path) -> Path:
    """Copy a scene's scenario and map into a folder, and return the scenario there."""
    source = scene_path(name)
    scenario = read_scenario(source)
    occupancy = read_occupancy_map(scenario.map_path, scenario.map_resolution_m)
    for path in (source, occupancy.path, occupancy.image_path):
        with written_whole(folder / path.name) as stream:
            stream.write(path.read_bytes())
    return folder / source.name


def _folder() -> Path:
    """Return where the scenes are: inside an installed package, or beside its sources."""
    package = Path(__file__).parents[2]
    inside = package / "scenes"
    return inside if inside.is_dir() else package.parents[1] / "scenes"
