"""The panel of a live view: what moment is shown."""

from __future__ import annotations

import threading
import time
from typing import Any

_WAITING = "waiting for the first step"
_SPEEDS = {"real time": 1.0, "4 times": 4.0, "16 times": 16.0}


class LivePanel:
    """A slider over the time walked so far, and what to do while the log grows.

    Args:
        running: a viser server.
    """

    def __init__(self, running: Any) -> None:
        self.ticked_s, self.now_s = time.monotonic(), 0.0
        self.lock = threading.Lock()
        gui = running.gui
        self.caption = gui.add_markdown(_WAITING)
        self.latest = gui.add_checkbox("latest moment", initial_value=True)
        self.playing = gui.add_checkbox("play", initial_value=False)
        self.speed = gui.add_dropdown("speed", tuple(_SPEEDS))
        self.slider = gui.add_slider("time [s]", 0.0, 1.0, 0.01, 0.0)
        self.slider.on_update(self._moved)
        self.playing.on_update(self._played)

    def advance(self, end_s: float) -> float:
        """Return the moment to show [s], given how long the run is by now."""
        ticked_s = time.monotonic()
        with self.lock:
            passed_s, self.ticked_s = ticked_s - self.ticked_s, ticked_s
            if self.latest.value:
                self.now_s = end_s
            elif self.playing.value:
                self.now_s += passed_s * _SPEEDS[self.speed.value]
            self.now_s = min(self.now_s, end_s)
            if self.slider.max < end_s:
                self.slider.max = round(end_s, 2)
            if abs(self.slider.value - self.now_s) >= self.slider.step / 2:
                self.slider.value = round(self.now_s, 2)
            return self.now_s

    def say(self, text: str) -> None:
        """Say what happens at the moment."""
        if self.caption.content != text:
            self.caption.content = text

    def wait(self) -> None:
        """Say that there is nothing to see yet, or not any more."""
        self.say(_WAITING)

    def _moved(self, event: Any) -> None:
        """Go where a browser moved the slider to."""
        if event.client is not None:
            with self.lock:
                self.latest.value = False
                self.now_s = float(self.slider.value)

    def _played(self, event: Any) -> None:
        """Play from the beginning if there is nothing left to play."""
        if event.client is not None and self.playing.value:
            with self.lock:
                if self.latest.value:
                    self.latest.value, self.now_s = False, 0.0
