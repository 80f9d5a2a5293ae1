# SPDX-License-Identifier: Apache-2.0
"""Outlines in correspondence as one picture: the same colour is the same place."""

from __future__ import annotations

import colorsys
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from posespace.command.contact_sheet import CELL, INK, PAPER, laid_out
from posespace.results import Suggestion

_FINE = 2  # drawn so much larger and made smaller, for smooth lines
_DOT, _START = 4, 10  # radius, pixels of the larger picture


def arc_sheet(found: Suggestion, outlines: Mapping[str, NDArray[np.float64]]) -> Image.Image:
    """The sheet, RGB: each drawing's outline (K, 2), its matched places, and where they start."""
    cells = [(name, _matched(outlines[name], arc)) for name, arc in found.arcs.items()]
    return laid_out([cells])


def _matched(outline: NDArray[np.float64], arc: NDArray[np.float64]) -> Image.Image:
    side = CELL * _FINE
    low, extent = outline.min(axis=0), np.ptp(outline, axis=0)
    zoom = 0.9 * side / extent.max()
    origin = low - (side / zoom - extent) / 2

    cell = Image.new("RGBA", (side, side), PAPER)
    draw = ImageDraw.Draw(cell)
    rim = [(x, y) for x, y in ((outline - origin) * zoom).tolist()]
    draw.line([*rim, rim[0]], fill=INK, width=2)
    for k, (x, y) in enumerate(((arc - origin) * zoom).tolist()):
        red, green, blue = colorsys.hsv_to_rgb(k / len(arc), 0.9, 0.9)
        colour = (round(255 * red), round(255 * green), round(255 * blue), 255)
        radius = _DOT if k else _START
        draw.ellipse((x - radius, y - radius, x + radius, y + radius), fill=colour)
    return cell.resize((CELL, CELL), Image.Resampling.LANCZOS)
