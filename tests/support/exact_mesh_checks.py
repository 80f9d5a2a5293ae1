# SPDX-License-Identifier: Apache-2.0
"""Whether a mesh is valid, decided here with exact arithmetic on the numbers as they came."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction

import numpy as np
import posespace
from numpy.typing import NDArray

ExactPoint = tuple[Fraction, Fraction]


def exact(points: NDArray[np.float64]) -> list[ExactPoint]:
    assert np.isfinite(points).all()
    return [(Fraction(x), Fraction(y)) for x, y in points.tolist()]


def orientation(a: ExactPoint, b: ExactPoint, c: ExactPoint) -> int:
    """Sign of cross(b - a, c - a): 1 for positive in pixels, y down."""
    cross = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
    return (cross > 0) - (cross < 0)


def between(a: ExactPoint, b: ExactPoint, p: ExactPoint) -> bool:
    """p, on the line ab, lies on the segment ab."""
    return all(min(a[k], b[k]) <= p[k] <= max(a[k], b[k]) for k in range(2))


def touch(a: ExactPoint, b: ExactPoint, c: ExactPoint, d: ExactPoint) -> bool:
    """The closed segments ab and cd share a point."""
    o = orientation(a, b, c), orientation(a, b, d), orientation(c, d, a), orientation(c, d, b)
    if o[0] * o[1] < 0 and o[2] * o[3] < 0:
        return True
    return (
        (o[0] == 0 and between(a, b, c))
        or (o[1] == 0 and between(a, b, d))
        or (o[2] == 0 and between(c, d, a))
        or (o[3] == 0 and between(c, d, b))
    )


def crossings(ring: NDArray[np.float64]) -> list[tuple[int, int]]:
    """Pairs of edges that share a point other than the corner of neighbours."""
    points, count = exact(ring), len(ring)
    low = np.minimum(ring, np.roll(ring, -1, axis=0))
    high = np.maximum(ring, np.roll(ring, -1, axis=0))
    found = []
    for i in range(count):
        near = (low <= high[i]).all(axis=1) & (high >= low[i]).all(axis=1)
        for j in np.flatnonzero(near[i + 1 :]) + i + 1:
            a, b, c, d = points[i], points[(i + 1) % count], points[j], points[(j + 1) % count]
            if j == i + 1 or (
                i == 0 and j == count - 1
            ):  # neighbours may only meet at their corner
                corner, p, q = (b, a, d) if j == i + 1 else (a, b, c)
                folded_back = orientation(p, corner, q) == 0 and (
                    between(corner, p, q) or between(corner, q, p)
                )
                if folded_back:
                    found.append((i, int(j)))
            elif touch(a, b, c, d):
                found.append((i, int(j)))
    return found


def assert_valid_in_every_drawing(mesh: posespace.Mesh) -> None:
    """Positive triangles, a simple outline, the topology of the loops it names, nothing loose."""
    triangles = mesh.triangles.tolist()
    count = len(mesh.vertices[mesh.shape_ids[0]])
    directed = Counter((t[k], t[(k + 1) % 3]) for t in triangles for k in range(3))
    assert max(directed.values()) == 1, "an edge is used twice in the same direction"
    rim = {edge for edge in directed if edge[::-1] not in directed}
    loops = [
        (int(a), int(b))
        for loop in mesh.boundary
        for a, b in zip(loop, np.roll(loop, -1), strict=True)
    ]
    assert len(loops) == len(set(loops)) and set(loops) == rim, "boundary is not the mesh's rim"
    edges = {frozenset(edge) for edge in directed}
    assert {v for t in triangles for v in t} == set(range(count)), "a vertex has no triangle"
    assert count - len(edges) + len(triangles) == 2 - len(mesh.boundary), "Euler"

    for name in mesh.shape_ids:
        points = mesh.vertices[name]
        assert points.shape == (count, 2)
        corners = exact(points)
        wrong = [t for t in triangles if orientation(*(corners[v] for v in t)) <= 0]
        assert not wrong, f"shape '{name}': {len(wrong)} triangles are not positive"
        for loop in mesh.boundary:
            found = crossings(points[loop])
            assert not found, f"shape '{name}': the outline crosses itself at edges {found[:3]}"
