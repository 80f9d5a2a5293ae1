# SPDX-License-Identifier: Apache-2.0
"""What calls answer: values, not handles.  Drawing coordinates are pixels, x right, y down."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime

import numpy as np
from numpy.typing import NDArray

from posespace.errors import Error, InvalidArgument, NotFound

Point = tuple[float, float]


def _cross(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


@dataclass(frozen=True, eq=False)
class TexturePlacement:
    """Where a drawing's pixels lie: texel = (point - origin) * scale, texel (i, j) covering
    [i, i+1] x [j, j+1]."""

    origin: Point
    scale: float
    width: int
    height: int


@dataclass(frozen=True, eq=False)
class Shape:
    """A drawing as the service understood it.

    outline       Rings (K, 2) float64, outer first, holes after it.
    size          Drawing pixels across and down.
    holes_filled  Holes that the mesh covers; transparency keeps them see-through.
    warnings      What was done to the drawing, in words.
    texture       Where the drawing's pixels lie.
    flipped       It is the mirror image of what was uploaded.
    """

    id: str
    size: tuple[float, float]
    outline: list[NDArray[np.float64]] = field(repr=False)
    holes_filled: int
    warnings: list[str]
    texture: TexturePlacement
    flipped: bool


@dataclass(frozen=True)
class GhostLoss:
    """Detail lost in a mix of drawings, 0 to 1: an eye upon a cheek makes two pale ghosts."""

    before: float
    after: float


@dataclass(frozen=True, eq=False)
class Suggestion:
    """What automatic matching would do with the drawings and marks as they were.

    confidence  Drawing -> how clear its matching is, in (0, 1]; below 0.5 look at it.
    flips       Drawings that would fit the others better seen in a mirror.
    flip_gain   How much better with all of them: the cost of matching as they are over that with
                the flips, at least 1.05; 1 when there are none.
    arcs        Drawing -> places around its outline (M, 2), drawing pixels; row k of every drawing
                is the same place.
    starts      Drawing -> row 0 of its arc, where all outlines turn most: a tip or a notch.
    etag        Of the session that was looked at.
    """

    confidence: dict[str, float]
    flips: list[str]
    flip_gain: float
    arcs: dict[str, NDArray[np.float64]] = field(repr=False)
    starts: dict[str, Point]
    etag: str


@dataclass(frozen=True, eq=False)
class BuildReport:
    """How a build went.

    revision          The built pose space.
    vertices, triangles, outline_vertices, steiner_vertices
                      Sizes of the mesh; the latter two before refinement.
    min_angle         Smallest angle over all triangles and drawings, radians.
    levels            How many parts of the drawings each level of the triangulation dealt with:
                      "zero_steiner" triangulates one as it is, "straight_cut", "one_point_cut" and
                      "link_path_cut" cut one in two, "overlay" triangulates any.
    steiner_by_level  How many of the Steiner vertices come from each of them.
    seconds           By stage.
    confidence        By drawing: how clear the automatic matching was, in (0, 1].
    warnings          What a person should know, such as drawings to check.
    ghost_loss        How much detail all drawings mixed in equal parts lose, before and after their
                      insides were aligned; None when alignment was off or had nothing to do.
    ghost_losses      By drawing: how much of its own detail that mix loses.
    """

    revision: str
    vertices: int
    triangles: int
    outline_vertices: int
    steiner_vertices: int
    min_angle: float
    levels: dict[str, int]
    steiner_by_level: dict[str, int]
    seconds: dict[str, float]
    confidence: dict[str, float]
    warnings: list[str]
    ghost_loss: GhostLoss | None
    ghost_losses: dict[str, GhostLoss]


@dataclass(frozen=True, eq=False)
class Build:
    """Where a build stands.

    state     "queued", "running", "succeeded", "failed" or "cancelled".
    stage     "matching", "simplification", "triangulation", "improvement", "alignment" or
              "weights".
    fraction  Done so far, 0 to 1.
    report    When it succeeded.
    error     When it failed or was cancelled: what `build` raises.
    """

    id: str
    state: str
    stage: str
    fraction: float
    report: BuildReport | None
    error: Error | None = None


@dataclass(frozen=True, eq=False)
class SessionState:
    """A session as it stood when it was asked.

    shape_ids               Drawings in the order of upload.
    correspondences         One dict a marked place: drawing -> point, drawing pixels.
    placements              Drawing -> point of pose space.
    placements_are_default  Nobody has set placements: one drawing lies at (0, 0), several on the
                            unit circle.
    etag                    Changes with every change of the session.
    revision                The pose space that blends use; empty before the first build.
    build                   The latest build; None before the first.
    """

    id: str
    display_name: str
    labels: dict[str, str]
    shape_ids: list[str]
    correspondences: list[dict[str, Point]]
    placements: dict[str, Point]
    placements_are_default: bool
    etag: str
    create_time: datetime
    update_time: datetime
    revision: str
    build: Build | None


@dataclass(frozen=True)
class MeshPoint:
    """A place in a mesh, the same in every drawing and frame; made by Mesh.point.

    It belongs to the mesh of that revision: a rebuild has other triangles.

    triangle  Row of Mesh.triangles.
    b, c      Weights of its second and third corner; the first has the rest.
    """

    triangle: int
    b: float
    c: float


@dataclass(frozen=True, eq=False)
class Mesh:
    """One triangle list that is valid in every drawing.

    shape_ids   Drawings in the order of weights.
    triangles   (T, 3) int32, positive (x right, y down) in every drawing.
    vertices    Drawing -> (V, 2) float64, drawing pixels.
    boundary    Loops of vertex indices (K,) int32, outer first.
    outlines    Drawing -> rings (K, 2) float64 as extracted, outer first.
    landmarks   (L,) int32: the vertex of each correspondence.
    turns       Drawing -> whole turns added to its mean rotation.
    textures    Drawing -> where its pixels lie; texture coordinates are `vertices`.
    """

    revision: str
    shape_ids: list[str]
    triangles: NDArray[np.int32] = field(repr=False)
    vertices: dict[str, NDArray[np.float64]] = field(repr=False)
    boundary: list[NDArray[np.int32]] = field(repr=False)
    outlines: dict[str, list[NDArray[np.float64]]] = field(repr=False)
    landmarks: NDArray[np.int32] = field(repr=False)
    turns: dict[str, int]
    textures: dict[str, TexturePlacement]
    report: BuildReport

    def point(self, shape_id: str, at: tuple[float, float]) -> MeshPoint:
        """The place of the mesh that a pixel of a drawing is in.

            foot = session.mesh().point("stand", (103, 240))
            frame = session.blend(at=(0.0, 0.5), anchor=foot)

        Raises NotFound for an unknown drawing, InvalidArgument for a point outside its mesh.
        """
        if shape_id not in self.vertices:
            raise NotFound(f"the mesh has no drawing '{shape_id}'", reason="SHAPE_NOT_FOUND")
        place = np.asarray(at, float)
        corners = self.vertices[shape_id][self.triangles]  # (T, 3, 2)
        doubled = _cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        weights = np.stack(
            [
                _cross(corners[:, k - 2] - place, corners[:, k - 1] - place) / doubled
                for k in range(3)
            ],
            axis=1,
        )
        triangle = int(np.argmax(weights.min(axis=1)))
        if not weights[triangle].min() >= -1e-9:
            raise InvalidArgument(
                f"drawing '{shape_id}' has nothing at {tuple(at)}: the point lies outside its mesh",
                reason="INVALID_OPTION",
            )
        b, c = np.clip(weights[triangle, 1:], 0.0, 1.0).tolist()
        return MeshPoint(triangle, b, c)


@dataclass(frozen=True, eq=False)
class Frame:
    """A drawing at a place of pose space.

    vertices         (V, 2) float32, drawing pixels; read-only, so copy before writing.
    weights          Drawing -> weight; they sum to 1 and may lie outside [0, 1].
    texture_weights  Drawing -> weight of its pixels, in [0, 1]; they sum to 1.
    folds            Triangles that are not positive; 0 in a good frame.
    mended           Triangles that repair made positive; 0 when nothing had to be mended.
    revision         The pose space it is of.
    fading           Of a Player, while it comes over to new placements: ask again, it moves on.
    """

    vertices: NDArray[np.float32] = field(repr=False)
    weights: Mapping[str, float]
    texture_weights: Mapping[str, float]
    folds: int
    mended: int
    revision: str
    fading: bool


@dataclass(frozen=True, eq=False)
class AnimationFrame(Frame):
    """A frame of an animation.

    index  Which, from 0.
    time   Seconds from the start.
    at     The place in pose space.
    """

    index: int
    time: float
    at: Point
