# SPDX-License-Identifier: Apache-2.0
"""Pictures on their way in and out: files, bytes and arrays."""

from __future__ import annotations

import io
import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from posespace.errors import InvalidDrawing

Picture = str | os.PathLike[str] | bytes | bytearray | memoryview | NDArray[np.uint8]


def file_bytes(file: str | os.PathLike[str] | bytes | bytearray | memoryview) -> bytes:
    """What is in a file, named by its path, or given.  Raises OSError."""
    if isinstance(file, bytes | bytearray | memoryview):
        return bytes(file)
    return Path(file).read_bytes()


def picture_bytes(picture: Picture, name: str) -> bytes:
    """The picture file of a path, its bytes, or an array (H, W, 3 or 4) uint8, rows from the top,
    straight alpha.  `name` is the drawing, for errors.

    Raises InvalidDrawing for other arrays, OSError for files that cannot be read.
    """
    if isinstance(picture, str | os.PathLike | bytes | bytearray | memoryview):
        return file_bytes(picture)
    pixels = np.asarray(picture)
    good = pixels.ndim == 3 and pixels.shape[2] in (3, 4) and pixels.dtype == np.uint8
    if not good or pixels.size == 0:
        raise InvalidDrawing(
            f"shape '{name}': a picture as an array is (H, W, 3) or (H, W, 4) uint8, not "
            f"{pixels.shape} {pixels.dtype}",
            reason="IMAGE_UNDECODABLE",
        )
    return encode_png(pixels)


def encode_png(pixels: NDArray[np.uint8], *, compress_level: int = 1) -> bytes:
    """A PNG file of (H, W, 3 or 4) uint8; level 0 to 9, quick and large to slow and small."""
    file = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(pixels)).save(
        file, format="PNG", compress_level=compress_level
    )
    return file.getvalue()


def decode_png(png: bytes) -> NDArray[np.uint8]:
    """(H, W, 4) uint8 of a PNG file."""
    with Image.open(io.BytesIO(png)) as image:
        return np.array(image.convert("RGBA"))
