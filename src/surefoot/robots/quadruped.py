"""The numbers of the quadrupeds (Zhou et al. 2025, Table II)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from surefoot.errors import InputError

FEET = ("FL", "FR", "RL", "RR")
"""Order of the feet everywhere: front left, front right, rear (hind) left, rear right."""

FOOT_NAMES = ("front left", "front right", "hind left", "hind right")
FOOT_SIGNS = ((1, 1), (1, -1), (-1, 1), (-1, -1))
"""Sign of x and y of every foot in the base frame."""

Triple = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Quadruped:
    """What the foothold programs need to know of a quadruped.

    Attributes:
        name: as problem files call it.
        mass_kg: of the whole robot.
        inertia_kgm2: principal moments about the base.
        foot_reference_m: nominal position of the front left foot in the base frame; the others are mirrored.
        foot_reach_m: largest deviation of a foot from its nominal position, per axis.
        joint_reference_rad: hip abduction, hip pitch and knee at which the legs' Jacobians are taken.
        torque_max_nm: of hip abduction, hip pitch and knee.
        base_torque_max_nm: bound on |I thdd|, per axis.
        link_m: length of thigh and shank.
        hip_offset_m: sideways offset of the leg from the hip's axis.
        source: where the numbers come from.
    """

    name: str
    mass_kg: float
    inertia_kgm2: Triple
    foot_reference_m: Triple
    foot_reach_m: Triple
    joint_reference_rad: Triple
    torque_max_nm: Triple
    base_torque_max_nm: float
    link_m: float
    hip_offset_m: float
    source: str

    @property
    def feet_m(self) -> tuple[Triple, ...]:
        """Return the nominal position of every foot in the base frame, in the order of ``FEET``."""
        x, y, z = self.foot_reference_m
        return tuple((sx * x, sy * y, z) for sx, sy in FOOT_SIGNS)

    @property
    def jacobians(self) -> tuple[tuple[Triple, Triple, Triple], ...]:
        """Return the Jacobian of every foot at the reference joints; rows x, y, z, columns the three joints."""
        return tuple(self._jacobian(sy) for _, sy in FOOT_SIGNS)

    def _jacobian(self, side: int) -> tuple[Triple, Triple, Triple]:
        q0, q1, q2 = self.joint_reference_rad
        reach_x = -self.link_m * (math.sin(q1) + math.sin(q1 + q2))
        reach_z = -self.link_m * (math.cos(q1) + math.cos(q1 + q2))
        shank_x, shank_z = -self.link_m * math.cos(q1 + q2), self.link_m * math.sin(q1 + q2)
        c, s = math.cos(q0), math.sin(q0)
        offset = side * self.hip_offset_m
        return (
            (0.0, reach_z, shank_x),
            (-s * offset - c * reach_z, s * reach_x, -s * shank_z),
            (c * offset - s * reach_z, -c * reach_x, c * shank_z),
        )


_SOURCE = (
    "Zhou et al. 2025 (arXiv 2509.23185), Table II. Links and hip offset: those of the Unitree Go2; base torque: an "
    "assumption, as the paper is silent."
)

GO2 = Quadruped(
    name="go2",
    mass_kg=15.0,
    inertia_kgm2=(0.152, 0.369, 0.388),
    foot_reference_m=(0.1805, 0.1308, -0.29),
    foot_reach_m=(0.15, 0.10, 0.15),
    joint_reference_rad=(0.0, 0.72, -1.44),
    torque_max_nm=(23.5, 23.5, 45.4),
    base_torque_max_nm=30.0,
    link_m=0.213,
    hip_offset_m=0.0955,
    source=_SOURCE,
)

CHOTU = Quadruped(
    name="chotu",
    mass_kg=20.0,
    inertia_kgm2=(0.396, 0.915, 1.107),
    foot_reference_m=(0.2118, 0.210, -0.30),
    foot_reach_m=(0.15, 0.10, 0.15),
    joint_reference_rad=(0.0, 0.72, -1.44),
    torque_max_nm=(23.5, 23.5, 33.5),
    base_torque_max_nm=30.0,
    link_m=0.213,
    hip_offset_m=0.0955,
    source=_SOURCE,
)

_QUADRUPEDS = {robot.name: robot for robot in (GO2, CHOTU)}


def quadruped(name: str) -> Quadruped:
    """Return a quadruped by its name.

    Raises:
        InputError: there is none of that name; the message lists those that exist.
    """
    try:
        return _QUADRUPEDS[name]
    except KeyError:
        raise InputError(
            f"there is no robot {name!r}; there are: {', '.join(quadruped_names())}", key="robot"
        ) from None


def quadruped_names() -> Sequence[str]:
    """Return the names of the quadrupeds that come with Surefoot."""
    return tuple(_QUADRUPEDS)
