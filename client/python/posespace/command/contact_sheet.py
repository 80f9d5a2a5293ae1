# SPDX-License-Identifier: Apache-2.0
"""One picture of a pose space: each drawing with the mesh over it, and what lies between them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from posespace.results import Mesh, TexturePlacement
from posespace.session import Session

CELL, _CAPTION, _GAP = 240, 22, 12  # pixels
_COLUMNS = 8
_FINE = 2  # meshes are drawn so much larger and made smaller, for smooth lines
PAPER = (250, 248, 243, 255)
INK = (60, 60, 70, 255)
_EDGE = (70, 90, 160, 255)
_RIM = (200, 60, 50, 255)

Between = tuple[str, dict[str, float]]  # caption and weights


def contact_sheet(session: Session, mesh: Mesh, on_cell: Callable[[float], object]) -> Image.Image:
    """The sheet, RGB; `on_cell` hears the fraction done."""
    between = _in_betweens(mesh.shape_ids)
    total = len(mesh.shape_ids) + len(between)
    cells: list[tuple[str, Image.Image]] = []
    for shape_id in mesh.shape_ids:
        on_cell(len(cells) / total)
        cells.append((shape_id, _mesh_over_drawing(session.texture(shape_id), mesh, shape_id)))
    drawn = len(cells)
    for caption, weights in between:
        on_cell(len(cells) / total)
        pixels = session.render(weights=weights, size=(CELL, CELL))
        cells.append((caption, Image.fromarray(pixels)))
    return laid_out([cells[:drawn], cells[drawn:]])


def _in_betweens(ids: list[str]) -> list[Between]:
    """Places that show a pose space: of two drawings the quarters, of more each one's half with the
    next, and the middle of all."""
    if len(ids) == 1:
        return []
    if len(ids) == 2:
        a, b = ids
        return [(f"{w:.0%} {b}", {a: 1 - w, b: w}) for w in (0.25, 0.5, 0.75)]
    halves = [
        (f"{a} + {b}", {a: 0.5, b: 0.5}) for a, b in zip(ids, [*ids[1:], ids[0]], strict=True)
    ]
    return [*halves, ("all alike", dict.fromkeys(ids, 1 / len(ids)))]


def _mesh_over_drawing(texture: NDArray[np.uint8], mesh: Mesh, shape_id: str) -> Image.Image:
    side = CELL * _FINE
    vertices = mesh.vertices[shape_id]
    low, extent = vertices.min(axis=0), np.ptp(vertices, axis=0)
    zoom = 0.94 * side / extent.max()
    origin = low - (side / zoom - extent) / 2  # of the cell, in drawing pixels

    cell = Image.new("RGBA", (side, side), PAPER)
    cell.alpha_composite(_pixels_in_cell(texture, mesh.textures[shape_id], origin, zoom, side))
    cell = Image.blend(Image.new("RGBA", cell.size, PAPER), cell, 0.5)
    draw = ImageDraw.Draw(cell)
    places = [(x, y) for x, y in ((vertices - origin) * zoom).tolist()]
    for a, b, c in mesh.triangles.tolist():
        draw.line([places[a], places[b], places[c], places[a]], fill=_EDGE, width=1)
    for loop in mesh.boundary:
        rim = [places[v] for v in loop.tolist()]
        draw.line([*rim, rim[0]], fill=_RIM, width=3)
    return cell.resize((CELL, CELL), Image.Resampling.LANCZOS)


def _pixels_in_cell(
    texture: NDArray[np.uint8],
    placed: TexturePlacement,
    origin: NDArray[np.float64],
    zoom: float,
    side: int,
) -> Image.Image:
    """A drawing's pixels where they lie in a cell that begins at `origin`."""
    texels = placed.scale / zoom  # a pixel of the cell
    left, top = (origin - np.array(placed.origin)) * placed.scale
    # premultiplied, so that the colour of what is not painted does not bleed in
    shown = Image.fromarray(texture).convert("RGBa")
    if texels > 2:  # an affine map alone skips texels
        shrunk = max(1, int(texels))
        shown = shown.reduce(shrunk)
        texels, left, top = texels / shrunk, left / shrunk, top / shrunk
    return shown.transform(
        (side, side),
        Image.Transform.AFFINE,
        (texels, 0, left, 0, texels, top),
        Image.Resampling.BILINEAR,
    ).convert("RGBA")


def laid_out(groups: list[list[tuple[str, Image.Image]]]) -> Image.Image:
    """Rows of captioned cells; each group begins a row."""
    rows = [
        group[first : first + _COLUMNS]
        for group in groups
        for first in range(0, len(group), _COLUMNS)
    ]
    columns = max(len(row) for row in rows)
    width = columns * (CELL + _GAP) + _GAP
    page = Image.new("RGBA", (width, len(rows) * (CELL + _CAPTION + _GAP) + _GAP), PAPER)
    draw = ImageDraw.Draw(page)
    font = ImageFont.load_default(13)
    for r, row in enumerate(rows):
        top = _GAP + r * (CELL + _CAPTION + _GAP)
        for c, (caption, cell) in enumerate(row):
            left = _GAP + c * (CELL + _GAP)
            page.alpha_composite(cell, (left, top))
            while draw.textlength(caption, font=font) > CELL:
                caption = caption[:-2] + "…"
            draw.text((left + CELL / 2, top + CELL + 4), caption, INK, font, anchor="ma")
    return page.convert("RGB")
