"""Reads recordings with a library that did not write them."""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path
from typing import Any

from rosbags.highlevel import AnyReader


def read(path: Path) -> dict[str, list[tuple[float, Any]]]:
    """Return the messages of every topic with their times [s]."""
    found: dict[str, list[tuple[float, Any]]] = defaultdict(list)
    with AnyReader([path]) as reader:
        for connection, time_ns, raw in reader.messages():
            found[connection.topic].append((time_ns / 1e9, reader.deserialize(raw, connection.msgtype)))
    return found
