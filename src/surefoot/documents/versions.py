"""Versions of formats: whole numbers, and nothing that Python only holds to be equal to them."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field
from pydantic_core import PydanticKnownError


def is_format(given: object, version: int = 1) -> bool:
    """Return whether a value is the number of a format; ``true`` and ``1.0`` are none, though they equal 1."""
    return type(given) is int and given == version


def _whole_one(given: object) -> object:
    if is_format(given):
        return given
    raise PydanticKnownError("literal_error", {"expected": "1"})


FormatOne = Annotated[Literal[1], BeforeValidator(_whole_one), Field(description="version of this format")]
"""The key ``format`` of files of the first format, as a field of pydantic."""
