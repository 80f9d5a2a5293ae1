# SPDX-License-Identifier: Apache-2.0
"""All drawings turned, scaled, moved, mirrored or uploaded in another order, all together.

Compared is the correspondence: where evenly spaced places along drawing a are carried to on drawing
b, in turns, for all pairs.  Upload in another order changes nothing, and scaling by a power of two,
which rounds nothing, only the size: all numbers are the same.  Other changes round coordinates, and
of two choices that were equal to within rounding the other may be taken; so they change the
correspondence by less than a sample of the matching on average, and of the mesh is asked what a
person sees: it is valid, encloses, and is as large to within a fifth.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import posespace
import pytest
from families import family
from measures import carried_along, enclosure, is_valid
from numpy.typing import NDArray
from outlines import turns_of

Points = NDArray[np.float64]
Change = Callable[[Points], Points]

SAMPLE = 1 / 256  # of the matching, turns

# Two groups whose matching is clear, and one that has many equal choices and Steiner vertices.
GROUPS = {
    "articulated": family("articulated").group(3).rings,
    "glyph": family("glyph-S").group(3).rings,
    "teeth": family("combs").group(6).rings,
}


@dataclass(frozen=True)
class Built:
    rings: dict[str, Points]
    mesh: posespace.Mesh
    arcs: dict[str, Points]

    def carried(self, a: str, b: str) -> Points:
        """Where 256 even places along drawing a are carried to on drawing b, in turns."""
        start, end = (turns_of(self.arcs[name], self.rings[name]) for name in (a, b))
        return carried_along(np.arange(256) / 256, start, end)


@pytest.fixture(scope="module")
def build(client) -> Callable[[dict[str, Points]], Built]:
    def build_one(rings: dict[str, Points]) -> Built:
        session = client.create_session()
        for shape_id, ring in rings.items():
            session.put_shape(shape_id, polygon=ring)
        session.build()
        built = Built(rings, session.mesh(), session.suggest(samples=512).arcs)
        session.delete()
        return built

    return build_one


@pytest.fixture(scope="module", params=GROUPS)
def original(request, build) -> Built:
    return build(GROUPS[request.param])


def turned(angle: float) -> Change:
    c, s = np.cos(angle), np.sin(angle)
    return lambda ring: ring @ np.array([[c, s], [-s, c]])


def expect_same_correspondence(found: Built, original: Built, most: float) -> None:
    for a in original.rings:
        for b in original.rings:
            apart = found.carried(a, b) - original.carried(a, b)
            assert np.abs(apart - np.round(apart)).mean() <= most, (a, b)


def expect_as_good_a_mesh(found: Built, original: Built) -> None:
    assert is_valid(found.mesh)
    assert enclosure(found.mesh).holds
    assert found.mesh.report.vertices == pytest.approx(original.mesh.report.vertices, rel=0.2)
    assert found.mesh.report.outline_vertices == pytest.approx(
        original.mesh.report.outline_vertices, rel=0.2
    )


@pytest.mark.parametrize(
    "change",
    [
        pytest.param(turned(1.0), id="turned"),
        pytest.param(lambda ring: np.stack([-ring[:, 1], ring[:, 0]], axis=1), id="quarter-turn"),
        pytest.param(lambda ring: 2500.0 * ring, id="a-million-pixels"),
        pytest.param(lambda ring: 1e-5 * ring, id="a-few-thousandths-of-a-pixel"),
        pytest.param(lambda ring: ring + np.array([1e4, -3e3]), id="moved"),
    ],
)
def test_a_change_of_all_drawings_together_leaves_the_correspondence(build, original, change):
    found = build({name: change(ring) for name, ring in original.rings.items()})
    expect_same_correspondence(found, original, most=SAMPLE)
    expect_as_good_a_mesh(found, original)


@pytest.mark.parametrize("factor", [2.0**11, 2.0**-16])
def test_scaling_all_drawings_by_a_power_of_two_scales_the_mesh_exactly(build, original, factor):
    found = build({name: factor * ring for name, ring in original.rings.items()})
    assert np.array_equal(found.mesh.triangles, original.mesh.triangles)
    for name, points in original.mesh.vertices.items():
        assert np.array_equal(found.mesh.vertices[name], factor * points)


def test_the_order_of_upload_changes_nothing_but_the_order(build, original):
    found = build(dict(reversed(list(original.rings.items()))))
    assert found.mesh.shape_ids == original.mesh.shape_ids[::-1]
    expect_same_correspondence(found, original, most=1e-9)
    assert np.array_equal(found.mesh.triangles, original.mesh.triangles)
    for name, points in original.mesh.vertices.items():
        assert np.array_equal(found.mesh.vertices[name], points)


def test_mirroring_all_drawings_mirrors_the_correspondence_to_within_a_sample(build, original):
    found = build({name: ring * (-1.0, 1.0) for name, ring in original.rings.items()})
    expect_same_correspondence(found, original, most=SAMPLE)
    expect_as_good_a_mesh(found, original)
