# SPDX-License-Identifier: Apache-2.0
"""The measures see what is wrong, and the bounds let nothing worse pass."""

from __future__ import annotations

import numpy as np
import pytest
import quality_bounds
from families import family
from measures import matching_errors
from outlines import distances, farthest, inside, is_simple, protrusion, sampled, turns_of
from quality_table import COLUMNS, Row
from quality_targets import TARGETS, Survey, foot

SQUARE = np.array([(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)])

GOOD = {
    "drawings": 4.0, "vertices": 300.0, "valid": 1.0, "encloses": 1.0, "steiner": 2.0,
    "angle_median": 40.0, "angle_p5": 20.0, "angle_worst": 8.0, "folded_rigid": 0.0,
    "edge_rms_rigid": 0.03, "error": 0.5, "worst_error": 0.7, "ghosts": 65.0,
    "confidence": 0.9, "seconds": 1.0,
}  # fmt: skip


def row(name: str = "g", kind: str = "sprite", **changed: float) -> Row:
    return Row(name, kind, {**GOOD, **changed})


def test_rings_tell_inside_distance_and_place():
    assert inside(SQUARE, np.array([(1.0, 1.0), (5.0, 1.0)])).tolist() == [True, False]
    assert distances(np.array([(2.0, 1.0), (7.0, 8.0)]), SQUARE).tolist() == [1.0, 5.0]
    assert turns_of(np.array([(4.0, 2.0), (0.0, 1.0)]), SQUARE).tolist() == [0.375, 0.9375]
    assert is_simple(SQUARE) and not is_simple(SQUARE[[0, 2, 1, 3]])
    assert len(sampled(SQUARE)) == 500


def test_a_corner_outside_the_rim_is_seen_and_so_is_an_edge_across_a_notch():
    assert protrusion(SQUARE, 1.5 * SQUARE - 1.0) == 0.0
    assert protrusion(1.5 * SQUARE - 1.0, SQUARE) == pytest.approx(2**0.5)
    notch = [(1.0, -1.0), (2.0, 2.0), (3.0, -1.0)]
    notched = np.insert(1.5 * SQUARE - 1.0, 1, notch, axis=0)
    assert inside(notched, SQUARE).all()
    assert protrusion(SQUARE, notched) == pytest.approx(2.0)
    assert farthest(SQUARE, notched) == pytest.approx(2.0)


class Matched:
    """Stands for a session whose matching is known."""

    def __init__(self, arcs: dict[str, np.ndarray]) -> None:
        self.arcs = arcs

    def suggest(self, samples: int, rotation: str) -> Matched:
        return self


def around(ring: np.ndarray, start: float, count: int = 256) -> np.ndarray:
    at = (start + np.arange(count) / count) % 1.0
    share = np.append(np.arange(len(ring)), len(ring)) / len(ring)
    closed = np.vstack([ring, ring[:1]])
    return np.stack([np.interp(at, share, closed[:, k]) for k in range(2)], axis=1)


@pytest.mark.parametrize("shift", [0.0, 0.01, 0.25, -0.1])
def test_a_matching_that_is_shifted_is_off_by_the_shift(shift):
    places = {"a": SQUARE, "b": 2.0 * SQUARE + 7.0}
    session = Matched({"a": around(SQUARE, 0.3), "b": around(2.0 * SQUARE + 7.0, 0.3 + shift)})
    errors = matching_errors(session, places)
    assert errors[0, 1] == pytest.approx(abs(shift), abs=1e-9)
    assert errors[1, 0] == pytest.approx(abs(shift), abs=1e-9)
    assert errors[0, 0] == pytest.approx(0.0, abs=1e-9)


def test_known_places_of_unlike_orientation_are_far_off():
    group = family("articulated").group(2, seed=3)
    ring = group.rings["a"]
    arcs = {"a": around(ring, 0.0), "b": around(ring[::-1], 0.0)}
    assert matching_errors(Matched(arcs), {"a": ring, "b": ring})[0, 1] > 0.1


def test_a_value_keeps_the_bounds_that_it_made():
    bounds = {"g": quality_bounds.of_row(row())}
    assert quality_bounds.row_regressions(row(), bounds) == []


@pytest.mark.parametrize(
    "column", [c for c in COLUMNS if c.better != "neither"], ids=lambda c: c.key
)
def test_a_regression_names_group_column_value_and_bound(column):
    bounds = {"g": quality_bounds.of_row(row())}
    bound = bounds["g"][column.key]
    assert quality_bounds.row_regressions(row(**{column.key: bound}), bounds) == []
    worse = bound - 0.5 if column.better == "more" else bound + 0.5
    (message,) = quality_bounds.row_regressions(row(**{column.key: worse}), bounds)
    for part in ("g: ", column.header, f"{worse:.4g}", f"{bound:g}"):
        assert part in message


def test_a_measure_that_vanished_and_a_group_without_bounds_are_regressions():
    bounds = {"g": quality_bounds.of_row(row())}
    without = {key: value for key, value in GOOD.items() if key != "ghosts"}
    (message,) = quality_bounds.row_regressions(Row("g", "sprite", without), bounds)
    assert "ghosts" in message and "no longer" in message
    (message,) = quality_bounds.row_regressions(row("new"), bounds)
    assert "new" in message


def test_no_bound_over_all_groups_is_looser_than_a_target_that_is_reached():
    reached = quality_bounds.of_targets(Survey([row(angle_median=34.1)], []))
    missed = quality_bounds.of_targets(Survey([row(angle_median=33.9)], []))
    assert reached["angle_median"] == 34.0
    assert missed["angle_median"] == 33.4
    assert set(reached) <= {target.key for target in TARGETS}


def test_tightening_keeps_the_better_bound_of_each():
    old = {"steiner": 5.0, "angle_worst": 7.0}
    new = {"steiner": 9.0, "angle_worst": 8.0, "angle_p5": 12.0}
    assert quality_bounds.tightened(old, new) == {
        "steiner": 5.0, "angle_worst": 8.0, "angle_p5": 12.0,
    }  # fmt: skip


def test_a_target_that_is_not_reached_is_listed_as_such():
    assert "not reached" not in foot(Survey([row()], []))
    assert "| 50 | ≥ 60 | not reached |" in foot(Survey([row(ghosts=50.0)], []))
