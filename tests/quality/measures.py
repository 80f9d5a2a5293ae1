# SPDX-License-Identifier: Apache-2.0
"""What makes a mesh and its in-betweens good, measured from outside."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import posespace
from exact_mesh_checks import assert_valid_in_every_drawing
from numpy.typing import NDArray
from outlines import edge_lengths, farthest, protrusion, signed_area, turns, turns_of
from posespace.messages import Rotation

BLENDS = 10  # random in-betweens of a group
TOLERANCE = 0.03  # the build's default, of the square root of a drawing's area
_ARCS = 1024  # places around an outline that are asked for, as many as there may be

Points = NDArray[np.float64]


def is_valid(mesh: posespace.Mesh) -> bool:
    """As assert_valid_in_every_drawing says, exactly."""
    try:
        assert_valid_in_every_drawing(mesh)
    except AssertionError:
        return False
    return True


@dataclass(frozen=True)
class Enclosure:
    """How mesh outlines lie about the drawings' outlines, in square roots of a drawing's area; of
    the worst drawing."""

    protrusion: float  # how far the outlines pass each other where they should not
    distance: float  # Hausdorff

    @property
    def holds(self) -> bool:
        """Enclosing, and within the tolerance; up to the rounding of coordinates."""
        return self.protrusion <= 1e-9 and self.distance <= TOLERANCE + 1e-9


def enclosure(mesh: posespace.Mesh) -> Enclosure:
    worst = Enclosure(0.0, 0.0)
    for name, points in mesh.vertices.items():
        outline, rim = mesh.outlines[name][0], points[mesh.boundary[0]]
        size = abs(signed_area(outline)) ** 0.5
        worst = Enclosure(
            max(worst.protrusion, protrusion(outline, rim) / size),
            max(worst.distance, farthest(outline, rim) / size),
        )
    return worst


def matching_errors(
    session: posespace.Session, places: dict[str, Points], rotation: Rotation = "upright"
) -> Points:
    """(N, N): how far along drawing j the automatic matching puts row k of drawing i from row k of
    drawing j, in turns; the mean over the length of drawing i.

    places  Drawing -> ring (K, 2), its own outline; row k of every ring is the same place.
    """
    arcs = session.suggest(samples=_ARCS, rotation=rotation).arcs
    found = {name: turns_of(arcs[name], ring) for name, ring in places.items()}
    known = {name: turns(ring) for name, ring in places.items()}
    errors = np.zeros((len(places), len(places)))
    for i, (a, ring) in enumerate(places.items()):
        before, after = edge_lengths(np.roll(ring, 1, axis=0)), edge_lengths(ring)
        for j, b in enumerate(places):
            apart = carried_along(known[a], found[a], found[b]) - known[b]
            apart = np.abs(apart - np.round(apart))
            errors[i, j] = np.average(apart, weights=before + after)
    return errors


def carried_along(at: Points, start: Points, end: Points) -> Points:
    """Where a map of closed curves takes turns `at`: it takes start[m] to end[m], in order, and is
    linear in between."""
    order = np.argsort(start)
    start, end = start[order], end[order]
    rise = np.diff(end, prepend=end[-1:])
    end = end[0] + np.cumsum(np.concatenate([[0.0], rise[1:] - np.floor(rise[1:])]))
    start = np.concatenate([start[-1:] - 1, start, start[:1] + 1])
    end = np.concatenate([end[-1:] - 1, end, end[:1] + 1])
    return np.interp(at, start, end)


def angles(mesh: posespace.Mesh) -> Points:
    """The smallest angle of every triangle in every drawing, degrees: (N * T,)."""
    found = []
    for points in mesh.vertices.values():
        corners = points[mesh.triangles]
        sides = np.roll(corners, -1, axis=1) - corners
        turns = [
            np.abs(
                np.arctan2(
                    _cross(sides[:, k], -sides[:, k - 1]), _dot(sides[:, k], -sides[:, k - 1])
                )
            )
            for k in range(3)
        ]
        found.append(np.degrees(np.min(turns, axis=0)))
    return np.concatenate(found)


def random_weights(count: int, blends: int = BLENDS) -> NDArray[np.float64]:
    """(blends, count): uniform over all in-betweens, the same in every run."""
    return np.random.default_rng(1).dirichlet(np.ones(count), blends)


def edge_rms(mesh: posespace.Mesh, weights: Points, vertices: Points) -> float:
    """How far the lengths of a blend's edges are from the weighted mean of their lengths in the
    drawings: root mean square of the log ratio."""
    pairs = np.sort(np.concatenate([mesh.triangles[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
    edges = np.unique(pairs, axis=0)

    def lengths(points: Points) -> Points:
        return np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)

    wanted = sum(
        w * lengths(mesh.vertices[name]) for name, w in zip(mesh.shape_ids, weights, strict=True)
    )
    return float(np.sqrt(np.mean(np.log(lengths(vertices.astype(float)) / wanted) ** 2)))


@dataclass(frozen=True)
class Blending:
    """Random in-betweens by one method."""

    folded: int  # frames with a triangle that is not positive
    edge_rms: float  # mean over the frames


def blending(
    session: posespace.Session,
    mesh: posespace.Mesh,
    method: posespace.BlendMethod,
    *,
    blends: int = BLENDS,
    refits: int | None = None,
) -> Blending:
    rows = random_weights(len(mesh.shape_ids), blends)
    frames = [
        session.blend(
            weights=dict(zip(mesh.shape_ids, row.tolist(), strict=True)),
            method=method,
            refits=refits,
        )
        for row in rows
    ]
    return Blending(
        folded=sum(frame.folds > 0 for frame in frames),
        edge_rms=float(
            np.mean([edge_rms(mesh, row, f.vertices) for row, f in zip(rows, frames, strict=True)])
        ),
    )


def _cross(a: Points, b: Points) -> Points:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


def _dot(a: Points, b: Points) -> Points:
    return (a * b).sum(axis=1)
