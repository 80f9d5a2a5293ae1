# SPDX-License-Identifier: Apache-2.0
"""What the tests here measure, gathered into build/quality/quality.md at their end."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
import quality_bounds
import survey
from quality_targets import Survey


@pytest.fixture(scope="session")
def measured() -> Iterator[Survey]:
    """Filled by the tests."""
    collected = Survey([], [])
    yield collected
    survey.write(collected)


@pytest.fixture(scope="session")
def bounds() -> quality_bounds.Bounds:
    return quality_bounds.load()
