"""Robots written for tests: the joints of the Go2 and of Cassie with boxes for looks, and one mesh file."""

from __future__ import annotations

import struct
from pathlib import Path

from surefoot.robots import quadruped
from surefoot.robots.legs import legs
from surefoot.robots.quadruped import FEET, FOOT_SIGNS

PACKAGE = "example-robot-data"
_BOX = '<visual><geometry><box size="{}"/></geometry><material><color rgba="0.8 0.3 0.1 1"/></material></visual>'
_MESH = f'<visual><geometry><mesh filename="package://{PACKAGE}/tip.stl" scale="2 2 2"/></geometry></visual>'


def write_go2(share: Path) -> Path:
    """Write a URDF of the Go2's legs where the package of robots has its; return it."""
    path = share / PACKAGE / "robots" / "go2_description" / "urdf" / "go2.urdf"
    path.parent.mkdir(parents=True)
    (share / PACKAGE / "tip.stl").write_bytes(_tetrahedron(0.01))
    path.write_text(go2_urdf())
    return path


def go2_urdf() -> str:
    """Return the text: joints of the Go2, a box for trunk, thighs and shanks, a mesh for feet."""
    robot = quadruped("go2")
    lines = ['<robot name="boxes">', f'<link name="base">{_BOX.format("0.4 0.1 0.1")}</link>']
    for leg, (x, y, z), (_, side) in zip(FEET, legs(robot).hips_m.tolist(), FOOT_SIGNS, strict=True):
        aside, link = side * robot.hip_offset_m, robot.link_m
        lines += [
            f'<link name="{leg}_hip"/><link name="{leg}_rotor"/>',
            f'<link name="{leg}_thigh">{_BOX.format("0.03 0.03 0.2")}</link>',
            f'<link name="{leg}_calf">{_BOX.format("0.02 0.02 0.2")}</link>',
            f'<link name="{leg}_foot">{_MESH}</link>',
            _joint(f"{leg}_hip_joint", "revolute", ("base", f"{leg}_hip"), (x, y, z), "1 0 0"),
            _joint(f"{leg}_rotor_joint", "fixed", ("base", f"{leg}_rotor"), (0.1, 0.0, 0.0), "1 0 0"),
            _joint(f"{leg}_thigh_joint", "revolute", (f"{leg}_hip", f"{leg}_thigh"), (0, aside, 0), "0 1 0"),
            _joint(f"{leg}_calf_joint", "revolute", (f"{leg}_thigh", f"{leg}_calf"), (0, 0, -link), "0 1 0"),
            _joint(f"{leg}_foot_joint", "fixed", (f"{leg}_calf", f"{leg}_foot"), (0, 0, -link), "0 1 0"),
        ]
    return "\n".join([*lines, "</robot>"])


def _joint(name: str, kind: str, links: tuple[str, str], place: tuple[float, float, float], axis: str) -> str:
    at = " ".join(str(one) for one in place)
    return (
        f'<joint name="{name}" type="{kind}"><origin xyz="{at}" rpy="0 0 0"/><parent link="{links[0]}"/>'
        f'<child link="{links[1]}"/><axis xyz="{axis}"/></joint>'
    )


_CASSIE = (
    ("hip-roll", "pelvis", "roll-op", "0.021 {y}0.135 1.01 0 1.5708 0", "0 0 1"),
    ("hip-yaw", "hip-roll", "yaw-op", "-0.049 {y}0.135 1.01 0 0 0", "0 0 -1"),
    ("hip-pitch", "hip-yaw", "pitch-op", "-0.049 {y}0.135 0.92 0 1.5708 -1.5708", "0 0 1"),
    ("knee", "hip-pitch", "knee-op", "-0.049 {y}0.1305 0.8 -1.5708 0.7854 3.1416", "0 0 1"),
    ("shin", "knee", "knee-shin-joint", "-0.058383 {y}0.1305 0.72357 -1.5708 0.7854 3.1416", "0 0 1"),
    ("tarsus", "shin", "shin-tarsus-joint", "-0.35166 {y}0.1305 0.402 1.5708 1.3439 0", "0 0 1"),
    ("heel-spring", "tarsus", "tarsus-spring-joint", "-0.38432 {y}0.12958 0.40749 1.6 -1.3734 -0.1", "0 0 1"),
    ("foot-crank", "tarsus", "tarsus-crank-joint", "-0.37174 {y}0.10775 0.33784 1.5708 1.3439 0", "0 0 1"),
    ("foot", "tarsus", "foot-op", "-0.29886 {y}0.1305 -0.0045361 1.5708 1.3439 0", "0 0 1"),
    ("plantar-rod", "foot-crank", "crank-rod-joint", "-0.35937 {y}0.11566 0.28425 1.5708 1.3439 0", "0 0 1"),
    ("achilles-rod", "heel-spring", "achilles-spring-joint", "-0.049 {y}0.09 0.92 0 0.91441 3.1416", "0 0 1"),
)
"""Links of a leg with their poses at angles of 0: link, carrier, joint, x y z roll pitch yaw, axis."""


def write_cassie(share: Path) -> Path:
    """Write an SDF of Cassie's joints where the package of robots has its; return it."""
    path = share / PACKAGE / "robots" / "cassie_description" / "robots" / "cassie_v2.sdf"
    path.parent.mkdir(parents=True)
    lines = ['<sdf version="1.6"><model name="boxes">', _link("pelvis", "0 0 1.01 0 0 0")]
    for side, sign in (("left", ""), ("right", "-")):
        for link, parent, joint, pose, axis in _CASSIE:
            carrier = parent if parent == "pelvis" else f"{side}-{parent}"
            lines += [
                _link(f"{side}-{link}", pose.format(y=sign)),
                f'<joint name="{side}-{joint}" type="revolute"><parent>{carrier}</parent><child>{side}-{link}</child>'
                f"<axis><xyz>{axis}</xyz></axis></joint>",
            ]
    path.write_text("\n".join([*lines, "</model></sdf>"]))
    return path


def _link(name: str, pose: str) -> str:
    box = "<visual name='v'><geometry><box><size>0.06 0.06 0.06</size></box></geometry></visual>"
    return f'<link name="{name}"><pose>{pose}</pose>{box}</link>'


def _tetrahedron(size: float) -> bytes:
    """Return a binary STL file."""
    o, x, y, z = (0.0, 0.0, 0.0), (size, 0.0, 0.0), (0.0, size, 0.0), (0.0, 0.0, size)
    faces = [(o, y, x), (o, x, z), (o, z, y), (x, y, z)]
    triangles = [struct.pack("<12fH", 0, 0, 0, *a, *b, *c, 0) for a, b, c in faces]
    return b"\0" * 80 + struct.pack("<I", len(faces)) + b"".join(triangles)
