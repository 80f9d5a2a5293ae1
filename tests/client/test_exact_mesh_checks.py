# SPDX-License-Identifier: Apache-2.0
"""The checks themselves see what is wrong."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from exact_mesh_checks import assert_valid_in_every_drawing, crossings


@pytest.fixture(scope="module")
def mesh(walk):
    return walk.mesh()


def test_a_built_mesh_is_valid(mesh):
    assert_valid_in_every_drawing(mesh)


def test_a_flipped_triangle_is_seen(mesh):
    points = mesh.vertices["step"].copy()
    inner = (set(mesh.triangles.ravel()) - set(mesh.boundary[0])).pop()
    points[inner] += 1e4
    with pytest.raises(AssertionError, match=r"'step'.*not positive"):
        assert_valid_in_every_drawing(replace(mesh, vertices={**mesh.vertices, "step": points}))


def test_a_degenerate_triangle_is_seen(mesh):
    points = mesh.vertices["step"].copy()
    points[mesh.triangles[5, 0]] = points[mesh.triangles[5, 1]]
    with pytest.raises(AssertionError, match="not positive"):
        assert_valid_in_every_drawing(replace(mesh, vertices={**mesh.vertices, "step": points}))


def test_a_missing_triangle_is_seen(mesh):
    with pytest.raises(AssertionError, match="rim"):
        assert_valid_in_every_drawing(replace(mesh, triangles=mesh.triangles[1:]))


def test_a_repeated_triangle_is_seen(mesh):
    doubled = np.concatenate([mesh.triangles, mesh.triangles[:1]])
    with pytest.raises(AssertionError, match="twice"):
        assert_valid_in_every_drawing(replace(mesh, triangles=doubled))


@pytest.mark.parametrize(
    ("ring", "crossed"),
    [
        ([[0, 0], [4, 0], [4, 4], [0, 4]], []),
        ([[0, 0], [4, 4], [4, 0], [0, 4]], [(0, 2)]),
        ([[0, 0], [4, 0], [2, 0], [2, 2]], [(0, 1), (0, 2)]),
        ([[0, 0], [4, 0], [4, 4], [2, 0], [0, 4]], [(0, 2), (0, 3)]),
    ],
    ids=["square", "bow tie", "edge folded back", "corner on an edge"],
)
def test_crossings_are_those_one_sees(ring, crossed):
    assert crossings(np.array(ring, dtype=float)) == crossed
