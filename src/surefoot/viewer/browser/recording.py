"""Anything that moves in three dimensions, recorded as one page that opens from a file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from surefoot.viewer.browser.page import Cameras, server, write_page

_LAST_S = 1.0


class Moving(Protocol):
    """What was drawn into a scene, and can show any of its moments."""

    @property
    def time_s(self) -> NDArray[np.float64]:
        """Return its moments, ascending."""

    def show(self, frame: int) -> None:
        """Show a moment."""

    def caption(self, frame: int) -> str:
        """Say in a line what happens then."""

    def notes(self) -> tuple[str, ...]:
        """Say what is drawn otherwise than it was planned or logged."""

    def cameras(self) -> Cameras:
        """Return places to look from, by name; the first one is shown at the beginning."""


def write_recording(path: Path, draw: Callable[[Any], Moving]) -> tuple[str, ...]:
    """Write what moves as one self-contained page with a time slider, a play button and places to look from.

    Args:
        path: of the HTML file.
        draw: draws into a viser scene.

    Returns:
        What is drawn otherwise than it was planned or logged; the page says it too.

    Raises:
        InputError: the file cannot be written.
        BackendMissing: viser is not installed.
    """
    with server() as running:
        moving = draw(running.scene)
        moving.show(0)
        serializer = running.get_scene_serializer()
        begin_s = float(moving.time_s[0])
        pauses_s = np.diff(moving.time_s, append=moving.time_s[-1] + _LAST_S)
        captions: list[tuple[float, str]] = []
        for frame, pause_s in enumerate(pauses_s):
            moving.show(frame)
            text = moving.caption(frame)
            if not captions or captions[-1][1] != text:
                captions.append((round(float(moving.time_s[frame]) - begin_s, 4), text))
            serializer.insert_sleep(max(0.0, float(pause_s)))
        write_page(path, serializer, moving.cameras(), captions, moving.notes())
    return moving.notes()
