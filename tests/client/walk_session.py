# SPDX-License-Identifier: Apache-2.0
"""A session to play with."""

from __future__ import annotations

import posespace
from synthetic_drawings import WALK, figure


def make_walk(client: posespace.Client, session_id: str | None = None) -> posespace.Session:
    """A built session of three figures on a bent line in pose space."""
    session = client.create_session(session_id)
    for name, pose in WALK.items():
        session.put_shape(name, image=figure(**pose))
    session.set_placements({"stand": (0, 0), "step": (1, 0.2), "wave": (0.4, 1)})
    session.build()
    return session
