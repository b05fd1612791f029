"""Files as documents: YAML with the lines of its keys, JSON objects, and refusals as sentences."""

from __future__ import annotations

from surefoot.documents.json_objects import read_json_object
from surefoot.documents.refused import FileProblems, problems_of, unknown_key
from surefoot.documents.versions import FormatOne, is_format
from surefoot.documents.yaml_lines import Document, Loc, dotted, read_yaml

__all__ = [
    "Document",
    "FileProblems",
    "FormatOne",
    "Loc",
    "dotted",
    "is_format",
    "problems_of",
    "read_json_object",
    "read_yaml",
    "unknown_key",
]
