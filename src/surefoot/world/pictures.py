"""Pictures as grey values: bounded, decoded strip by strip, every defect an InputError."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from surefoot.errors import InputError

if TYPE_CHECKING:
    from PIL.Image import Image

MAX_PIXELS = 100_000_000
_FORMATS = ("PPM", "PNG", "BMP")
_STRIP_PIXELS = 4_000_000


@dataclass(frozen=True, slots=True)
class Strip:
    """Some rows of a picture.

    Attributes:
        rows: where they stand in the picture, row 0 at the top.
        colour: (rows, columns) mean of the colour channels, 0 black to 255 white.
        opacity: (rows, columns) alpha, 0 transparent to 255 opaque; None for a picture without alpha.
    """

    rows: slice
    colour: NDArray[np.float64]
    opacity: NDArray[np.float64] | None


@contextmanager
def opened(path: Path) -> Iterator[Image]:
    """Open a PGM, PNG or BMP file, decoded and in a mode with 1 to 4 plain channels.

    Args:
        path: the picture.

    Raises:
        InputError: the file is missing, is no picture of these kinds, is damaged or has more than 100 million pixels.
    """
    from PIL import Image

    if not _is_file(path):
        raise InputError("there is no such picture file", source=path)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            picture = Image.open(path, formats=_FORMATS)
        except Image.DecompressionBombError as problem:
            raise _too_large(path) from problem
        except Exception as problem:  # decoders raise whatever a damaged file leads them to
            raise InputError("is no readable picture; PGM, PNG and BMP are allowed", source=path) from problem
        with picture:
            if picture.width * picture.height > MAX_PIXELS:
                raise _too_large(path)
            try:
                plain = _plain(picture)
            except Exception as problem:
                reason = str(problem).partition("\n")[0]
                raise InputError(f"the picture is damaged or cut short ({reason})", source=path) from problem
            yield plain


def strips(picture: Image) -> Iterator[Strip]:
    """Yield a picture from top to bottom in strips of bounded size."""
    height = max(1, _STRIP_PIXELS // picture.width)
    for top in range(0, picture.height, height):
        bottom = min(top + height, picture.height)
        values = np.asarray(picture.crop((0, top, picture.width, bottom)))
        yield _strip(slice(top, bottom), values if values.ndim == 3 else values[..., np.newaxis])


def _strip(rows: slice, values: NDArray[np.generic]) -> Strip:
    """Return the mean of the colour channels and the alpha of some rows, scaled to 0..255."""
    levels = 1 if values.dtype == np.uint8 else 65535 // 255
    channels = values.shape[2]
    colours = channels - 1 if channels in (2, 4) else channels
    colour = np.sum(values[..., :colours], axis=2, dtype=np.float64) / (colours * levels)
    opacity = values[..., -1].astype(np.float64) / levels if channels in (2, 4) else None
    return Strip(rows, colour, opacity)


def _plain(picture: Image) -> Image:
    """Return a picture decoded to 8-bit grey or colour with or without alpha, or to 16-bit grey."""
    picture.load()
    mode, transparent = picture.mode, "transparency" in picture.info
    if mode.startswith("I"):  # 16-bit grey, the only pictures of this mode in the allowed formats
        return picture
    if mode in ("L", "LA", "RGB", "RGBA") and not transparent:
        return picture
    if mode in ("1", "L") and not transparent:
        return picture.convert("L")
    if mode in ("1", "L", "P", "PA", "RGB", "RGBA"):
        return picture.convert("RGBA" if transparent or mode == "PA" else "RGB")
    raise ValueError(f"pictures of kind {mode} are not allowed")


def _is_file(path: Path) -> bool:
    """Return whether a path names a regular file; impossible names do not."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def _too_large(path: Path) -> InputError:
    return InputError(
        f"the picture is too large; at most {MAX_PIXELS // 10**6} million pixels are allowed", source=path
    )
