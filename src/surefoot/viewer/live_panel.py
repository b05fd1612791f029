"""The panel of a live view: what moment is shown, and from where each browser looks at it."""

from __future__ import annotations

import threading
import time
from collections.abc import Mapping
from typing import Any

from surefoot.viewer.page import Cameras

_SPEEDS = {"real time": 1.0, "4 times": 4.0, "16 times": 16.0}


class LivePanel:
    """A slider over the time walked so far, and what to do while the log grows.

    Args:
        running: a viser server.
    """

    def __init__(self, running: Any) -> None:
        self.running = running
        self.ticked_s, self.now_s = time.monotonic(), 0.0
        self.following: dict[int, Mapping[str, Any]] = {}
        self.lock = threading.Lock()
        gui = running.gui
        gui.configure_theme(show_logo=False, show_share_button=False)
        gui.set_panel_label("Surefoot")
        self.caption = gui.add_markdown("waiting for the first step")
        self.latest = gui.add_checkbox("latest moment", initial_value=True)
        self.playing = gui.add_checkbox("play", initial_value=False)
        self.speed = gui.add_dropdown("speed", tuple(_SPEEDS))
        self.slider = gui.add_slider("time [s]", 0.0, 1.0, 0.01, 0.0)
        self.slider.on_update(self._moved)
        self.buttons: Any = None

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

    def show(self, text: str) -> None:
        """Say what happens at the moment, and let cameras that follow go along."""
        if self.caption.content != text:
            self.caption.content = text
        clients = self.running.get_clients()
        for number, camera in list(self.following.items()):
            if number in clients:
                self._look(clients[number], camera)

    def look_from(self, cameras: Cameras) -> None:
        """Offer places to look from; new browsers begin at the first."""
        first = next(iter(cameras.values()))
        self.running.initial_camera.position = tuple(first["position"])
        self.running.initial_camera.look_at = tuple(first["look_at"])
        for client in self.running.get_clients().values():
            self._look(client, first)
        if self.buttons is not None:
            self.buttons.remove()
        self.buttons = self.running.gui.add_button_group("look", tuple(cameras))

        @self.buttons.on_click
        def _(event: Any) -> None:
            camera = cameras[event.target.value]
            self.following.pop(event.client.client_id, None)
            if "follow" in camera:
                self.following[event.client.client_id] = camera
            self._look(event.client, camera)

    def _look(self, client: Any, camera: Mapping[str, Any]) -> None:
        eye, centre = camera.get("position"), camera.get("look_at")
        if "follow" in camera:
            centre = self.running.scene.get_handle_by_name(camera["follow"]).position
            eye = centre + camera["offset"]
        with client.atomic():
            client.camera.position, client.camera.look_at = eye, centre

    def _moved(self, event: Any) -> None:
        """Go where a browser moved the slider to."""
        if event.client is not None:
            with self.lock:
                self.latest.value = False
                self.now_s = float(self.slider.value)
