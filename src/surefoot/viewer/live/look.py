"""From where each browser looks at a live view."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from surefoot.viewer.browser.page import Cameras


class LookPanel:
    """Buttons for places to look from; some follow what moves.

    Args:
        running: a viser server.
    """

    def __init__(self, running: Any) -> None:
        self.running = running
        self.following: dict[int, Mapping[str, Any]] = {}
        self.buttons: Any = None
        running.gui.configure_theme(show_logo=False, show_share_button=False)
        running.gui.set_panel_label("Surefoot")

    def look_from(self, cameras: Callable[[], Cameras]) -> None:
        """Offer places to look from, as they are when they are asked for; all browsers begin at the first."""
        first, *_ = cameras().values()
        self.running.initial_camera.position = tuple(first["position"])
        self.running.initial_camera.look_at = tuple(first["look_at"])
        self.following.clear()
        for client in self.running.get_clients().values():
            self._look(client, first)
        if self.buttons is not None:
            self.buttons.remove()
        self.buttons = self.running.gui.add_button_group("look", tuple(cameras()))

        @self.buttons.on_click
        def clicked(event: Any) -> None:
            camera = cameras()[event.target.value]
            self.following.pop(event.client.client_id, None)
            if "follow" in camera:
                self.following[event.client.client_id] = camera
            self._look(event.client, camera)

    def go_along(self) -> None:
        """Let the cameras that follow go where what they follow has gone."""
        clients = self.running.get_clients()
        for number, camera in list(self.following.items()):
            if number in clients:
                self._look(clients[number], camera)

    def _look(self, client: Any, camera: Mapping[str, Any]) -> None:
        eye, centre = camera.get("position"), camera.get("look_at")
        if "follow" in camera:
            centre = self.running.scene.get_handle_by_name(camera["follow"]).position
            eye = centre + camera["offset"]
        with client.atomic():
            client.camera.position, client.camera.look_at = eye, centre
