"""What the doctor looks at: packages, the machine, the cache of compiled code."""

from __future__ import annotations

import os
import platform
import re
import sys
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

_CORE = ("matplotlib", "numba", "numpy", "pillow", "pydantic", "PyYAML", "rich", "scipy", "typer")
_LEAST_PYTHON = (3, 11)


@dataclass(frozen=True, slots=True)
class Extra:
    """An optional part of Surefoot.

    Attributes:
        name: of the extra in pyproject.
        missing: packages of it that are not installed.
        install: the line that installs them.
    """

    name: str
    missing: tuple[str, ...]
    install: str

    @property
    def missing_text(self) -> str:
        """Return what to do, in words."""
        return f"missing {', '.join(self.missing)}; get it with: {self.install}" if self.missing else "installed"


@dataclass(frozen=True, slots=True)
class Surroundings:
    """What the doctor found.

    Attributes:
        versions: of Python, Surefoot and what the core needs; None where a package is missing.
        cores: processors that this process may use.
        memory_mb: physical memory [MB], None if the system does not say.
        openblas_threads: the environment variable, None if it is not set.
        cache_folder: where compiled code is kept.
        cache_writable: whether it can be kept there.
        cache_warm: whether compiled code is there already.
        extras: optional parts.
        complete: whether the core has what it needs.
        advice: what to do if not.
    """

    versions: dict[str, str | None]
    cores: int
    memory_mb: float | None
    openblas_threads: str | None
    cache_folder: Path
    cache_writable: bool
    cache_warm: bool
    extras: tuple[Extra, ...]
    complete: bool
    advice: tuple[str, ...]


def examine() -> Surroundings:
    """Look at packages, machine and caches."""
    versions = {"python": platform.python_version(), **{name: _version(name) for name in ("surefoot", *_CORE)}}
    missing = [name for name, version in versions.items() if version is None]
    advice = [f"{name} (pip install {name.lower()})" for name in missing]
    if sys.version_info < _LEAST_PYTHON:
        advice.append("Python 3.11 or newer")
    folder, writable, warm = _cache()
    return Surroundings(
        versions=versions,
        cores=len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1,
        memory_mb=_memory_mb(),
        openblas_threads=os.environ.get("OPENBLAS_NUM_THREADS"),
        cache_folder=folder,
        cache_writable=writable,
        cache_warm=warm,
        extras=_extras(),
        complete=not advice,
        advice=tuple(advice),
    )


def _version(package: str) -> str | None:
    if package == "surefoot":
        from surefoot import __version__

        return __version__
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


def _memory_mb() -> float | None:
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 1e6
    except (AttributeError, OSError, ValueError):
        return None


def _cache() -> tuple[Path, bool, bool]:
    """Return where numba keeps compiled code, whether it can write there, and whether fresh code is there."""
    package = Path(__file__).parents[1]
    named = os.environ.get("NUMBA_CACHE_DIR")
    folder = Path(named) if named else package
    existing = next(place for place in (folder.absolute(), *folder.absolute().parents) if place.exists())
    return folder, os.access(existing, os.W_OK), any(_is_fresh(index, package) for index in folder.rglob("*.nbi"))


def _is_fresh(index: Path, package: Path) -> bool:
    """Return whether a cache entry, named after the module it belongs to, is newer than that module."""
    sources = [source for source in package.rglob(f"{index.name.split('.')[0]}.py") if source.is_file()]
    return bool(sources) and index.stat().st_mtime >= max(source.stat().st_mtime for source in sources)


def _extras() -> tuple[Extra, ...]:
    """Return the extras that the installed package declares, except the one for its developers."""
    try:
        about = metadata.metadata("surefoot")
    except metadata.PackageNotFoundError:
        return ()
    names = [name for name in about.get_all("Provides-Extra") or [] if name != "dev"]
    wanted = about.get_all("Requires-Dist") or []
    return tuple(_extra(name, wanted) for name in names)


def _extra(name: str, wanted: list[str]) -> Extra:
    packages = [line for line in wanted if re.search(rf"extra\s*==\s*['\"]{re.escape(name)}['\"]", line)]
    missing = [
        found.group() for line in packages if (found := re.match(r"[\w.-]+", line)) and _version(found.group()) is None
    ]
    return Extra(name, tuple(missing), f"pip install 'surefoot[{name}]'")
