# SPDX-License-Identifier: Apache-2.0
"""Pictures of a pose space: meshes, in-betweens, the weight field, an animation."""

from __future__ import annotations

import colorsys
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

PAPER = (250, 248, 243, 255)
INK = (60, 60, 70, 255)


def on_paper(picture: Image.Image) -> Image.Image:
    """A picture with alpha laid on warm white."""
    paper = Image.new("RGBA", picture.size, PAPER)
    paper.alpha_composite(picture)
    return paper


def sheet(rows: Sequence[Sequence[Image.Image]], captions: Sequence[str], cell: int) -> Image.Image:
    """Rows of pictures in square cells, a caption over each row."""
    caption_height = 18
    width = cell * max(len(row) for row in rows)
    page = Image.new("RGBA", (width, len(rows) * (cell + caption_height)), PAPER)
    draw = ImageDraw.Draw(page)
    for r, (row, caption) in enumerate(zip(rows, captions, strict=True)):
        top = r * (cell + caption_height)
        draw.text((6, top + 4), caption, fill=INK)
        for c, picture in enumerate(row):
            small = picture.copy()
            small.thumbnail((cell, cell), Image.Resampling.LANCZOS)
            at = (
                c * cell + (cell - small.width) // 2,
                top + caption_height + (cell - small.height) // 2,
            )
            page.alpha_composite(small, at)
    return page


def mesh_over_drawing(
    drawing: Image.Image,
    vertices: NDArray[np.float64],
    triangles: NDArray[np.int32],
    boundary: Sequence[Sequence[int]],
) -> Image.Image:
    """The mesh of one pose over its faded drawing."""
    picture = Image.blend(Image.new("RGBA", drawing.size, PAPER), on_paper(drawing), 0.45)
    draw = ImageDraw.Draw(picture)
    places = [tuple(xy) for xy in vertices]
    for a, b, c in triangles:
        draw.line([places[a], places[b], places[c], places[a]], fill=(70, 90, 160, 255))
    for loop in boundary:
        draw.line([places[v] for v in [*loop, loop[0]]], fill=(200, 60, 50, 255), width=2)
    return picture


def hue(index: int, count: int) -> NDArray[np.float64]:
    """A colour of pose `index` among `count`, RGB in 0..1."""
    return np.array(colorsys.hsv_to_rgb(index / count, 0.65, 0.95))


def weight_field(weights: NDArray[np.float64], size: int) -> Image.Image:
    """Each point of pose space in the mix of its poses' colours; a line where a weight is a half.

    weights: (size * size, N), rows of the picture from the top.
    """
    count = weights.shape[1]
    colours = np.stack([hue(i, count) for i in range(count)])
    mix = np.clip(np.clip(weights, 0.0, 1.0) @ colours, 0.0, 1.0).reshape(size, size, 3)
    bands = weights.reshape(size, size, count) > 0.5
    steps = (np.diff(bands, axis=0, append=bands[-1:]) != 0) | (
        np.diff(bands, axis=1, append=bands[:, -1:]) != 0
    )
    mix[steps.any(axis=2)] *= 0.8
    return Image.fromarray((mix * 255).astype(np.uint8), "RGB").convert("RGBA")


def mark_placements(
    field: Image.Image,
    placements: Mapping[str, tuple[float, float]],
    box: tuple[float, float, float],
) -> None:
    """A dot and a name at each pose of a field that shows box = (left, top, side)."""
    draw = ImageDraw.Draw(field)
    left, top, side = box
    for name, (x, y) in placements.items():
        px, py = (x - left) / side * field.width, (y - top) / side * field.height
        draw.ellipse([px - 5, py - 5, px + 5, py + 5], fill=(255, 255, 255, 255), outline=INK)
        draw.text((px + 8, py - 6), name, fill=INK)


def smooth_path(corners: NDArray[np.float64], steps: int) -> NDArray[np.float64]:
    """A closed C1 path through the corners: (K, 2) -> (K * steps, 2), Catmull-Rom."""
    p0, p1 = np.roll(corners, 1, axis=0), corners
    p2, p3 = np.roll(corners, -1, axis=0), np.roll(corners, -2, axis=0)
    t = np.linspace(0.0, 1.0, steps, endpoint=False)[None, :, None]
    a, b, c, d = (p[:, None, :] for p in (p0, p1, p2, p3))
    cubic = 0.5 * (
        2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - 3 * c + d - a) * t**3
    )
    return cubic.reshape(-1, 2)
