"""The first compilation of the engine: seconds, once on a machine."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from surefoot.games.arena import Arena, reachable
from surefoot.games.explicit import solve

KERNELS = ("reverse", "explore", "attract", "hold", "best_edges")


def warm_up() -> None:
    """Compile the engine, or load what was compiled before, by solving a game of four nodes that needs all of it."""
    arena = Arena(
        system=np.array([True, False, True, False]),
        first=np.array([0, 1, 3, 4, 4]),
        successors=np.array([1, 0, 2, 2]),
        lost=np.array([False, False, False, True]),
        goals=np.array([[False, False, True, False]]),
        justices=np.array([[False, False, True, True]]),
    )
    reachable(arena, 0)
    solve(arena)


def is_compiled() -> bool:
    """Return whether the next call of the engine will probably not compile; see ``is_kept``."""
    return is_kept(Path(__file__).with_name("_kernels.py"), KERNELS)


def is_kept(source: Path, kernels: Iterable[str]) -> bool:
    """Return whether compiled functions of a file will probably not be compiled again; costs a look into some folders.

    It looks for the files that numba keeps beside the file or in its own folders, and does not import numba. Code
    kept by another version of numba or for another processor counts too, so the answer is for a message, not for more.
    """
    return {path.name.split(".")[1].split("-")[0] for path in _kept_code(source)}.issuperset(kernels)


def _kept_code(source: Path) -> list[Path]:
    """Return numba's index files of a source file for this Python, as far as they are newer than the source."""
    pattern = f"{source.stem}.*.py{sys.version_info.major}{sys.version_info.minor}*.nbi"
    kept = [path for folder in _cache_folders(source) for path in folder.glob(pattern)]
    changed_s = source.stat().st_mtime
    return [path for path in kept if path.stat().st_mtime >= changed_s]


def _cache_folders(source: Path) -> list[Path]:
    """Return where numba keeps the compiled code of a file, in the order in which it looks."""
    chosen = os.environ.get("NUMBA_CACHE_DIR")
    if chosen:
        return list(Path(chosen).glob(f"{source.parent.name}_*"))
    home = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return [source.parent / "__pycache__", *(home / "numba").glob(f"{source.parent.name}_*")]
