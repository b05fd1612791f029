"""The exceptions of Surefoot; a negative answer is never one of them (see ``verdict``).

SurefootError
├── InputError            what the user gave cannot be used (exit code 2)
├── UnsafeStepError       no walking step satisfies the safety theorems
├── BackendMissing        an optional package is not installed
├── BackendFailed         a solver broke; the problem is attached
├── LimitExceeded         a deadline or a memory limit was reached (exit code 3)
├── CertificateRejected   a checker refused an artefact: always our bug
└── AssumptionViolated    the world broke an assumption at run time
"""

from __future__ import annotations

from pathlib import Path


class SurefootError(Exception):
    """Root of every exception that Surefoot raises on purpose."""


class InputError(SurefootError):
    """What the user gave cannot be used.

    Args:
        message: one sentence that says what is wrong and what is allowed.
        source: the file it stands in, when there is one.
        line: the line in that file, counted from 1.
        key: the dotted key in that file, such as ``grid.cell_size_m``.
    """

    def __init__(
        self, message: str, *, source: str | Path | None = None, line: int | None = None, key: str | None = None
    ) -> None:
        self.message = message
        self.source = source
        self.line = line
        self.key = key
        place = "" if source is None else f"{source}:{line}: " if line is not None else f"{source}: "
        super().__init__(f"{place}{f'{key}: ' if key else ''}{message}")


class UnsafeStepError(SurefootError):
    """No walking step satisfies the safety theorems."""


class BackendMissing(SurefootError):  # noqa: N818 - named after what the user has to do
    """An optional package is not installed.

    Args:
        package: what is missing.
        install: the line that installs it.
    """

    def __init__(self, package: str, install: str) -> None:
        self.package = package
        self.install = install
        super().__init__(f"{package} is not installed; install it with: {install}")


class BackendFailed(SurefootError):  # noqa: N818
    """A solver broke down.

    Args:
        message: what happened.
        problem: the problem that it was given.
    """

    def __init__(self, message: str, problem: object = None) -> None:
        self.problem = problem
        super().__init__(message)


class LimitExceeded(SurefootError):  # noqa: N818
    """A deadline or a memory limit was reached."""


class CertificateRejected(SurefootError):  # noqa: N818
    """A checker refused an artefact that Surefoot itself made."""


class AssumptionViolated(SurefootError):  # noqa: N818
    """The world broke an assumption that the strategy relies on."""
