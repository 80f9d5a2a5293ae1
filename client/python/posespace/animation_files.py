# SPDX-License-Identifier: Apache-2.0
"""Animations as files: animated PNG, GIF, WebP, or one PNG a frame.

Pillow encodes each picture; the files around them are written here, a frame at a time, so that long
animations need no memory and frames are shown for exactly their time.
"""

from __future__ import annotations

import io
import os
import struct
import zlib
from collections.abc import Iterable, Iterator
from fractions import Fraction
from pathlib import Path
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from posespace.errors import InvalidArgument
from posespace.files import whole_file
from posespace.pictures import encode_png

Pixels = NDArray[np.uint8]

SUFFIXES = (".png", ".apng", ".gif", ".webp")
MAX_GIF_FPS = 50  # shorter delays than 0.02 s are shown as 0.1 s by browsers


def save_animation(
    frames: Iterable[Pixels],
    file: str | os.PathLike[str],
    *,
    fps: float = 60,
    loop: bool = False,
) -> int:
    """Writes pictures as an animation and answers how many there were.

        frames = session.render_animation(path, fps=30, loop=True)
        posespace.save_animation(frames, "wave.webp", fps=30, loop=True)

    frames  (H, W, 4) uint8 each, straight alpha, all of one size; taken one at a time.
    file    Its ending decides: .png or .apng (animated PNG), .webp (colours nearly, alpha exactly),
            .gif (255 colours a frame, pixels either there or not), or a pattern such as
            "walk/%04d.png" for one PNG a frame, numbered from 0.
    fps     Frames a second, at most 1,000; of a GIF at most 50.
    loop    Play again and again; else once.

    A file appears when it is whole; until then one of that name stays as it was.

    Raises InvalidArgument for an ending that it does not know, no frames at all, frames of several
    sizes, and rates that a format cannot say; and OSError.
    """
    check_animation_file(file, fps)
    path = Path(file)
    if "%" in path.name:
        return _write_sequence(_checked(frames, path), path)
    write = {".gif": _write_gif, ".webp": _write_webp}.get(path.suffix.lower(), _write_apng)
    with whole_file(path) as out:
        return write(out, _checked(frames, path), fps, loop)


def check_animation_file(file: str | os.PathLike[str], fps: float) -> None:
    """Raises InvalidArgument when save_animation cannot write such a file; cheap."""
    path = Path(file)
    suffix = path.suffix.lower()
    if "%" in path.name:
        try:
            numbered = path.name % 0 != path.name % 1
        except (TypeError, ValueError):
            numbered = False
        if not numbered or suffix != ".png":
            raise InvalidArgument(
                f"{path}: name single frames by a pattern such as %04d.png", reason="INVALID_OPTION"
            )
        return
    if suffix not in SUFFIXES:
        raise InvalidArgument(
            f"{path}: an animation ends in {', '.join(SUFFIXES)}, or is a pattern such as "
            f"DIR/%04d.png",
            reason="INVALID_OPTION",
        )
    if not 0 < fps <= 1000:
        raise InvalidArgument(
            f"fps is {fps:g}, not more than 0 and at most 1000", reason="INVALID_OPTION"
        )
    if suffix == ".gif" and fps > MAX_GIF_FPS:
        raise InvalidArgument(
            f"{path}: a GIF shows at most {MAX_GIF_FPS} frames a second, not {fps:g}; choose a "
            f"lower rate, .png or .webp",
            reason="INVALID_OPTION",
        )


def _checked(frames: Iterable[Pixels], path: Path) -> Iterator[Pixels]:
    """The frames, as long as they fit together."""
    shape = None
    for index, frame in enumerate(frames):
        pixels = np.asarray(frame)
        shape = shape or pixels.shape
        if pixels.ndim != 3 or pixels.shape[2] != 4 or pixels.dtype != np.uint8 or not pixels.size:
            wanted = "(H, W, 4) uint8"
        elif pixels.shape != shape:
            wanted = f"{shape} as the first"
        else:
            yield pixels
            continue
        raise InvalidArgument(
            f"{path}: frame {index} is {pixels.shape} {pixels.dtype}, not {wanted}",
            reason="INVALID_OPTION",
        )
    if shape is None:
        raise InvalidArgument(f"{path}: an animation needs a frame", reason="INVALID_OPTION")


def _delay(index: int, fps: float, units: int, longest: int) -> int:
    """For how many of `units` a second a frame is shown, so that no error adds up."""
    return min(round((index + 1) * units / fps) - round(index * units / fps), longest)


def _write_sequence(frames: Iterator[Pixels], path: Path) -> int:
    count = 0
    for count, pixels in enumerate(frames, start=1):
        with whole_file(path.with_name(path.name % (count - 1))) as out:
            out.write(encode_png(pixels, compress_level=6))
    return count


# Animated PNG: https://www.w3.org/TR/png-3/, fcTL and fdAT.


def _write_chunk(out: BinaryIO, kind: bytes, data: bytes) -> None:
    out.write(struct.pack(">I", len(data)) + kind + data)
    out.write(struct.pack(">I", zlib.crc32(kind + data)))


def _png_chunks(png: bytes) -> Iterator[tuple[bytes, bytes]]:
    at = 8
    while at < len(png):
        (length,) = struct.unpack_from(">I", png, at)
        yield png[at + 4 : at + 8], png[at + 8 : at + 8 + length]
        at += 12 + length


