# SPDX-License-Identifier: Apache-2.0
"""Measures every group of real drawings, and draws contact sheets of them.

    build/venv/bin/python tests/quality/survey.py [--out DIR] [--sheets] [GROUP ...]

Leaves DIR/real_groups.md and, with --sheets, DIR/GROUP.png: the drawings, their meshes, and
in-betweens.  DIR is build/quality unless told otherwise.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import cast

import numpy as np
import posespace
from measures import BLENDS, Blending, angles, blending
from numpy.typing import NDArray
from PIL import Image, ImageDraw
from real_groups import ROOT, Group, all_groups

METHODS = cast("tuple[posespace.BlendMethod, ...]", ("rigid", "paper", "linear"))
_CELL = 220  # pixels of a contact sheet's cell
_PAPER = (250, 248, 243, 255)


@dataclass(frozen=True)
class Row:
    """A group's line in the table; angles in degrees."""

    name: str
    drawings: int
    vertices: int
    steiner: int
    angle_median: float
    angle_p5: float
    angle_worst: float
    blendings: dict[str, Blending]
    seconds: float
    confidence: float


def build(session: posespace.Session, group: Group) -> float:
    """Uploads and builds a group; answers the seconds that the build took."""
    group.upload(session)
    start = time.perf_counter()
    session.build()
    return time.perf_counter() - start


def measure(session: posespace.Session, name: str, seconds: float) -> Row:
    mesh = session.mesh()
    smallest = angles(mesh)
    return Row(
        name=name,
        drawings=len(mesh.shape_ids),
        vertices=mesh.report.vertices,
        steiner=mesh.report.steiner_vertices,
        angle_median=float(np.median(smallest)),
        angle_p5=float(np.percentile(smallest, 5)),
        angle_worst=float(smallest.min()),
        blendings={method: blending(session, mesh, method) for method in METHODS},
        seconds=seconds,
        confidence=min(mesh.report.confidence.values()),
    )


def table(rows: Iterable[Row]) -> str:
    """The rows as Markdown, with totals: sums of folds, medians of the rest."""
    rows = list(rows)
    if not rows:
        return "no groups\n"
    head = (
        "| group | N | V | Steiner | angle median | 5th | worst | folded rigid | paper | linear "
        "| edge rms rigid | paper | linear | confidence | seconds |"
    )
    lines = [head, "|---" * head.count(" | ") + "|---|"]
    lines += [_line(row) for row in rows]
    lines.append(
        _line(
            Row(
                name=f"**{len(rows)} groups: median, folds of {BLENDS * len(rows)}**",
                drawings=int(np.median([row.drawings for row in rows])),
                vertices=int(np.median([row.vertices for row in rows])),
                steiner=int(np.median([row.steiner for row in rows])),
                angle_median=_median(row.angle_median for row in rows),
                angle_p5=_median(row.angle_p5 for row in rows),
                angle_worst=_median(row.angle_worst for row in rows),
                blendings={
                    method: Blending(
                        folded=sum(row.blendings[method].folded for row in rows),
                        edge_rms=_median(row.blendings[method].edge_rms for row in rows),
                    )
                    for method in METHODS
                },
                seconds=_median(row.seconds for row in rows),
                confidence=_median(row.confidence for row in rows),
            )
        )
    )
    return "\n".join(lines) + "\n"


def contact_sheet(session: posespace.Session) -> Image.Image:
    """Drawings; their meshes; halfway from each to the next, and the mean of all."""
    mesh = session.mesh()
    ids = mesh.shape_ids
    sheet = Image.new("RGBA", (_CELL * (len(ids) + 1), 3 * _CELL), _PAPER)
    pen = ImageDraw.Draw(sheet)
    for column, shape_id in enumerate(ids):
        corner = np.array([column * _CELL, 0.0])
        low = mesh.vertices[shape_id].min(axis=0)
        scale = 0.96 * _CELL / float(np.ptp(mesh.vertices[shape_id], axis=0).max())
        view = (*low.tolist(), _CELL / scale, _CELL / scale)
        size = (_CELL, _CELL)
        drawn = session.render(weights={shape_id: 1.0}, size=size, view=view)
        sheet.alpha_composite(Image.fromarray(drawn), (column * _CELL, 0))
        places = (mesh.vertices[shape_id] - low) * scale + corner + (0, _CELL)
        for triangle in mesh.triangles:
            pen.polygon([tuple(places[v]) for v in triangle], outline=(90, 110, 180, 255))
    pairs = [{a: 0.5, b: 0.5} for a, b in zip(ids, [*ids[1:], ids[0]], strict=True) if a != b]
    for column, weights in enumerate([*pairs, dict.fromkeys(ids, 1 / len(ids))]):
        between: NDArray[np.uint8] = session.render(weights=weights, size=(_CELL, _CELL))
        sheet.alpha_composite(Image.fromarray(between), (column * _CELL, 2 * _CELL))
    return sheet


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("groups", nargs="*", metavar="GROUP", help="default: all")
    parser.add_argument("--out", type=Path, default=ROOT / "build/quality")
    parser.add_argument("--sheets", action="store_true", help="draw contact sheets, too")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    rows = []
    with (
        posespace.serve_locally() as server,
        posespace.connect(server.address, timeout=120) as client,
    ):
        for group in all_groups():
            if arguments.groups and group.name not in arguments.groups:
                continue
            session = client.create_session(display_name=group.name)
            try:
                rows.append(measure(session, group.name, build(session, group)))
                print(_line(rows[-1]), flush=True)
                if arguments.sheets:
                    contact_sheet(session).save(arguments.out / f"{group.name}.png")
            except posespace.Error as error:
                print(f"{group.name}: {error}", flush=True)
            session.delete()
    (arguments.out / "real_groups.md").write_text(table(rows))
    print(table(rows).splitlines()[-1] if rows else "no groups")


def _line(row: Row) -> str:
    cells = [
        row.name,
        row.drawings,
        row.vertices,
        row.steiner,
        *(f"{angle:.1f}" for angle in (row.angle_median, row.angle_p5, row.angle_worst)),
        *(row.blendings[method].folded for method in METHODS),
        *(f"{row.blendings[method].edge_rms:.3f}" for method in METHODS),
        f"{row.confidence:.2f}",
        f"{row.seconds:.2f}",
    ]
    return "| " + " | ".join(map(str, cells)) + " |"


def _median(values: Iterable[float]) -> float:
    return float(np.median(list(values)))


if __name__ == "__main__":
    main()
