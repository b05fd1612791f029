"""One decision of the engine in a process of its own, as the benchmarks time it."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

LIMIT_S = 60


def decide(path: Path, limit_s: int = LIMIT_S) -> dict[str, Any]:
    """Decide one specification in a process of its own; return what ``surefoot synth --json`` prints."""
    command = [sys.executable, "-m", "surefoot.cli", "synth", str(path), "--realizability-only", "--json"]
    command += ["--time-limit", str(limit_s)]
    found = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603
    value = json.loads(found.stdout)
    if "verdict" not in value:
        raise RuntimeError(f"{path}: {value}")
    return dict(value)
