# SPDX-License-Identifier: Apache-2.0
"""An empty session to write to, and a built one to read from."""

from __future__ import annotations

from collections.abc import Iterator

import posespace
import pytest
from synthetic_drawings import WALK, figure


@pytest.fixture
def session(client: posespace.Client) -> Iterator[posespace.Session]:
    """An empty session."""
    made = client.create_session()
    yield made
    client_has_it = any(other.id == made.id for other in client.sessions())
    if client_has_it:
        made.delete()


def make_walk(client: posespace.Client, session_id: str | None = None) -> posespace.Session:
    """A built session of three figures on a bent line in pose space."""
    session = client.create_session(session_id)
    for name, pose in WALK.items():
        session.put_shape(name, image=figure(**pose))
    session.set_placements({"stand": (0, 0), "step": (1, 0.2), "wave": (0.4, 1)})
    session.build()
    return session


@pytest.fixture(scope="session")
def walk(client: posespace.Client) -> posespace.Session:
    """A built session that tests only read."""
    return make_walk(client)
