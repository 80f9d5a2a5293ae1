# SPDX-License-Identifier: Apache-2.0
"""Closed polygons: rings (K, 2) whose last row joins the first."""

from __future__ import annotations

import numpy as np
from exact_mesh_checks import crossings
from numpy.typing import NDArray

Points = NDArray[np.float64]

_SPACING = 1 / 500  # of samples, of the perimeter


def signed_area(ring: Points) -> float:
    """Positive when the ring is, in pixels with y down."""
    x, y = ring.T
    return 0.5 * float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))


def is_simple(ring: Points) -> bool:
    """No edge meets another but at their common corner; decided exactly."""
    return not crossings(ring)


def edge_lengths(ring: Points) -> Points:
    return np.linalg.norm(np.roll(ring, -1, axis=0) - ring, axis=1)


def turns(ring: Points) -> Points:
    """(K,): where along the ring its rows lie, from 0 at the first, 1 for the whole way."""
    lengths = edge_lengths(ring)
    return np.concatenate([[0.0], np.cumsum(lengths[:-1])]) / lengths.sum()


def turns_of(places: Points, ring: Points) -> Points:
    """(M,): where along the ring the nearest point to each place lies, in turns."""
    distance, share = _to_edges(places, ring)
    edge = distance.argmin(axis=1)
    step = edge_lengths(ring) / edge_lengths(ring).sum()
    return turns(ring)[edge] + share[np.arange(len(places)), edge] * step[edge]


def distances(places: Points, ring: Points) -> Points:
    """(M,): from each place to the ring."""
    return _to_edges(places, ring)[0].min(axis=1)


def sampled(ring: Points) -> Points:
    """The ring's rows, and places between them no farther apart than _SPACING."""
    lengths = edge_lengths(ring)
    counts = np.maximum(np.ceil(lengths / (_SPACING * lengths.sum())).astype(int), 1)
    edge = np.repeat(np.arange(len(ring)), counts)
    share = (np.arange(len(edge)) - np.repeat(np.cumsum(counts) - counts, counts)) / counts[edge]
    step = np.roll(ring, -1, axis=0) - ring
    return ring[edge] + share[:, None] * step[edge]


def inside(ring: Points, places: Points) -> NDArray[np.bool_]:
    """Which places lie inside the ring, by counting crossings to their right."""
    odd = np.zeros(len(places), dtype=bool)
    x, y = places.T
    for (ax, ay), (bx, by) in zip(ring, np.roll(ring, -1, axis=0), strict=True):
        spans = (ay > y) != (by > y)
        with np.errstate(divide="ignore", invalid="ignore"):
            odd ^= spans & (x < ax + (y - ay) / (by - ay) * (bx - ax))
    return odd


def protrusion(outline: Points, rim: Points) -> float:
    """How far corners of the outline lie outside the rim, or corners of the rim inside the outline:
    0 exactly when the rim encloses the outline."""
    outside = outline[~inside(rim, outline)]
    within = rim[inside(outline, rim)]
    return float(
        max(distances(outside, rim).max(initial=0.0), distances(within, outline).max(initial=0.0))
    )


def farthest(a: Points, b: Points) -> float:
    """The Hausdorff distance of two rings, from samples along both."""
    return float(max(distances(sampled(a), b).max(), distances(sampled(b), a).max()))


def _to_edges(places: Points, ring: Points) -> tuple[Points, Points]:
    """(M, K) distances from places to edges, and where on the edges, 0 to 1."""
    step = np.roll(ring, -1, axis=0) - ring
    offset = places[:, None, :] - ring
    along = (offset * step).sum(axis=2) / np.maximum((step**2).sum(axis=1), 1e-300)
    share = np.clip(along, 0.0, 1.0)
    return np.linalg.norm(offset - share[..., None] * step, axis=2), share