def _write_apng(out: BinaryIO, frames: Iterator[Pixels], fps: float, loop: bool) -> int:
    seconds = min(Fraction(1 / fps).limit_denominator(10_000), Fraction(65_535))
    sequence = count = 0
    animation_control = 0
    for count, pixels in enumerate(frames, start=1):
        height, width = pixels.shape[:2]
        chunks = list(_png_chunks(encode_png(pixels, compress_level=6)))
        if count == 1:
            out.write(b"\x89PNG\r\n\x1a\n")
            _write_chunk(out, *chunks[0])  # IHDR
            animation_control = out.tell()
            _write_chunk(out, b"acTL", struct.pack(">II", 0, 0 if loop else 1))
        control = (sequence, width, height, 0, 0, seconds.numerator, seconds.denominator, 0, 0)
        _write_chunk(out, b"fcTL", struct.pack(">5I2H2B", *control))
        sequence += 1
        for data in (data for kind, data in chunks if kind == b"IDAT"):
            if count == 1:
                _write_chunk(out, b"IDAT", data)
            else:
                _write_chunk(out, b"fdAT", struct.pack(">I", sequence) + data)
                sequence += 1
    _write_chunk(out, b"IEND", b"")
    out.seek(animation_control)
    _write_chunk(out, b"acTL", struct.pack(">II", count, 0 if loop else 1))
    return count


# GIF: https://www.w3.org/Graphics/GIF/spec-gif89a.txt.


def _gif_still(pixels: Pixels) -> bytes:
    """A GIF of 256 colours, of which 255 stands for what is not painted."""
    painted = pixels[..., 3] >= 128
    colours = pixels[..., :3].copy()
    colours[~painted] = pixels[painted][0, :3] if painted.any() else 0  # takes no colour of its own
    indexed = Image.fromarray(colours).quantize(255, dither=Image.Dither.NONE)
    palette = (indexed.getpalette() or []) + [0] * 768
    indices = np.where(painted, np.asarray(indexed), 255).astype(np.uint8)
    still = Image.fromarray(indices)
    still.putpalette(palette[:768])
    file = io.BytesIO()
    still.save(file, format="GIF", optimize=False, interlace=False)
    return file.getvalue()


def _gif_picture(gif: bytes) -> tuple[bytes, bytes]:
    """Palette and compressed pixels of a GIF of one picture."""
    colours = 3 * 2 << (gif[10] & 7)
    at = 13 + colours
    while gif[at] == 0x21:  # extensions
        at += 2
        while gif[at]:
            at += 1 + gif[at]
        at += 1
    return gif[13 : 13 + colours], gif[at + 10 : -1]


def _write_gif(out: BinaryIO, frames: Iterator[Pixels], fps: float, loop: bool) -> int:
    restore_to_background, has_transparency, local_palette_of_256 = 2 << 2, 1, 0x87
    count = 0
    for count, pixels in enumerate(frames, start=1):
        height, width = pixels.shape[:2]
        if count == 1:
            out.write(b"GIF89a" + struct.pack("<2H3B", width, height, 0x70, 0, 0))
            if loop:
                out.write(b"\x21\xff\x0bNETSCAPE2.0\x03\x01\x00\x00\x00")
        palette, data = _gif_picture(_gif_still(pixels))
        delay = _delay(count - 1, fps, 100, 65_535)
        control = restore_to_background | has_transparency
        out.write(b"\x21\xf9\x04" + struct.pack("<BHB", control, delay, 255) + b"\x00")
        out.write(b"\x2c" + struct.pack("<4HB", 0, 0, width, height, local_palette_of_256))
        out.write(palette.ljust(768, b"\x00") + data)
    out.write(b"\x3b")
    return count


# WebP: https://developers.google.com/speed/webp/docs/riff_container.


def _webp_picture(pixels: Pixels) -> bytes:
    """The chunks of a WebP still that hold its pixels."""
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, format="WEBP", quality=90, method=4)
    webp, at, picture = file.getvalue(), 12, b""
    while at < len(webp):
        (length,) = struct.unpack_from("<I", webp, at + 4)
        end = at + 8 + length + length % 2
        if webp[at : at + 4] in (b"ALPH", b"VP8 ", b"VP8L"):
            picture += webp[at:end]
        at = end
    return picture


def _write_webp(out: BinaryIO, frames: Iterator[Pixels], fps: float, loop: bool) -> int:
    def three_bytes(number: int) -> bytes:
        return struct.pack("<I", number)[:3]

    has_animation_and_alpha, each_frame_replaces_the_last = 0x12, 0x02
    count = 0
    for count, pixels in enumerate(frames, start=1):
        size = b"".join(three_bytes(side - 1) for side in pixels.shape[1::-1])
        if count == 1:
            out.write(b"RIFF\x00\x00\x00\x00WEBP")
            out.write(b"VP8X" + struct.pack("<2I", 10, has_animation_and_alpha) + size)
            out.write(b"ANIM" + struct.pack("<2IH", 6, 0, 0 if loop else 1))
        delay = three_bytes(_delay(count - 1, fps, 1000, 2**24 - 1))
        frame = b"\x00" * 6 + size + delay + bytes([each_frame_replaces_the_last])
        frame += _webp_picture(pixels)
        out.write(b"ANMF" + struct.pack("<I", len(frame)) + frame)
    length = out.tell()
    out.seek(4)
    out.write(struct.pack("<I", length - 8))
    return count
