"""A campaign of coverage-guided fuzzing, where atheris is installed (it is no dependency)."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest


@pytest.mark.campaign
@pytest.mark.skipif(importlib.util.find_spec("atheris") is None, reason="atheris is not installed")
def test_readers_survive_a_fuzzing_campaign(tmp_path: Path) -> None:
    script = Path(__file__).with_name("fuzz_readers.py")
    command = [
        sys.executable,
        str(script),
        "-runs=50000",
        "-max_len=400",
        "-timeout=10",
        f"-artifact_prefix={tmp_path}/",
    ]
    found = subprocess.run(command, capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stderr[-2000:]
