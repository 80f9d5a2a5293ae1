# SPDX-License-Identifier: Apache-2.0
"""Generated families of drawings, from upload to in-betweens, measured as the real ones are."""

from __future__ import annotations

import pytest
from exact_mesh_checks import assert_valid_in_every_drawing
from families import FAMILIES, GeneratedGroup, family, generated_groups
from outlines import is_simple, signed_area
from quality_bounds import row_regressions
from quality_table import Row, measure

GROUPS = generated_groups()


@pytest.fixture(scope="module", params=GROUPS, ids=[group.name for group in GROUPS])
def row(request, client, measured) -> Row:
    group: GeneratedGroup = request.param
    session = client.create_session(display_name=group.name)
    group.upload(session)
    session.build()
    found = measure(session, group)
    if not found.values["valid"]:
        assert_valid_in_every_drawing(session.mesh())  # says where
    session.delete()
    measured.rows.append(found)
    return found


def test_the_mesh_is_valid_and_encloses_within_tolerance(row):
    assert row.values["valid"] and row.values["encloses"]


def test_a_generated_group_is_no_worse_than_its_bounds(row, bounds):
    assert row_regressions(row, bounds) == []


@pytest.mark.parametrize("name", [f.name for f in FAMILIES])
def test_a_family_draws_simple_positive_rings_with_common_rows(name):
    group = family(name).group(3, seed=5)
    assert len(group.rings) == 3
    for ring in group.rings.values():
        assert is_simple(ring)
        assert signed_area(ring) > 0
    if group.known:
        assert len({len(ring) for ring in group.rings.values()}) == 1
