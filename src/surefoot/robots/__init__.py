"""One short file of numbers per robot."""

from __future__ import annotations

from surefoot.robots.biped import Biped, biped

__all__ = ["Biped", "biped"]
