# SPDX-License-Identifier: Apache-2.0
"""Whatever the polygons are, the answer is a valid mesh, or an error that says what is wrong."""

from __future__ import annotations

import numpy as np
import posespace
import pytest
from exact_mesh_checks import assert_valid_in_every_drawing
from measures import enclosure
from nasty_polygons import SIMPLE, TANGLED
from outlines import is_simple

TIMEOUT = 60.0  # seconds for what takes some: a build must end, here however slow the machine


@pytest.fixture
def session(client):
    session = client.create_session()
    yield session
    session.delete()


@pytest.mark.parametrize("name", SIMPLE)
def test_simple_polygons_get_a_valid_mesh_that_encloses_them(session, name):
    for shape_id, ring in SIMPLE[name].items():
        assert is_simple(ring), shape_id
        session.put_shape(shape_id, polygon=ring)
    session.build(target_edge_length=0.3, timeout=TIMEOUT)
    mesh = session.mesh()
    assert_valid_in_every_drawing(mesh)
    assert enclosure(mesh).holds
    for shape_id, points in mesh.vertices.items():
        size = np.ptp(points, axis=0).max()
        frame = session.blend(weights={shape_id: 1.0})
        assert np.abs(frame.vertices - points).max() <= 1e-4 * size + 1e-6 * np.abs(points).max()


@pytest.mark.parametrize("name", TANGLED)
def test_tangled_rings_get_a_valid_mesh_or_an_error_that_says_why(session, name):
    session.put_shape("square", polygon=SIMPLE["collinear-runs"]["square"])
    try:
        session.put_shape("tangled", polygon=TANGLED[name])
        session.build(target_edge_length=0.3, timeout=TIMEOUT)
    except (posespace.InvalidDrawing, posespace.InvalidArgument) as error:
        assert error.reason and "tangled" in str(error)
    else:
        assert_valid_in_every_drawing(session.mesh())
        assert session.shape("tangled").warnings
