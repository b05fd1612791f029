"""One short file of numbers per robot, and the joints of a quadruped's legs."""

from __future__ import annotations

from surefoot.robots.biped import Biped, biped
from surefoot.robots.quadruped import Quadruped, quadruped

__all__ = ["Biped", "Quadruped", "biped", "quadruped"]
