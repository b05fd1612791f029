"""``surefoot view strategy.json --html``: a page on which the strategy of a specification can be asked and played."""

from __future__ import annotations

import base64
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from surefoot.compute import write_text_whole
from surefoot.errors import InputError
from surefoot.games.ranking_listing import listed
from surefoot.logic.ranking_file import load_ranking
from surefoot.logic.strategy_file import load_strategy
from surefoot.logic.transducer import Transducer
from surefoot.viewer.browser.page import script
from surefoot.viewer.pages.ranking import write_ranking_page

MOST_NUMBERS = 3_000_000
MOST_LISTED_MOVES = 5_000
"""Of rankings with more moves of the environment, a page shows the layers."""

_ARRAYS = {"values": "<i4", "memory": "<i4", "first": "<i4", "successors": "<i4", "initial": "<i4", "moves": "<i4"}


def write_gr1_page(strategy: Path, path: Path) -> Path:
    """Write a strategy as one page that opens from a file.

    Args:
        strategy: the JSON file of a listed strategy, of the system or of the environment.
        path: of the HTML file.

    Raises:
        InputError: the strategy cannot be read, or is too large for a page.
    """
    return _write(strategy, load_strategy(strategy).transducer, path)


def write_gr1_ranking_page(strategy: Path, path: Path) -> Path:
    """Write a ranking as one page: with all its states where they are few, else with its layers and a play.

    Args:
        strategy: the JSON file of a ranking.
        path: of the HTML file.

    Raises:
        InputError: the ranking cannot be read or played.
    """
    saved = load_ranking(strategy)
    try:
        transducer = listed(saved.ranking, saved.origin.semantics, most=MOST_LISTED_MOVES)
    except ValueError as problem:
        message = f"cannot be played: {problem}; check it with: surefoot verify"
        raise InputError(message, source=strategy) from problem
    if transducer is None:
        return write_ranking_page(strategy, saved, path)
    return _write(strategy, transducer, path)


def _write(strategy: Path, transducer: Transducer, path: Path) -> Path:
    numbers = transducer.values.size + transducer.successors.size
    if numbers > MOST_NUMBERS:
        message = f"holds {numbers} numbers, and a page at most {MOST_NUMBERS}; surefoot simulate plays it"
        raise InputError(message, source=strategy)
    page = files("surefoot.viewer.pages").joinpath("gr1.html").read_text("utf-8")
    write_text_whole(path, page.replace("/*DATA*/", script(_data(strategy.name, transducer))))
    return path


def _data(name: str, transducer: Transducer) -> dict[str, Any]:
    arrays = {
        key: base64.b64encode(np.ascontiguousarray(array, kind).tobytes()).decode()
        for key, kind in _ARRAYS.items()
        if (array := getattr(transducer, key)) is not None
    }
    return {
        "name": name,
        "player": transducer.player,
        "names": [variable.name for variable in transducer.variables],
        "booleans": [variable.is_boolean for variable in transducer.variables],
        "inputs": transducer.inputs,
        "moves": None,
        **arrays,
    }
