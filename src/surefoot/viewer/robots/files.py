"""Reads the parts of URDF and SDF files that a picture needs: links, joints that turn, meshes and boxes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import InputError
from surefoot.viewer.robots.model import Joint, RobotModel, Visual, homogeneous, turn_about

Array = NDArray[np.float64]

_LARGEST_BYTES = 4_000_000
_SCHEMES = ("package://", "model://")


def read_robot(path: Path, packages: Path) -> RobotModel:
    """Read a robot from a URDF file, or from an SDF file with one model.

    Args:
        path: ends with ``.urdf`` or ``.sdf``.
        packages: the folder that addresses such as ``package://`` begin in.

    Raises:
        InputError: it is no such file, or names a mesh outside of the folder.
    """
    try:
        if path.stat().st_size > _LARGEST_BYTES:
            raise InputError(f"is larger than the {_LARGEST_BYTES} bytes that are allowed", source=path)
        text = path.read_bytes()
        if b"<!" in text.replace(b"<!--", b"").replace(b"<![CDATA[", b""):
            raise InputError("declares XML entities or types of its own, which is not allowed", source=path)
        root = ElementTree.fromstring(text)  # noqa: S314 - without declarations nothing can grow
        return (_urdf if path.suffix == ".urdf" else _sdf)(root, packages)
    except OSError as problem:
        raise InputError(f"cannot be read ({problem.strerror})", source=path) from problem
    except ElementTree.ParseError as problem:
        raise InputError(f"is no XML ({problem})", source=path) from problem
    except (KeyError, ValueError, TypeError, AttributeError, StopIteration) as problem:
        raise InputError(f"is no robot that can be drawn ({problem})", source=path) from problem


def _urdf(root: ElementTree.Element, packages: Path) -> RobotModel:
    links = [one.attrib["name"] for one in root.iterfind("link")]
    joints = [_urdf_joint(one) for one in root.iterfind("joint")]
    visuals = [
        _visual(link.attrib["name"], one, _origin(one), packages, _urdf_size)
        for link in root.iterfind("link")
        for one in link.iterfind("visual")
    ]
    return _robot(root.attrib["name"], links, joints, visuals)


def _urdf_joint(one: ElementTree.Element) -> Joint:
    turns = one.attrib["type"] in ("revolute", "continuous")
    axis = one.find("axis")
    along = _numbers("1 0 0" if axis is None else axis.attrib["xyz"], 3)
    return Joint(
        one.attrib["name"],
        _found(one, "parent").attrib["link"],
        _found(one, "child").attrib["link"],
        _origin(one),
        along / np.linalg.norm(along) if turns else None,
    )


def _origin(one: ElementTree.Element) -> Array:
    origin = one.find("origin")
    given = {} if origin is None else origin.attrib
    return _pose(_numbers(given.get("xyz", "0 0 0"), 3), _numbers(given.get("rpy", "0 0 0"), 3))


def _urdf_size(one: ElementTree.Element, key: str) -> Array:
    return _numbers(one.attrib.get(key, "1 1 1"), 3)


def _sdf(root: ElementTree.Element, packages: Path) -> RobotModel:
    """Read a model; poses of links are in the frame of the model, at angles of 0.

    Joints that close a loop, their child having a parent already, are left out.
    """
    model = _found(root, "model")
    places = {one.attrib["name"]: _sdf_pose(one) for one in model.iterfind("link")}
    joints: dict[str, Joint] = {}
    for one in model.iterfind("joint"):
        parent, child = _text(one, "parent"), _text(one, "child")
        if child in joints or one.attrib["type"] != "revolute":
            continue
        along = _numbers(_text(one, "axis/xyz"), 3)
        pose = np.linalg.inv(places[parent]) @ places[child]
        joints[child] = Joint(one.attrib["name"], parent, child, pose, along / np.linalg.norm(along))
    visuals = [
        _visual(link.attrib["name"], one, _sdf_pose(one), packages, _sdf_size)
        for link in model.iterfind("link")
        for one in link.iterfind("visual")
    ]
    return _robot(model.attrib["name"], list(places), list(joints.values()), visuals)


def _sdf_pose(one: ElementTree.Element) -> Array:
    numbers = _numbers(one.findtext("pose") or "0 0 0 0 0 0", 6)
    return _pose(numbers[:3], numbers[3:])


def _sdf_size(one: ElementTree.Element, key: str) -> Array:
    return _numbers(one.findtext(key) or "1 1 1", 3)


def _visual(
    link: str,
    one: ElementTree.Element,
    pose: Array,
    packages: Path,
    size: Callable[[ElementTree.Element, str], Array],
) -> Visual:
    """Return a visual; shapes other than meshes and boxes do not occur in the robots that are drawn."""
    geometry = _found(one, "geometry")
    mesh, box = geometry.find("mesh"), geometry.find("box")
    if mesh is not None:
        address = mesh.attrib["filename"] if "filename" in mesh.attrib else _text(mesh, "uri")
        x, y, z = size(mesh, "scale").tolist()
        return Visual(link, pose, _file(address, packages), (x, y, z))
    if box is None:
        raise ValueError(f"link {link} looks like neither a mesh nor a box")
    x, y, z = size(box, "size").tolist()
    colour = one.find("material/color")
    rgb = None if colour is None else _numbers(colour.attrib["rgba"], 4)[:3].tolist()
    return Visual(link, pose, None, (x, y, z), None if rgb is None else (rgb[0], rgb[1], rgb[2]))


def _file(address: str, packages: Path) -> Path:
    scheme = next((one for one in _SCHEMES if address.startswith(one)), "")
    path = (packages / address.removeprefix(scheme)).resolve()
    if not path.is_relative_to(packages.resolve()):
        raise ValueError(f"{address} is outside of {packages}")
    return path


def _robot(name: str, links: Sequence[str], joints: Sequence[Joint], visuals: Sequence[Visual]) -> RobotModel:
    """Return the tree below the only link that nothing carries; what is not part of it is left out."""
    children = {joint.child for joint in joints}
    carrying = {joint.parent for joint in joints}
    root = next(link for link in links if link not in children and (link in carrying or not joints))
    placed, ordered = {root}, []
    while more := [one for one in joints if one.parent in placed and one.child not in placed]:
        ordered.extend(more)
        placed.update(one.child for one in more)
    drawn = tuple(one for one in visuals if one.link in placed)
    return RobotModel(name, root, tuple(ordered), drawn)


def _found(one: ElementTree.Element, key: str) -> ElementTree.Element:
    inner = one.find(key)
    if inner is None:
        raise ValueError(f"an element <{one.tag}> has no <{key}>")
    return inner


def _text(one: ElementTree.Element, key: str) -> str:
    return (_found(one, key).text or "").strip()


def _numbers(text: str, count: int) -> Array:
    numbers = np.array([float(word) for word in text.split()])
    if len(numbers) != count or not np.isfinite(numbers).all():
        raise ValueError(f"{text!r} are not {count} numbers")
    return numbers


def _pose(place_m: Array, rpy_rad: Array) -> Array:
    roll, pitch, yaw = (turn_about(axis, angle[None])[0] for axis, angle in zip(np.eye(3), rpy_rad, strict=True))
    return homogeneous(yaw @ pitch @ roll, place_m)
