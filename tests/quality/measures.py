# SPDX-License-Identifier: Apache-2.0
"""What makes a mesh and its in-betweens good, measured from outside."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import posespace
from numpy.typing import NDArray

BLENDS = 10  # random in-betweens of a group

Points = NDArray[np.float64]


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


def random_weights(count: int) -> NDArray[np.float64]:
    """(BLENDS, count): uniform over all in-betweens, the same in every run."""
    return np.random.default_rng(1).dirichlet(np.ones(count), BLENDS)


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
    """Ten random in-betweens by one method."""

    folded: int  # frames with a triangle that is not positive
    edge_rms: float  # mean over the frames


def blending(
    session: posespace.Session, mesh: posespace.Mesh, method: posespace.BlendMethod
) -> Blending:
    rows = random_weights(len(mesh.shape_ids))
    frames = [
        session.blend(weights=dict(zip(mesh.shape_ids, row.tolist(), strict=True)), method=method)
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
