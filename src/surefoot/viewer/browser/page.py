"""The browser page: a viser server on this machine alone, and scenes that open from a file without any server."""

from __future__ import annotations

import json
import socket
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stdout
from importlib.resources import files
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from surefoot.compute import written_whole
from surefoot.errors import BackendMissing, InputError

if TYPE_CHECKING:
    import viser

HOST = "127.0.0.1"
INSTALL = "pip install 'surefoot[view]'"
Cameras = Mapping[str, Mapping[str, Any]]


@contextmanager
def server(port: int | None = None) -> Iterator[viser.ViserServer]:
    """Yield a server that only this machine reaches; it stops when the block ends.

    Args:
        port: to listen on; None takes any free one.

    Raises:
        BackendMissing: viser is not installed.
        InputError: the port is in use.
    """
    viser = _viser()
    with redirect_stdout(StringIO()):  # it greets and says goodbye
        running = viser.ViserServer(host=HOST, port=free_port(port), verbose=False)
    _without_sharing(running)
    try:
        yield running
    finally:
        with redirect_stdout(StringIO()):
            running.stop()


def write_page(
    path: Path, serializer: Any, cameras: Cameras, captions: Sequence[tuple[float, str]], notes: Sequence[str] = ()
) -> None:
    """Write a recorded scene as one file that opens without a network, whole or not at all.

    Args:
        path: of the HTML file.
        serializer: what viser recorded.
        cameras: a button for every name: ``position`` and ``look_at`` in the world, or ``follow``, a node's name.
        captions: ascending moments of the recording [s], each with what is said from then on.
        notes: what is said all the time.
    """
    page = serializer.as_html()
    own = files("surefoot.viewer.browser").joinpath("page.html").read_text("utf-8")
    panel = (
        own.replace("/*CAMERAS*/", script(cameras))
        .replace("/*CAPTIONS*/", script(captions))
        .replace("/*NOTES*/", script(notes))
    )
    end = page.rindex("</body>")
    with written_whole(path) as stream:
        stream.write((page[:end] + panel + page[end:]).encode())


def script(value: object) -> str:
    """Return a value as JavaScript that nothing in it can end."""
    return json.dumps(value).replace("<", "\\u003c")


def _viser() -> Any:
    try:
        import viser
    except ImportError as missing:
        raise BackendMissing("viser", INSTALL) from missing
    return viser


def free_port(port: int | None) -> int:
    """Return a port that nobody listens on: the given one, or any.

    Raises:
        InputError: the port is in use.
    """
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((HOST, port or 0))
        except OSError as problem:
            raise InputError(f"port {port} of {HOST} is in use; choose another one", key="--port") from problem
        return int(probe.getsockname()[1])


def _without_sharing(running: viser.ViserServer) -> None:
    """Take away what lets a client open a public tunnel."""
    from viser import _messages

    for message in (_messages.ShareUrlRequest, _messages.ShareUrlDisconnect):
        running._websock_server._incoming_handlers.pop(message, None)


def colour(name: str) -> tuple[int, int, int]:
    """Return a colour of the pictures, ``#rrggbb``, as three bytes."""
    return tuple(int(name[place : place + 2], 16) for place in (1, 3, 5))  # type: ignore[return-value]


def arrow_colour(name: str) -> tuple[int, int, int]:
    """Return the same for arrows: viser does not correct theirs for screens, so that they would come out too bright."""
    parts = np.array(colour(name)) / 255
    linear = np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)
    return tuple(int(part) for part in np.round(255 * linear))  # type: ignore[return-value]


def add_solid(scene: Any, name: str, solid: Any, hue: str, **looks: Any) -> Any:
    """Add triangles to a scene; nothing when there are none."""
    if len(solid.faces) == 0:
        return None
    return scene.add_mesh_simple(
        name,
        vertices=solid.vertices_m.astype(np.float32),
        faces=solid.faces,
        color=colour(hue),
        flat_shading=True,
        side="double",
        **looks,
    )
