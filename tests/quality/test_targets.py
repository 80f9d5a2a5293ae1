# SPDX-License-Identifier: Apache-2.0
"""What meshes and in-betweens are like over all groups together; runs after the groups' tests."""

from __future__ import annotations

import pytest
import quality_targets
from families import generated_groups
from quality_bounds import target_regressions
from real_groups import all_groups


def test_over_all_groups_nothing_is_worse_than_its_bounds(measured, bounds, client):
    names = {row.name for row in measured.rows}
    real, generated = all_groups(), generated_groups()
    missing = {group.name for group in [*real, *generated]} - names
    if missing or not real:
        pytest.skip(f"not all groups were measured: {len(names)} were, {len(missing)} were not")
    measured.pair_errors.extend(quality_targets.pair_errors(client))
    assert target_regressions(measured, bounds) == []
