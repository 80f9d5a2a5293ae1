# SPDX-License-Identifier: Apache-2.0
"""Rigid blending written down once more, from its formulas alone and with dense matrices.

Notation: E_i the edge vectors [a - c, b - c] of a triangle in pose i; A_i = E_i E_0^-1 its map from
pose 0; J_i = E_i E^-1 = R(alpha_i) S_i its map from the rest triangle E; S_i symmetric.
"""

from __future__ import annotations

from collections import deque

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def rotation(angle: Array) -> Array:
    """(..., 2, 2) of angles (...)."""
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([np.stack([c, -s], -1), np.stack([s, c], -1)], -2)


def nearest_angle(m: Array) -> Array:
    """Angle of the rotation nearest to m (..., 2, 2)."""
    return np.arctan2(m[..., 1, 0] - m[..., 0, 1], m[..., 0, 0] + m[..., 1, 1])


def symmetric_root(m: Array) -> Array:
    """Square root of symmetric positive matrices (..., 2, 2)."""
    values, vectors = np.linalg.eigh(m)
    return (vectors * np.sqrt(values)[..., None, :]) @ np.swapaxes(vectors, -1, -2)


def edges(points: Array, triangles: NDArray[np.int32]) -> Array:
    """(T, 2, 2): columns a - c and b - c."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    return np.stack([a - c, b - c], axis=-1)


def area_centroid(points: Array, triangles: NDArray[np.int32]) -> Array:
    """sum a_t m_t / sum a_t with signed areas; |a_t| where folds leave almost no area."""
    areas = np.linalg.det(edges(points, triangles)) / 2
    if abs(areas.sum()) < 1e-3 * np.abs(areas).sum():
        areas = np.abs(areas)
    return (areas[:, None] * points[triangles].mean(axis=1)).sum(axis=0) / areas.sum()


def unwrapped_over_mesh(angles: Array, triangles: NDArray[np.int32]) -> Array:
    """Adds whole turns so that triangles that share an edge differ by less than half a turn."""
    sides: dict[frozenset[int], list[int]] = {}
    for t, corners in enumerate(triangles.tolist()):
        for k in range(3):
            sides.setdefault(frozenset((corners[k], corners[k - 1])), []).append(t)
    neighbours: list[list[int]] = [[] for _ in range(len(triangles))]
    for pair in sides.values():
        if len(pair) == 2:
            neighbours[pair[0]].append(pair[1])
            neighbours[pair[1]].append(pair[0])
    out, seen, waiting = angles.copy(), {0}, deque([0])
    while waiting:
        t = waiting.popleft()
        for u in neighbours[t]:
            if u not in seen:
                seen.add(u)
                out[u] += 2 * np.pi * np.round((out[t] - out[u]) / (2 * np.pi))
                waiting.append(u)
    assert len(seen) == len(triangles), "the mesh is in one piece"
    return out


def limited(weights: Array, limit: str) -> Array:
    """w' of Baxter, Barla, Anjyo 2009, section 4.2."""
    if limit == "off":
        return weights
    t = np.clip(weights, 0, 1)
    if limit == "hermite":
        phi = t * t * (3 - 2 * t)
    else:
        b = 0.1

        def rise(s: Array) -> Array:
            return b * (2 * (s / b) ** 2 - (s / b) ** 3)

        phi = np.where(t < b, rise(t), np.where(t > 1 - b, 1 - rise(1 - t), t))
    return phi / phi.sum()


class DenseRigidBlend:
    """poses (N, V, 2), one triangle list; `turns` as the service exports them.

    base "mean": the rest triangle has the mean metric, triangles weigh as their rest areas, times
        the power 2/3 of how many times larger their share of all areas is than in the pose that
        gives them the least of its own; at most sixteen times.
    base "first": the rest triangle is that of pose 0, all weigh the same (the published form).
    """

    def __init__(
        self, poses: Array, triangles: NDArray[np.int32], turns: Array, base: str = "mean"
    ) -> None:
        self.triangles = triangles
        e = np.stack([edges(p, triangles) for p in poses])  # (N, T, 2, 2)
        a = e @ np.linalg.inv(e[0])
        theta = np.stack([unwrapped_over_mesh(nearest_angle(m), triangles) for m in a])
        if base == "mean":
            metric = (np.swapaxes(e, -1, -2) @ e).mean(axis=0)
            inverse = np.linalg.inv(e[0])
            mean_stretch = symmetric_root(np.swapaxes(inverse, -1, -2) @ metric @ inverse)
        else:
            mean_stretch = np.broadcast_to(np.eye(2), e[0].shape)
        self.rest = mean_stretch @ e[0]
        areas = np.linalg.det(self.rest) / 2
        doubled = np.linalg.det(e)  # (N, T)
        least = (doubled / doubled.sum(axis=1, keepdims=True)).min(axis=0)
        factor = (np.maximum(areas / areas.sum() / least, 1) ** (2 / 3)).clip(max=16)
        self.masses = areas * factor if base == "mean" else np.ones_like(areas)

        stretch_of_a = rotation(-theta) @ a
        beyond = stretch_of_a @ np.linalg.inv(mean_stretch)
        self.alpha = theta + nearest_angle(beyond)
        self.stretch = rotation(-nearest_angle(beyond)) @ beyond
        mean = (self.alpha * areas).sum(axis=1) / areas.sum()
        self.alpha += 2 * np.pi * (turns - np.ceil((mean - np.pi) / (2 * np.pi)))[:, None]
        self.centroids = np.stack([area_centroid(p, triangles) for p in poses])

        # Row 2 t + k maps the vertices to column k of J_t = [a - c, b - c] E^-1.
        inverse = np.linalg.inv(self.rest)
        count = len(triangles)
        self.gradient = np.zeros((2 * count, poses.shape[1]))
        for k in range(2):
            rows = 2 * np.arange(count) + k
            self.gradient[rows, triangles[:, 0]] = inverse[:, 0, k]
            self.gradient[rows, triangles[:, 1]] = inverse[:, 1, k]
            self.gradient[rows, triangles[:, 2]] = -inverse[:, 0, k] - inverse[:, 1, k]
        self.root_mass = np.sqrt(np.repeat(self.masses, 2))[:, None]
        self.solve = np.linalg.pinv(self.root_mass * self.gradient, rcond=1e-12)

    def at(self, weights: Array, refits: int = 3, limit: str = "band") -> Array:
        """(V, 2)."""
        stretch = np.einsum("n,ntij->tij", limited(weights, limit), self.stretch)
        angle = weights @ self.alpha
        vertices = self._fit(rotation(angle) @ stretch)
        for _ in range(refits):
            jacobian = np.swapaxes((self.gradient @ vertices).reshape(-1, 2, 2), -1, -2)
            vertices = self._fit(rotation(nearest_angle(jacobian @ stretch)) @ stretch)
        return vertices + weights @ self.centroids - area_centroid(vertices, self.triangles)

    def _fit(self, targets: Array) -> Array:
        rows = np.swapaxes(targets, -1, -2).reshape(-1, 2)
        return self.solve @ (self.root_mass * rows)
