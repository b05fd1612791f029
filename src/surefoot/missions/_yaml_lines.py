"""YAML with the lines of its keys; the reader itself is shared, see ``surefoot.documents``."""

from __future__ import annotations

from surefoot.documents import Document, Loc, dotted, read_yaml

__all__ = ["Document", "Loc", "dotted", "read_yaml"]
