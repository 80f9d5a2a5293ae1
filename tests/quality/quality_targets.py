# SPDX-License-Identifier: Apache-2.0
"""What meshes and in-betweens should be like, over all groups together."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import posespace
from families import family
from measures import matching_errors
from quality_table import Better, Row

REAL = ("glyph", "silhouette", "sprite", "vector")
RIGHT = 3.0  # % of the perimeter: a matching that is farther off has begun at a wrong place
PAIRS = 40


@dataclass(frozen=True)
class Survey:
    """All that was measured: rows by group, and the matching errors of articulated pairs in % of
    the perimeter."""

    rows: list[Row]
    pair_errors: list[float]

    def real(self, key: str) -> list[float]:
        return [row.values[key] for row in self.rows if row.kind in REAL and key in row.values]


@dataclass(frozen=True)
class Target:
    """`measured` answers None where nothing was measured of it."""

    key: str
    text: str
    better: Better
    limit: float
    slack: float  # that a stored bound leaves beyond the measured value
    digits: int
    measured: Callable[[Survey], float | None]

    def reached(self, value: float) -> bool:
        return value >= self.limit if self.better == "more" else value <= self.limit


def _share(key: str) -> Callable[[Survey], float | None]:
    return lambda survey: (
        100.0 * float(np.mean([row.values[key] for row in survey.rows])) if survey.rows else None
    )


def _median(key: str) -> Callable[[Survey], float | None]:
    return lambda survey: float(np.median(survey.real(key))) if survey.real(key) else None


def _of_few_steiner(survey: Survey) -> float | None:
    found = survey.real("steiner")
    return 100.0 * float(np.mean(np.array(found) <= 7)) if found else None


def _folds(survey: Survey) -> float | None:
    found = survey.real("folded_rigid")
    return sum(found) if found else None


def _pairs_right(survey: Survey) -> float | None:
    errors = np.array(survey.pair_errors)
    return 100.0 * float(np.mean(errors <= RIGHT)) if len(errors) else None


def _pairs_error(survey: Survey) -> float | None:
    right = [error for error in survey.pair_errors if error <= RIGHT]
    return float(np.mean(right)) if right else None


def _glyph_error(survey: Survey) -> float | None:
    found = [r.values["error"] for r in survey.rows if "glyph" in r.kind and "error" in r.values]
    return max(found) if found else None


TARGETS = (
    Target("valid", "valid meshes, % of all groups", "more", 100, 0, 0, _share("valid")),
    Target(
        "encloses", "enclosing and within tolerance, % of all groups", "more", 100, 0, 0,
        _share("encloses"),
    ),
    Target(
        "steiner", "Steiner vertices, median of real groups", "less", 2, 0, 0, _median("steiner")
    ),
    Target(
        "few_steiner", "real groups with at most 7 Steiner vertices, %", "more", 90, 2, 0,
        _of_few_steiner,
    ),
    Target(
        "angle_median", "median angle, median of real groups", "more", 34, 0.5, 1,
        _median("angle_median"),
    ),
    Target(
        "angle_p5", "5th percentile of angles, median of real groups", "more", 18, 0.5, 1,
        _median("angle_p5"),
    ),
    Target(
        "angle_worst", "worst angle, median of real groups", "more", 6, 0.5, 1,
        _median("angle_worst"),
    ),
    Target(
        "folds", "folded in-betweens of all real groups, also of wrongly matched ones", "less", 0,
        1, 0, _folds,
    ),
    Target(
        "edge_rms", "edge rms, median of real groups", "less", 0.045, 0.002, 3,
        _median("edge_rms_rigid"),
    ),
    Target(
        "pairs_right", f"articulated pairs at any rotation matched rightly, % of {PAIRS}", "more",
        95, 0, 1, _pairs_right,
    ),
    Target(
        "pairs_error", "their mean error, % of the perimeter", "less", 0.8, 0.05, 2, _pairs_error
    ),
    Target(
        "glyph_error", "error of letter masters, % of the perimeter, worst group", "less", 1, 0.05,
        2, _glyph_error,
    ),
    Target(
        "ghosts", "ghost loss removed by alignment, %, median of sprite groups", "more", 60, 2, 0,
        _median("ghosts"),
    ),
)  # fmt: skip


def pair_errors(client: posespace.Client) -> list[float]:
    """Matching errors of articulated figures in two poses each, the second turned at random and
    begun at another row, % of the perimeter."""
    errors = []
    for seed in range(1, PAIRS + 1):
        random = np.random.default_rng(seed)
        rings = dict(family("articulated").group(2, seed).rings)
        second = list(rings)[1]
        angle = random.uniform(0, 2 * np.pi)
        cosine, sine = np.cos(angle), np.sin(angle)
        rings[second] = rings[second] @ np.array([[cosine, sine], [-sine, cosine]])
        session = client.create_session()
        for name, ring in rings.items():
            start = int(random.integers(len(ring)))
            session.put_shape(name, polygon=np.roll(ring, start, axis=0))
        found = matching_errors(session, rings, rotation="any")
        errors.append(100 * float(found.sum()) / 2)
        session.delete()
    return errors


def foot(survey: Survey) -> str:
    """The targets as Markdown: what was measured, what was wanted."""
    lines = ["| over all groups | measured | wanted | |", "|---|---|---|---|"]
    for target in TARGETS:
        value = target.measured(survey)
        if value is None:
            continue
        sign = "≥" if target.better == "more" else "≤"
        wanted, outcome = f"{sign} {target.limit:g}", "" if target.reached(value) else "not reached"
        lines.append(f"| {target.text} | {value:.{target.digits}f} | {wanted} | {outcome} |")
    return "\n".join(lines) + "\n"
