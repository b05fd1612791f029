"""Commands, called in the test's own process."""

from __future__ import annotations

import json
from typing import Any

import pytest
from typer.testing import CliRunner

from surefoot.cli import main
from surefoot.cli.commands import app


def run(*arguments: object) -> int:
    """Run a command as a shell would; return its exit code."""
    return main([str(one) for one in arguments])


def said(capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    """Return what a command that was run with ``--json`` printed."""
    answer: dict[str, Any] = json.loads(capsys.readouterr().out)
    return answer


def surefoot(*arguments: object) -> tuple[int, str]:
    """Run a command; return exit code and standard output. What it refuses is raised."""
    found = CliRunner().invoke(app, [str(one) for one in arguments])
    if found.exception is not None and not isinstance(found.exception, SystemExit):
        raise found.exception
    return found.exit_code, found.stdout


def printed(*arguments: object) -> str:
    """Run a command that succeeds; return its standard output."""
    code, text = surefoot(*arguments)
    assert code == 0, text
    return text
