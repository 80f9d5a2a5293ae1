# SPDX-License-Identifier: Apache-2.0
"""An empty session to write to, and a built one to read from."""

from __future__ import annotations

from collections.abc import Iterator

import posespace
import pytest
from walk_session import make_walk


@pytest.fixture
def session(client: posespace.Client) -> Iterator[posespace.Session]:
    """An empty session."""
    made = client.create_session()
    yield made
    client_has_it = any(other.id == made.id for other in client.sessions())
    if client_has_it:
        made.delete()


@pytest.fixture(scope="session")
def walk(client: posespace.Client) -> posespace.Session:
    """A built session that tests only read."""
    return make_walk(client)
