"""The numbers of the bipeds."""

from __future__ import annotations

import math
from dataclasses import dataclass

from surefoot.errors import InputError

GRAVITY_MPS2 = 9.81


@dataclass(frozen=True, slots=True)
class Biped:
    """What the planners need to know of a biped.

    Attributes:
        name: as scenarios call it.
        apex_height_m: height of the centre of mass above the stance foot at an apex.
        foot_radius_m: of a disc about the foot's centre that holds the foot however it is turned.
        foot_half_length_m: half the foot's length.
        foot_half_width_m: half the foot's width.
        source: where the numbers come from.
    """

    name: str
    apex_height_m: float
    foot_radius_m: float
    foot_half_length_m: float
    foot_half_width_m: float
    source: str

    @property
    def omega_radps(self) -> float:
        """Return the pendulum's rate, the root of gravity over apex height."""
        return math.sqrt(GRAVITY_MPS2 / self.apex_height_m)


_APEX_SOURCE = "Apex height: Shamsah et al., T-RO 2023, Table III."

DIGIT = Biped(
    name="digit",
    apex_height_m=0.985,
    foot_radius_m=0.124,
    foot_half_length_m=0.1175,
    foot_half_width_m=0.04,
    source=f"{_APEX_SOURCE} Foot: 0.235 m x 0.08 m, taking the 0.1175 m and 0.04 m that the RAPTOR library quotes from "
    "the manufacturer's MuJoCo model digit-v3 as half sizes, as MuJoCo gives boxes; the radius is half the diagonal.",
)

CASSIE = Biped(
    name="cassie",
    apex_height_m=0.985,
    foot_radius_m=0.10,
    foot_half_length_m=0.10,
    foot_half_width_m=0.02,
    source=f"{_APEX_SOURCE} Foot: collision capsule of the MuJoCo Menagerie's agility_cassie, an axis of 0.16 m with a "
    "radius of 0.02 m.",
)

_BIPEDS = {robot.name: robot for robot in (DIGIT, CASSIE)}


def biped(name: str) -> Biped:
    """Return a biped by its name.

    Raises:
        InputError: there is none of that name; the message lists those that exist.
    """
    try:
        return _BIPEDS[name]
    except KeyError:
        raise InputError(f"there is no robot {name!r}; there are: {', '.join(_BIPEDS)}", key="robot") from None
