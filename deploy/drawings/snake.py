# SPDX-License-Identifier: Apache-2.0
"""The snake, seen from above: one body bent by a heading along it, up to a turn and a quarter.

Length, girth and pattern are the same in every pose, by arc length.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from vector import INK, Drawing, Frame, Tube, closed, line, mix, outline, taper, turn

WIDTH, HEIGHT = 800, 640
LENGTH = 940.0
HEAD_LENGTH = 125.0  # with the tongue
JOINTS = 240  # of the centreline
SCALES, SADDLES = 24, 11

HEAD, TAIL = "#8ccf4d", "#1f8f93"
SADDLE, BELLY, SPOT = "#1d5d68", "#f6ecb0", "#f7b733"
TONGUE = "#e2484d"

GIRTH = taper((0, 20), (0.05, 22), (0.22, 29), (0.5, 29), (1, 3.5))


@dataclass(frozen=True)
class Pose:
    """The body's heading in degrees at u, head 0 to tail 1; right of the canvas is 0."""

    title: str
    heading: Callable[[float], float]


def _curl(u: float, turning: float) -> float:
    """A heading that turns one way all along, a little more in some places."""
    return turning * (u - 0.5) + 10 * math.sin(2 * math.tau * u)


def _coil(u: float) -> float:
    """An Archimedean spiral inwards, after a neck that leads away from it."""
    outer, pitch = 154.0, 76.0 / math.tau
    travelled = LENGTH * max(u - 0.06, 0.0)
    return math.degrees((outer - math.sqrt(outer**2 - 2 * pitch * travelled)) / pitch)


POSES = {
    "wave": Pose("On its way", lambda u: 71 * math.sin(2 * math.tau * u)),
    "curl-up": Pose("Both ends up", lambda u: -_curl(u, 260)),
    "curl-down": Pose("Both ends down", lambda u: _curl(u, 260)),
    "ess": Pose("Two bends", lambda u: 8 - 104 * math.cos(math.tau * u)),
    "spiral": Pose("Coiled up", lambda u: _coil(u) + 150),
}


def draw(name: str) -> Drawing:
    """The snake in one of its POSES."""
    pose = POSES[name]
    picture = Drawing(WIDTH, HEIGHT, f"Snake: {pose.title}", "A snake seen from above.")
    body = Tube(_centreline(pose.heading), GIRTH)
    picture.group("tongue")
    _tongue(picture, body.frame(0.0))
    picture.group("body")
    _body(picture, body)
    picture.group("head")
    _head(picture, body.frame(0.0))
    return picture


def _centreline(heading: Callable[[float], float]) -> list[complex]:
    """The bent body; with its head, in the middle of the canvas."""
    points = [0j]
    for i in range(JOINTS):
        points.append(points[-1] + LENGTH / JOINTS * turn(heading((i + 0.5) / JOINTS)))
    spread = [*points, -HEAD_LENGTH * turn(heading(0))]
    xs, ys = [p.real for p in spread], [p.imag for p in spread]
    middle = complex(min(xs) + max(xs), min(ys) + max(ys)) / 2
    return [p - middle + complex(WIDTH, HEIGHT) / 2 for p in points]


def _body(picture: Drawing, body: Tube) -> None:
    picture.solid(closed(body.ring(60)), TAIL)
    for i in range(SCALES):
        over_the_next = min((i + 1.3) / SCALES, 1.0)
        rows = body.band(i / SCALES, over_the_next, -0.97, 0.97, 3)
        picture.mark(outline(rows), mix(HEAD, TAIL, i / SCALES))
    picture.shade(outline(body.band(0, 1, -0.97, -0.5, 60)), 0.18)
    picture.stroke(line(body.edge(0.74, 0.07, 0.9, 50)), BELLY, 4)
    for i in range(SADDLES):
        u = 0.13 + 0.79 * i / SADDLES
        half = 0.032 * (1 - 0.4 * i / SADDLES)
        for colour, share in ((SADDLE, 1.0), (SPOT, 0.48)):
            along, across = half * share, 0.66 * share
            corners = [(u - along, 0), (u, across), (u + along, 0), (u, -across)]
            picture.mark(closed([body.at(*corner) for corner in corners]), colour)


def _head(picture: Drawing, neck: Frame) -> None:
    """The neck's frame looks back along the body: its x axis points to the tail."""
    half = [(26, 0), (20, 17), (0, 24), (-24, 36), (-50, 36), (-72, 26), (-86, 12), (-90, 0)]
    picture.solid(closed(neck.all(_both_sides(half))), HEAD)
    cross = [(16, 0), (2, 10), (-20, 17), (-38, 0)]
    picture.mark(closed(neck.all(_both_sides(cross))), SADDLE)
    picture.mark(closed(neck.oval(-14, 0, 11, 7)), SPOT)
    for side in (-1, 1):
        picture.mark(closed(neck.oval(-52, side * 22, 13, 12)), INK)
        picture.mark(closed(neck.oval(-52, side * 22, 11, 10)), "#ffffff")
        picture.mark(closed(neck.oval(-55, side * 21, 6.5, 7)), INK)
        picture.mark(closed(neck.oval(-57, side * 21 - 3, 2.3, 2.3)), "#ffffff")
        picture.mark(closed(neck.oval(-80, side * 6, 2.8, 2.2)), mix(HEAD, INK, 0.7))


def _tongue(picture: Drawing, neck: Frame) -> None:
    half = [
        (-76, 0),
        (-78, 5),
        (-100, 4.5),
        (-112, 8),
        (-124, 16),
        (-127, 10),
        (-116, 2),
        (-113, 0),
    ]
    picture.solid(closed(neck.all(_both_sides(half))), TONGUE)


def _both_sides(half: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """A ring symmetric in the x axis, from its half that starts and ends there."""
    return [*half, *[(x, -y) for x, y in half[-2:0:-1]]]
