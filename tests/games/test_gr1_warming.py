from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from gr1_oracle import random_arena

from surefoot.games import _kernels, is_compiled, reachable, solve, warm_up
from surefoot.games.warming import KERNELS


def test_the_list_of_kernels_is_complete() -> None:
    compiled = {name for name, value in vars(_kernels).items() if hasattr(value, "signatures")}
    assert compiled == set(KERNELS)


def test_after_warming_up_nothing_is_compiled_again() -> None:
    warm_up()
    before = {name: list(getattr(_kernels, name).signatures) for name in KERNELS}
    assert all(len(signatures) == 1 for signatures in before.values())
    for seed in range(20):
        arena = random_arena(seed)
        reachable(arena, 0)
        solve(arena)
    assert {name: list(getattr(_kernels, name).signatures) for name in KERNELS} == before


def test_it_knows_whether_the_code_is_kept(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert not is_compiled()
    folder = tmp_path / f"{Path(_kernels.__file__).parent.name}_0123"
    folder.mkdir()
    python = f"py{sys.version_info.major}{sys.version_info.minor}"
    for number, name in enumerate(KERNELS):
        assert not is_compiled()
        (folder / f"_kernels.{name}-{number}.{python}.nbi").touch()
    assert is_compiled()
    os.utime(folder / f"_kernels.{KERNELS[0]}-0.{python}.nbi", (0, 0))
    assert not is_compiled()


def test_numba_keeps_its_code_where_it_is_looked_for(tmp_path: Path) -> None:
    code = "from surefoot.games import is_compiled, warm_up; a = is_compiled(); warm_up(); print(a, is_compiled())"
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", "True"]


def test_importing_the_room_does_not_import_numba() -> None:
    code = "import sys, surefoot.games; print('numba' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
