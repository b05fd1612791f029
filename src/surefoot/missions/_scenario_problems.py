"""Every problem of a scenario file as sentences; the wording is shared, see ``surefoot.documents``."""

from __future__ import annotations

from surefoot.documents import FileProblems as ScenarioError
from surefoot.documents import problems_of

__all__ = ["ScenarioError", "problems_of"]
