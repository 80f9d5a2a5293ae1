# SPDX-License-Identifier: Apache-2.0
"""Shapes with smooth outlines, and the SVG files made of them.

Points are complex numbers, x + 1j * y in pixels, y down: adding moves, multiplying by a unit turns.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise
from xml.sax.saxutils import escape

Points = list[complex]

INK = "#2f2440"
SHADOW = "#3a1f5c"


def turn(degrees: float) -> complex:
    """The unit vector of a heading, clockwise on screen from the x axis."""
    return cmath.rect(1.0, math.radians(degrees))


def mix(a: str, b: str, share: float) -> str:
    """The colour between #rrggbb colours a and b; share 0 is a, 1 is b."""
    pairs = [(int(a[i : i + 2], 16), int(b[i : i + 2], 16)) for i in (1, 3, 5)]
    return "#" + "".join(f"{round(p + (q - p) * share):02x}" for p, q in pairs)


class Frame:
    """A place on the canvas, turned and perhaps mirrored: local points in, canvas points out."""

    def __init__(self, origin: complex, degrees: float = 0.0, hand: float = 1.0) -> None:
        self.origin = origin
        self.degrees = degrees
        self.hand = hand  # -1 where y runs to the left of x.

    def on(self, side: float) -> Frame:
        """The frame itself for side 1; for side -1, its mirror image in its y axis."""
        return self if side > 0 else Frame(self.origin, self.degrees + 180, -self.hand)

    def at(self, x: float, y: float) -> complex:
        return self.origin + complex(x, self.hand * y) * turn(self.degrees)

    def all(self, points: Iterable[tuple[float, float]]) -> Points:
        return [self.at(x, y) for x, y in points]

    def mirrored(self, right_half: Sequence[tuple[float, float]]) -> Points:
        """A symmetric ring from its right half; a half's end on the axis is taken once."""
        left = [(-x, y) for x, y in reversed(right_half) if x != 0]
        return [self.at(x, y) for x, y in [*right_half, *left]]

    def oval(self, x: float, y: float, rx: float, ry: float) -> Points:
        steps = [math.radians(30 * i) for i in range(12)]
        return [self.at(x + rx * math.cos(t), y + ry * math.sin(t)) for t in steps]


class Tube:
    """A limb: a centreline and a radius along it.

    A point of the tube is (u, v): u in [0, 1] by arc length, v in [-1, 1] from its left edge to its
    right one, so what is drawn at (u, v) stays on the same spot of the limb in every pose.
    """

    def __init__(self, centre: Sequence[complex], radius: Callable[[float], float]) -> None:
        self._centre = centre
        self._radius = radius
        self._travelled = [0.0]
        for a, b in pairwise(centre):
            self._travelled.append(self._travelled[-1] + abs(b - a))

    def centre(self, u: float) -> complex:
        """The centreline; past its ends, straight on."""
        target = u * self._travelled[-1]
        last = len(self._centre) - 2
        i = next((i for i in range(last) if self._travelled[i + 1] >= target), last)
        share = (target - self._travelled[i]) / (self._travelled[i + 1] - self._travelled[i])
        return self._centre[i] + share * (self._centre[i + 1] - self._centre[i])

    def heading(self, u: float) -> complex:
        ahead = self.centre(u + 0.01) - self.centre(u - 0.01)
        return ahead / abs(ahead)

    def at(self, u: float, v: float) -> complex:
        return self.centre(u) + 1j * self.heading(u) * v * self._radius(u)

    def frame(self, u: float) -> Frame:
        """The frame whose x axis runs along the tube at u."""
        return Frame(self.centre(u), math.degrees(cmath.phase(self.heading(u))))

    def edge(self, v: float, start: float, end: float, steps: int) -> Points:
        return [self.at(start + (end - start) * i / steps, v) for i in range(steps + 1)]

    def ring(self, steps: int) -> Points:
        """The whole outline, with round ends."""
        return [
            *self.edge(1.0, 0.0, 1.0, steps),
            *self._cap(1.0, 1.0),
            *self.edge(-1.0, 1.0, 0.0, steps),
            *self._cap(0.0, -1.0),
        ]

    def band(
        self, start: float, end: float, low: float = -1.0, high: float = 1.0, steps: int = 2
    ) -> list[Points]:
        """The part from u = start to end and v = low to high, as pieces for outline()."""
        return [self.edge(high, start, end, steps), self.edge(low, end, start, steps)]

    def _cap(self, u: float, ahead: float) -> Points:
        heading, radius = ahead * self.heading(u), self._radius(u)
        return [self.centre(u) + heading * turn(a) * radius for a in (45, 0, -45)]


