"""Independent checkers; they share no code with what they check."""

from __future__ import annotations

from surefoot.verify.findings import Finding, Report
from surefoot.verify.report import verify_path

__all__ = ["Finding", "Report", "verify_path"]
