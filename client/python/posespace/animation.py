# SPDX-License-Identifier: Apache-2.0
"""Paths through pose space, as messages."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

from posespace import messages
from posespace.errors import InvalidArgument
from posespace.messages import Place
from posespace.v1 import pose_service_pb2

Easing = Literal["uniform", "in-out"]
Waypoints = Iterable[Place]  # x and y, or x, y and seconds from the start

_EASINGS = {
    "uniform": pose_service_pb2.EASING_UNIFORM,
    "in-out": pose_service_pb2.EASING_IN_OUT,
}


def waypoint(place: Place, what: str) -> pose_service_pb2.Waypoint:
    """A place on a path: x and y, or x, y and seconds."""
    with messages.argument(what, place):
        if len(place) in (2, 3):
            message = pose_service_pb2.Waypoint(at=messages.point(place[:2], what))
            if len(place) == 3:
                message.time = float(place[2])
            return message
    raise InvalidArgument(
        f"{what} must be x, y or x, y, seconds, not {place!r}", reason="PATH_INVALID"
    )


def animation(
    path: Waypoints,
    fps: float,
    easing: Easing,
    loop: bool,
    duration: float | None,
    options: pose_service_pb2.BlendOptions,
) -> pose_service_pb2.Animation:
    """A path, played."""
    with messages.argument("path", path):
        places = list(path)
    message = pose_service_pb2.Animation(
        path=messages.make(
            pose_service_pb2.Path,
            waypoints=[waypoint(place, f"path[{k}]") for k, place in enumerate(places)],
            loop=loop,
            easing=messages.choice("easing", easing, _EASINGS),
            duration=duration,
        ),
        options=options,
    )
    with messages.argument("fps", fps):
        message.fps = fps
    return message
