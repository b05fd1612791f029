"""Plans for legged robots that provably neither fall nor collide, and get their task done."""

from __future__ import annotations

__version__ = "0.1.0"
