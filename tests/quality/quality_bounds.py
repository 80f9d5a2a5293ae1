# SPDX-License-Identifier: Apache-2.0
"""Stored bounds of what is measured, so that no change makes meshes worse unseen.

A bound is the measured value and a margin, the `slack` of its column or target, which is for
machines that round otherwise.  A bound over all groups is never looser than a target that was
reached.  `survey.py --tighten` and `--accept` write them; README.md says when.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Iterator
from pathlib import Path

from quality_table import COLUMNS, Better, Row
from quality_targets import TARGETS, Survey

FILE = Path(__file__).with_name("bounds.json")
OVER_ALL = "over all groups"  # where bounds of the targets stand among those of the groups

Bounds = dict[str, dict[str, float]]  # group -> measure -> bound


def load(file: Path = FILE) -> Bounds:
    bounds: Bounds = json.loads(file.read_text())
    return bounds


def save(bounds: Bounds, file: Path = FILE) -> None:
    file.write_text(json.dumps(bounds, indent=2, sort_keys=True) + "\n")


def of_row(row: Row) -> dict[str, float]:
    """The bounds that a group's values deserve."""
    return {
        column.key: _beyond(row.values[column.key], column.better, *column.slack, column.digits)
        for column in COLUMNS
        if column.better != "neither" and column.key in row.values
    }


def of_targets(survey: Survey) -> dict[str, float]:
    found = {}
    for target in TARGETS:
        value = target.measured(survey)
        if value is None:
            continue
        bound = _beyond(value, target.better, target.slack, 0.0, target.digits)
        if target.reached(value):
            bound = (max if target.better == "more" else min)(bound, target.limit)
        found[target.key] = bound
    return found


def row_regressions(row: Row, bounds: Bounds) -> list[str]:
    """What of a group is worse than its bounds, in words."""
    if row.name not in bounds:
        return [f"{row.name}: has no bounds yet; see tests/quality/README.md"]
    return list(
        _worse(
            row.name,
            bounds[row.name],
            ((c.key, c.header, c.better, row.values.get(c.key)) for c in COLUMNS),
        )
    )


def target_regressions(survey: Survey, bounds: Bounds) -> list[str]:
    """What over all groups is worse than its bounds, in words."""
    measured = ((t.key, t.text, t.better, t.measured(survey)) for t in TARGETS)
    return list(_worse(OVER_ALL, bounds.get(OVER_ALL, {}), measured))


def tightened(old: dict[str, float], new: dict[str, float]) -> dict[str, float]:
    """The better of each bound."""
    better = {c.key: c.better for c in COLUMNS} | {t.key: t.better for t in TARGETS}
    pick = {"more": max, "less": min}
    return {key: pick[better[key]](new[key], old.get(key, new[key])) for key in new}


def _worse(
    name: str,
    bounds: dict[str, float],
    measured: Iterable[tuple[str, str, Better, float | None]],
) -> Iterator[str]:
    for key, header, better, value in measured:
        if key not in bounds:
            continue
        bound = bounds[key]
        if value is None:
            yield f"{name}: {header} ({key}) is no longer measured; its bound is {bound:g}"
        elif value < bound if better == "more" else value > bound:
            side = "below" if better == "more" else "above"
            yield f"{name}: {header} ({key}) {value:.4g} is {side} its bound {bound:g}"


def _beyond(value: float, better: Better, slack: float, share: float, digits: int) -> float:
    """The value moved to its worse side by the slack, and rounded that way."""
    unit = 10.0**-digits
    if better == "more":
        return round(math.floor((value - slack - share * abs(value)) / unit + 1e-9) * unit, digits)
    return round(math.ceil((value + slack + share * abs(value)) / unit - 1e-9) * unit, digits)
