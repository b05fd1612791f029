"""Files that people write: YAML and JSON with the lines of their keys, and refusals as sentences."""

from __future__ import annotations

from surefoot.documents.refused import FileProblems, problems_of, unknown_key
from surefoot.documents.yaml_lines import Document, Loc, dotted, read_yaml

__all__ = ["Document", "FileProblems", "Loc", "dotted", "problems_of", "read_yaml", "unknown_key"]
