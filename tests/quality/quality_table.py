# SPDX-License-Identifier: Apache-2.0
"""The table of what is measured of every group: its columns, its rows, and both as Markdown."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal, Protocol, cast

import numpy as np
import posespace
from measures import BLENDS, angles, blending, enclosure, is_valid, matching_errors
from numpy.typing import NDArray

METHODS = cast("tuple[posespace.BlendMethod, ...]", ("rigid", "paper", "linear"))

Better = Literal["more", "less", "neither"]


@dataclass(frozen=True)
class Column:
    """A measure of a group.

    better  Which values are better; of a measure that is neither, no bound is kept.
    slack   What a stored bound leaves beyond the measured value: so much, and so many times the
            value.
    over    What the last line says of all groups.
    """

    key: str
    header: str
    digits: int
    better: Better = "neither"
    slack: tuple[float, float] = (0.0, 0.0)
    over: Literal["median", "sum", "nothing"] = "median"


# The blends by other methods stand beside ours for comparison; confidence is no merit, as drawings
# that are nothing alike should have little; and seconds depend on the machine.
COLUMNS = (
    Column("drawings", "N", 0),
    Column("vertices", "V", 0, "less", (10, 0.10)),
    Column("valid", "valid", 0, "more", over="sum"),
    Column("encloses", "encloses", 0, "more", over="sum"),
    Column("steiner", "Steiner", 0, "less", (1, 0.10)),
    Column("angle_median", "angle: median", 1, "more", (0.5, 0.02)),
    Column("angle_p5", "5th percentile", 1, "more", (0.5, 0.05)),
    Column("angle_worst", "worst", 1, "more", (0.2, 0.15)),
    Column("folded_rigid", f"folded of {BLENDS}: rigid", 0, "less", over="sum"),
    Column("folded_paper", "paper", 0, over="sum"),
    Column("folded_linear", "linear", 0, over="sum"),
    Column("edge_rms_rigid", "edge rms: rigid", 3, "less", (0.002, 0.05)),
    Column("edge_rms_paper", "paper", 3),
    Column("edge_rms_linear", "linear", 3),
    Column("error", "error, %", 2, "less", (0.05, 0.05)),
    Column("worst_error", "of the worst drawing", 2, "less", (0.05, 0.05)),
    Column("ghosts", "ghosts removed, %", 0, "more", (3, 0.0)),
    Column("confidence", "confidence", 2),
    Column("seconds", "seconds", 2),
)


class Group(Protocol):
    """Drawings to morph among."""

    @property
    def name(self) -> str: ...

    @property
    def kind(self) -> str: ...

    @property
    def places(self) -> dict[str, NDArray[np.float64]] | None: ...

    def upload(self, session: posespace.Session) -> None: ...


@dataclass(frozen=True)
class Row:
    """A group's line; angles in degrees, errors in % of the perimeter.  What does not apply to the
    group is missing from `values`."""

    name: str
    kind: str
    values: dict[str, float]


def measure(session: posespace.Session, group: Group) -> Row:
    """Of a built session."""
    mesh = session.mesh()
    smallest = angles(mesh)
    values: dict[str, float] = {
        "drawings": len(mesh.shape_ids),
        "vertices": mesh.report.vertices,
        "valid": is_valid(mesh),
        "encloses": enclosure(mesh).holds,
        "steiner": mesh.report.steiner_vertices,
        "angle_median": float(np.median(smallest)),
        "angle_p5": float(np.percentile(smallest, 5)),
        "angle_worst": float(smallest.min()),
        "confidence": min(mesh.report.confidence.values()),
        "seconds": sum(mesh.report.seconds.values()),
    }
    for method in METHODS:
        found = blending(session, mesh, method)
        values[f"folded_{method}"] = found.folded
        values[f"edge_rms_{method}"] = found.edge_rms
    places, ghosts = group.places, mesh.report.ghost_loss
    if places is not None:
        errors = 100 * matching_errors(session, places).sum(axis=1) / (len(places) - 1)
        values["error"], values["worst_error"] = float(errors.mean()), float(errors.max())
    if ghosts is not None and group.kind == "sprite":
        values["ghosts"] = 100 * (1 - ghosts.after / ghosts.before)
    return Row(group.name, group.kind, values)


def table(rows: Iterable[Row]) -> str:
    """The rows as Markdown, with a line over all: medians, or sums where it says so."""
    rows = list(rows)
    if not rows:
        return "no groups\n"
    lines = [
        "| group | " + " | ".join(column.header for column in COLUMNS) + " |",
        "|---" * (len(COLUMNS) + 1) + "|",
        *(line(row) for row in rows),
        line(Row(f"**{len(rows)} groups: medians, and sums of counts**", "", _over(rows))),
    ]
    return "\n".join(lines) + "\n"


def line(row: Row) -> str:
    cells = (
        f"{row.values[column.key]:.{column.digits}f}" if column.key in row.values else ""
        for column in COLUMNS
    )
    return f"| {row.name} | " + " | ".join(cells) + " |"


def _over(rows: list[Row]) -> dict[str, float]:
    over = {}
    for column in COLUMNS:
        found = [row.values[column.key] for row in rows if column.key in row.values]
        if found and column.over != "nothing":
            over[column.key] = float(np.median(found) if column.over == "median" else np.sum(found))
    return over
