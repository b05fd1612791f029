"""The command line in processes of its own, the second of which finds compiled code in the cache."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path


def surefoot(*arguments: str | Path) -> tuple[int, dict[str, object]]:
    """Run a command with --json; return its exit code and its answer."""
    command = [sys.executable, "-m", "surefoot.cli", *map(str, arguments), "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
    return done.returncode, json.loads(done.stdout)


def test_plan_and_run_twice(scenes: Path, tmp_path: Path) -> None:
    scenario = scenes / "tutorial_mission.yaml"
    code, planned = surefoot("plan", scenario, "-o", tmp_path / "plan")
    assert (code, planned["realizable"], planned["verified"]) == (0, True, True)
    for number in (1, 2):
        run = tmp_path / f"run{number}"
        code, walked = surefoot(
            "run",
            scenario,
            "--plan",
            tmp_path / "plan",
            "--steps",
            "120",
            "--seed",
            "5",
            "--obstacle",
            "random",
            "-o",
            run,
        )
        assert (code, walked["verified"], walked["steps"]) == (0, True, 120)
        assert surefoot("verify", run)[0] == 0


def test_a_time_limit_is_exit_code_3_and_leaves_nothing(scenes: Path, tmp_path: Path) -> None:
    code, answer = surefoot("plan", scenes / "tutorial_mission.yaml", "-o", tmp_path / "plan", "--time-limit", "0")
    assert code == 3
    assert "limit" in str(answer["error"])
    assert list(tmp_path.iterdir()) == []


def test_a_computation_that_was_given_up_does_not_hold_the_process_up() -> None:
    """It may be in compiled code, and the interpreter must not be taken down under it."""
    code = (
        "import atexit, sys, time\n"
        "from surefoot.cli import main\n"
        "from surefoot.compute import Deadline\n"
        "from surefoot.errors import LimitExceeded\n"
        "from surefoot.games.attempts import watched\n"
        "atexit.register(print, 'farewell')\n"
        "try:\n"
        "    watched(lambda: time.sleep({work_s}), Deadline.after(0))\n"
        "except LimitExceeded:\n"
        "    pass\n"
        "sys.argv = ['surefoot', '--version']\n"
        "sys.exit(main())\n"
    )
    for work_s, farewell in ((60, False), (0, True)):
        command = [sys.executable, "-c", code.format(work_s=work_s)]
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=50)
        assert (done.returncode, done.stdout.startswith("surefoot ")) == (0, True)
        assert ("farewell" in done.stdout) == farewell
