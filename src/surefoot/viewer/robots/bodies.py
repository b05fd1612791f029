"""Which body a robot is drawn with: its own meshes when they are installed, or a simple one."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from surefoot.viewer.robots.mesh_files import model_of, own_model
from surefoot.viewer.robots.model import RobotModel


class Body(StrEnum):
    """What a user may ask for."""

    SIMPLE = "simple"
    MESHES = "meshes"


_BIPED, _QUADRUPED = "cassie", "go2"
"""Whose meshes are worn."""


@dataclass(frozen=True, slots=True, eq=False)
class Chosen:
    """The body that is drawn.

    Attributes:
        wearing: whose meshes it wears; None for the simple body.
        model: of that robot.
        remarks: what has to be said of the choice.
    """

    wearing: str | None = None
    model: RobotModel | None = None
    remarks: tuple[str, ...] = ()


SIMPLE = Chosen()


def chosen_body(robot: str, *, biped: bool, asked: Body | None) -> Chosen:
    """Return the body that a robot is drawn with.

    Without a wish it is the robot's own meshes if they are installed. Where meshes are asked for and the robot has
    none, those of a robot of its kind stand in, and that is said.

    Args:
        robot: its name.
        biped: whether it is one.
        asked: what the user wishes; None for no wish.

    Raises:
        BackendMissing: meshes are asked for and are not installed.
    """
    if asked is None:
        own = own_model(robot)
        return SIMPLE if own is None else Chosen(robot, own)
    if asked is Body.SIMPLE:
        return SIMPLE
    wearing = _BIPED if biped else _QUADRUPED
    remark = f"there are no meshes of {robot}: those of {wearing} stand in"
    return Chosen(wearing, model_of(wearing), () if wearing == robot else (remark,))
