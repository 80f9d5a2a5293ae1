# SPDX-License-Identifier: Apache-2.0
"""N-way morphing of 2D drawings: a client of the service posespaced.

    import posespace

    with posespace.serve_locally() as server, posespace.connect(server.address) as client:
        session = client.create_session("tux")
        session.put_shape("stand", image="stand.png")
        session.put_shape("jump", image="jump.png")
        session.set_placements({"stand": (0, 0), "jump": (0, 1)})
        session.build()
        frame = session.blend(at=(0.0, 0.5))      # frame.vertices: (V, 2) float32
        pixels = session.render(at=(0.0, 0.5))    # (512, 512, 4) uint8

Drawing coordinates are pixels, x right, y down; pose-space coordinates have no unit; angles are
radians.  Whatever the service refuses is a posespace.Error.
"""

from posespace.animation_files import save_animation
from posespace.client import Client, connect
from posespace.errors import (
    AlreadyExists,
    Cancelled,
    Conflict,
    DeadlineExceeded,
    Error,
    InternalError,
    InvalidArgument,
    InvalidDrawing,
    NotBuilt,
    NotFound,
    PermissionDenied,
    ResourceExhausted,
    Unauthenticated,
    Unavailable,
)
from posespace.local import LocalServer, serve_locally
from posespace.player import Avatar, Item, Player
from posespace.results import (
    AnimationFrame,
    Build,
    BuildReport,
    Frame,
    GhostLoss,
    Mesh,
    MeshPoint,
    SessionState,
    Shape,
    Suggestion,
    TexturePlacement,
)
from posespace.session import Session

__all__ = [
    "AlreadyExists",
    "AnimationFrame",
    "Avatar",
    "Build",
    "BuildReport",
    "Cancelled",
    "Client",
    "Conflict",
    "DeadlineExceeded",
    "Error",
    "Frame",
    "GhostLoss",
    "InternalError",
    "InvalidArgument",
    "InvalidDrawing",
    "Item",
    "LocalServer",
    "Mesh",
    "MeshPoint",
    "NotBuilt",
    "NotFound",
    "PermissionDenied",
    "Player",
    "ResourceExhausted",
    "Session",
    "SessionState",
    "Shape",
    "Suggestion",
    "TexturePlacement",
    "Unauthenticated",
    "Unavailable",
    "connect",
    "save_animation",
    "serve_locally",
]