def taper(*stops: tuple[float, float]) -> Callable[[float], float]:
    """A radius that passes smoothly through (u, radius) stops."""

    def radius(u: float) -> float:
        for (u0, r0), (u1, r1) in pairwise(stops):
            if u <= u1:
                share = min(max((u - u0) / (u1 - u0), 0.0), 1.0)
                return r0 + (r1 - r0) * share * share * (3 - 2 * share)
        return stops[-1][1]

    return radius


def bent(joints: Sequence[complex], roundness: float = 0.5, steps: int = 12) -> Points:
    """A polyline through straight bones whose inner joints are rounded off by parabolas."""
    line = [joints[0]]
    for before, joint, after in zip(joints, joints[1:], joints[2:], strict=False):
        a = joint + roundness * (before - joint)
        b = joint + roundness * (after - joint)
        for i in range(steps + 1):
            t = i / steps
            line.append((1 - t) ** 2 * a + 2 * t * (1 - t) * joint + t * t * b)
    return [*line, joints[-1]]


def swept(start: complex, heading: float, end_heading: float, length: float) -> Points:
    """An arc given by its headings in degrees at both ends."""
    steps = 24
    line = [start]
    for i in range(steps):
        now = heading + (end_heading - heading) * (i + 0.5) / steps
        line.append(line[-1] + turn(now) * length / steps)
    return line


def closed(points: Sequence[complex]) -> str:
    """Path data of the smooth ring through points (Catmull-Rom)."""
    n = len(points)
    pieces = [f"M{_xy(points[0])}"]
    for i in range(n):
        pieces.append(_cubic(points[i - 1], points[i], points[(i + 1) % n], points[(i + 2) % n]))
    return "".join(pieces) + "Z"


def line(points: Sequence[complex]) -> str:
    """Path data of the smooth open curve through points."""
    return f"M{_xy(points[0])}" + _cubics(points)


def outline(pieces: Sequence[Sequence[complex]]) -> str:
    """Path data of a ring of smooth pieces that meet in corners."""
    data = line(pieces[0])
    for piece in pieces[1:]:
        data += f"L{_xy(piece[0])}" + _cubics(piece)
    return data + "Z"


def _cubics(points: Sequence[complex]) -> str:
    p = [points[0], *points, points[-1]]
    return "".join(_cubic(*p[i : i + 4]) for i in range(len(p) - 3))


def _cubic(before: complex, a: complex, b: complex, after: complex) -> str:
    return f"C{_xy(a + (b - before) / 6)} {_xy(b - (after - a) / 6)} {_xy(b)}"


def _xy(p: complex) -> str:
    return f"{_number(p.real)},{_number(p.imag)}"


def _number(x: float) -> str:
    """One decimal, none where it is zero, and no negative zero."""
    return f"{round(x, 1) + 0.0:g}"


class Drawing:
    """A picture painted back to front in named groups, with one ink line round it all.

    Solid shapes make the silhouette and get the line; marks lie inside it and do not.
    """

    def __init__(self, width: int, height: int, title: str, about: str) -> None:
        self._size = (width, height)
        self._title = title
        self._about = about
        self._lines: list[str] = []

    def group(self, name: str) -> None:
        """Starts the group that the next shapes belong to."""
        if self._lines:
            self._lines.append("    </g>")
        self._lines.append(f'    <g id="{name}">')

    def solid(self, data: str, fill: str) -> None:
        self._lines.append(f'      <path fill="{fill}" d="{data}"/>')

    def mark(self, data: str, fill: str) -> None:
        self._lines.append(f'      <path fill="{fill}" stroke="none" d="{data}"/>')

    def shade(self, data: str, strength: float = 0.2) -> None:
        """Darkens what lies below."""
        style = f'fill="{SHADOW}" fill-opacity="{strength:g}" stroke="none"'
        self._lines.append(f'      <path {style} d="{data}"/>')

    def stroke(self, data: str, colour: str, width: float) -> None:
        style = f'fill="none" stroke="{colour}" stroke-width="{_number(width)}"'
        self._lines.append(f'      <path {style} d="{data}"/>')

    def svg(self) -> str:
        width, height = self._size
        shapes = "\n".join([*self._lines, "    </g>"])
        return f"""<!-- SPDX-License-Identifier: Apache-2.0 -->
<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" \
viewBox="0 0 {width} {height}">
  <title>{escape(self._title)}</title>
  <desc>{escape(self._about)}</desc>
  <defs>
  <g id="shapes" stroke-linecap="round" stroke-linejoin="round">
{shapes}
  </g>
  </defs>
  <use href="#shapes" stroke="{INK}" stroke-width="9"/>
  <use href="#shapes" stroke="{INK}" stroke-width="2.5"/>
</svg>
"""
