"""``surefoot view strategy.json --html``: a page on which the strategy of a specification can be asked and played."""

from __future__ import annotations

import base64
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from surefoot.compute import write_text_whole
from surefoot.errors import InputError
from surefoot.logic.strategy_file import load_strategy
from surefoot.logic.transducer import Transducer
from surefoot.viewer.page import script

MOST_NUMBERS = 3_000_000

_ARRAYS = {"values": "<i4", "memory": "<i4", "first": "<i4", "successors": "<i4", "initial": "<i4", "moves": "<i4"}


def write_gr1_page(strategy: Path, path: Path) -> Path:
    """Write a strategy as one page that opens from a file.

    Args:
        strategy: the JSON file of a listed strategy, of the system or of the environment.
        path: of the HTML file.

    Raises:
        InputError: the strategy cannot be read, or is too large for a page.
    """
    transducer = load_strategy(strategy).transducer
    numbers = transducer.values.size + transducer.successors.size
    if numbers > MOST_NUMBERS:
        message = f"holds {numbers} numbers, and a page at most {MOST_NUMBERS}; surefoot simulate plays it"
        raise InputError(message, source=strategy)
    page = files("surefoot.viewer").joinpath("gr1.html").read_text("utf-8")
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
