# SPDX-License-Identifier: Apache-2.0
"""Contact sheets: a group's matching, mesh and in-betweens in one picture, for people to judge."""

from __future__ import annotations

import colorsys
from collections.abc import Callable

import numpy as np
import posespace
from numpy.typing import NDArray
from PIL import Image, ImageDraw

_CELL = 220  # pixels
_PAPER = (250, 248, 243, 255)
_POINTS = 128  # marked around every outline

Points = NDArray[np.float64]


def contact_sheet(session: posespace.Session) -> Image.Image:
    """Rows from above: the drawings, with points around them that have the same colour where they
    are matched, the first one ringed; the meshes over the drawings; in-betweens before alignment
    and after it, halfway from each drawing to the next and the mean of all.

    Builds the session anew, without alignment and then with it.
    """
    arcs = session.suggest(samples=_POINTS).arcs
    session.build(align=False)
    before = _in_betweens(session)
    session.build()
    mesh = session.mesh()
    ids = mesh.shape_ids
    sheet = Image.new("RGBA", (_CELL * len(before), 4 * _CELL), _PAPER)
    pen = ImageDraw.Draw(sheet)
    for column, shape_id in enumerate(ids):
        left, top, side = view = _view_of(mesh.vertices[shape_id])
        drawn = Image.fromarray(
            session.render(
                weights={shape_id: 1.0}, size=(_CELL, _CELL), view=(left, top, side, side)
            )
        )
        faint = Image.blend(Image.new("RGBA", drawn.size, _PAPER), _on_paper(drawn), 0.5)
        for line in range(2):
            sheet.paste(faint, (column * _CELL, line * _CELL))
        _mark(pen, _placer(view, column, 0)(arcs[shape_id]))
        places = _placer(view, column, 1)(mesh.vertices[shape_id])
        for triangle in mesh.triangles:
            pen.polygon([tuple(places[v]) for v in triangle], outline=(60, 80, 160, 255))
    for line, pictures in ((2, before), (3, _in_betweens(session))):
        for column, picture in enumerate(pictures):
            sheet.alpha_composite(picture, (column * _CELL, line * _CELL))
    return sheet


def _in_betweens(session: posespace.Session) -> list[Image.Image]:
    """Halfway from each drawing to the next, and the mean of all."""
    ids = session.shape_ids
    pairs = [{a: 0.5, b: 0.5} for a, b in zip(ids, [*ids[1:], ids[0]], strict=True) if a != b]
    return [
        Image.fromarray(session.render(weights=weights, size=(_CELL, _CELL)))
        for weights in [*pairs, dict.fromkeys(ids, 1 / len(ids))]
    ]


def _view_of(points: Points) -> tuple[float, float, float]:
    """Left, top and side of the square that shows them with a margin."""
    low, side = points.min(axis=0), 1.08 * float(np.ptp(points, axis=0).max())
    middle = low + np.ptp(points, axis=0) / 2
    return (float(middle[0] - side / 2), float(middle[1] - side / 2), side)


def _placer(view: tuple[float, float, float], column: int, line: int) -> Callable[[Points], Points]:
    left, top, side = view
    return lambda points: (points - (left, top)) * _CELL / side + (column * _CELL, line * _CELL)


def _mark(pen: ImageDraw.ImageDraw, places: Points) -> None:
    for k, (x, y) in enumerate(places.tolist()):
        red, green, blue = colorsys.hsv_to_rgb(k / len(places), 1.0, 0.9)
        colour = (int(255 * red), int(255 * green), int(255 * blue), 255)
        pen.ellipse((x - 2.5, y - 2.5, x + 2.5, y + 2.5), fill=colour)
    x, y = places[0].tolist()
    pen.ellipse((x - 5, y - 5, x + 5, y + 5), outline=(0, 0, 0, 255), width=2)


def _on_paper(picture: Image.Image) -> Image.Image:
    paper = Image.new("RGBA", picture.size, _PAPER)
    paper.alpha_composite(picture)
    return paper
