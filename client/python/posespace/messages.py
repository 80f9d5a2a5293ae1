# SPDX-License-Identifier: Apache-2.0
"""Python values to messages and back."""

from __future__ import annotations

import contextlib
import reprlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from datetime import UTC
from typing import Any, Literal, TypeVar

import numpy as np
from google.protobuf.message import Message
from numpy.typing import ArrayLike, NDArray

from posespace import results
from posespace.errors import Error, InvalidArgument, NotFound, error_of_reason
from posespace.v1 import geometry_pb2, pose_service_pb2, session_service_pb2

T = TypeVar("T")
M = TypeVar("M", bound=Message)

Rotation = Literal["upright", "any"]
BlendMethod = Literal["rigid", "linear", "paper"]
ShearLimit = Literal["band", "hermite", "off"]
StretchBlend = Literal["linear", "log", "metric"]
Foreground = Literal["alpha", "light", "dark"]
Edges = Literal["crisp", "soft"]
Place = Sequence[float] | NDArray[np.floating[Any]]  # x and y

_METHODS = {
    "rigid": pose_service_pb2.BLEND_METHOD_RIGID,
    "linear": pose_service_pb2.BLEND_METHOD_LINEAR,
    "paper": pose_service_pb2.BLEND_METHOD_PAPER,
}
_SHEAR_LIMITS = {
    None: pose_service_pb2.SHEAR_LIMIT_UNSPECIFIED,
    "band": pose_service_pb2.SHEAR_LIMIT_BAND,
    "hermite": pose_service_pb2.SHEAR_LIMIT_HERMITE,
    "off": pose_service_pb2.SHEAR_LIMIT_OFF,
}
_EDGES = {
    "crisp": pose_service_pb2.EDGES_CRISP,
    "soft": pose_service_pb2.EDGES_SOFT,
}
_STRETCHES = {
    "linear": pose_service_pb2.STRETCH_BLEND_LINEAR,
    "log": pose_service_pb2.STRETCH_BLEND_LOG,
    "metric": pose_service_pb2.STRETCH_BLEND_METRIC,
}
_ROTATIONS = {
    "upright": session_service_pb2.ROTATION_UPRIGHT,
    "any": session_service_pb2.ROTATION_ANY,
}
_FOREGROUNDS = {
    "alpha": session_service_pb2.FOREGROUND_ALPHA,
    "light": session_service_pb2.FOREGROUND_LIGHT,
    "dark": session_service_pb2.FOREGROUND_DARK,
}


@contextlib.contextmanager
def argument(name: str, value: object) -> Iterator[None]:
    """Python's own complaint about a value as InvalidArgument, which names the argument."""
    try:
        yield
    except (AttributeError, LookupError, OverflowError, TypeError, ValueError) as error:
        raise InvalidArgument(
            f"{name} is {reprlib.repr(value)}: {error}", reason="INVALID_OPTION"
        ) from None


def make(kind: type[M], **fields: Any) -> M:
    """A message of fields named as the arguments are; the one that does not fit is named."""
    try:
        return kind(**fields)
    except (AttributeError, LookupError, OverflowError, TypeError, ValueError):
        for name, value in fields.items():
            with argument(name, value):
                kind(**{name: value})
        raise


def choice(name: str, value: str | None, choices: Mapping[Any, T]) -> T:
    """What the wire has for a word, or InvalidArgument with the words there are."""
    try:
        return choices[value]
    except (KeyError, TypeError):
        words = ", ".join(f"'{word}'" for word in choices if word is not None)
        raise InvalidArgument(
            f"{name} is {value!r}, not one of {words}", reason="INVALID_OPTION"
        ) from None


def rotation(name: str) -> session_service_pb2.Rotation:
    """The wire's number of a way to be turned."""
    return choice("rotation", name, _ROTATIONS)


def foreground(name: str) -> session_service_pb2.Foreground:
    """The wire's number of a foreground."""
    return choice("foreground", name, _FOREGROUNDS)


def points_array(points: ArrayLike, what: str) -> NDArray[np.float64]:
    """(K, 2) float64, or InvalidArgument: flattened on the wire, another shape would go unseen."""
    with argument(what, points):
        array = np.asarray(points, dtype=np.float64)
    if array.size == 0:
        array = array.reshape(0, 2)
    if array.ndim != 2 or array.shape[1] != 2:
        raise InvalidArgument(
            f"{what} must be points (K, 2), not {array.shape}", reason="INVALID_OPTION"
        )
    return array


def ring(points: ArrayLike, what: str) -> geometry_pb2.Ring:
    """A closed polygon."""
    return geometry_pb2.Ring(coordinates=points_array(points, what).ravel())


def point(xy: Place, what: str) -> geometry_pb2.Point:
    """A point of two numbers."""
    with argument(what, xy):
        if len(xy) == 2:
            return geometry_pb2.Point(x=float(xy[0]), y=float(xy[1]))
    raise InvalidArgument(f"{what} must be x and y, not {xy!r}", reason="INVALID_OPTION")


def edges_value(edges: Edges) -> pose_service_pb2.Edges:
    """What a picture shows where some drawings are painted and others are not."""
    return choice("edges", edges, _EDGES)


def box(view: Sequence[float]) -> geometry_pb2.Box:
    """A rectangle: x, y, width, height."""
    with argument("view", view):
        x, y, width, height = view
        return geometry_pb2.Box(x=x, y=y, width=width, height=height)


def picture_size(size: Sequence[int]) -> tuple[int, int]:
    """Width and height, as whole numbers that the wire can carry."""
    with argument("size", size):
        width, height = size
        message = pose_service_pb2.RenderRequest(width=width, height=height)
        return message.width, message.height


def blend_options(
    method: BlendMethod,
    shear_limit: ShearLimit | None,
    refits: int | None,
    sigma: float,
    stretch: StretchBlend = "linear",
    repair: bool = False,
    anchor: results.MeshPoint | None = None,
) -> pose_service_pb2.BlendOptions:
    """How to blend."""
    return make(
        pose_service_pb2.BlendOptions,
        method=choice("method", method, _METHODS),
        shear_limit=choice("shear_limit", shear_limit, _SHEAR_LIMITS),
        refits=refits,
        sigma=sigma,
        stretch=choice("stretch", stretch, _STRETCHES),
        repair=repair,
        anchor=None
        if anchor is None
        else make(pose_service_pb2.MeshPoint, triangle=anchor.triangle, b=anchor.b, c=anchor.c),
    )


def query(
    at: Place | None,
    weights: Mapping[str, float] | None,
    shape_ids: Sequence[str],
    options: pose_service_pb2.BlendOptions,
) -> pose_service_pb2.Query:
    """Where and how, from exactly one of `at` and `weights`; drawings without a weight get 0."""
    if (at is None) == (weights is None):
        raise InvalidArgument("give either at= or weights=", reason="INVALID_OPTION")
    if at is not None:
        return pose_service_pb2.Query(at=point(at, "at"), options=options)
    assert weights is not None
    for shape_id in weights:
        if shape_id not in shape_ids:
            raise NotFound(
                f"weights name shape '{shape_id}', which the built pose space does not have; it "
                f"has {', '.join(shape_ids)}",
                reason="SHAPE_NOT_FOUND",
            )
    with argument("weights", weights):
        values = [float(weights.get(shape_id, 0.0)) for shape_id in shape_ids]
    return pose_service_pb2.Query(weights=pose_service_pb2.Weights(values=values), options=options)


def at_queries(
    points: Iterable[Place], options: pose_service_pb2.BlendOptions
) -> list[pose_service_pb2.Query]:
    """One query a point."""
    return [
        pose_service_pb2.Query(at=geometry_pb2.Point(x=x, y=y), options=options) for x, y in points
    ]


def correspondence(points: Mapping[str, Place]) -> session_service_pb2.Correspondence:
    """One place of the character, marked in some drawings."""
    message = session_service_pb2.Correspondence()
    for shape_id, xy in points.items():
        at = point(xy, f"the mark in shape {shape_id!r}")
        with argument("tuples", points):
            message.points[shape_id].CopyFrom(at)
    return message


def placement(shape_id: str, at: Place) -> session_service_pb2.Placement:
    """A drawing's place in pose space."""
    where = point(at, f"the placement of shape {shape_id!r}")
    with argument("placements", {shape_id: at}):
        return session_service_pb2.Placement(shape_id=shape_id, at=where)


def _rings(messages: Iterable[geometry_pb2.Ring]) -> list[NDArray[np.float64]]:
    return [np.array(message.coordinates).reshape(-1, 2) for message in messages]


def _texture(message: geometry_pb2.TexturePlacement) -> results.TexturePlacement:
    origin = (message.origin.x, message.origin.y)
    return results.TexturePlacement(origin, message.scale, message.width, message.height)


def shape(message: session_service_pb2.Shape) -> results.Shape:
    """A drawing as the service understood it."""
    return results.Shape(
        id=message.id,
        size=(message.width, message.height),
        outline=_rings(message.outline),
        holes_filled=message.holes_filled,
        warnings=list(message.warnings),
        texture=_texture(message.texture),
        flipped=message.flipped,
    )


def suggestion(
    message: session_service_pb2.SuggestCorrespondencesResponse,
) -> results.Suggestion:
    """What automatic matching would do."""
    arcs = {each.shape_id: np.array(each.arc.coordinates).reshape(-1, 2) for each in message.shapes}
    return results.Suggestion(
        confidence={each.shape_id: each.confidence for each in message.shapes},
        flips=[each.shape_id for each in message.shapes if each.flip],
        flip_gain=message.flip_gain,
        arcs=arcs,
        starts={shape_id: (float(arc[0, 0]), float(arc[0, 1])) for shape_id, arc in arcs.items()},
        etag=message.etag,
    )


def report(message: geometry_pb2.BuildReport) -> results.BuildReport:
    """How a build went."""
    return results.BuildReport(
        revision=message.revision,
        vertices=message.vertices,
        triangles=message.triangles,
        outline_vertices=message.outline_vertices,
        steiner_vertices=message.steiner_vertices,
        min_angle=message.min_angle,
        levels=dict(message.levels),
        steiner_by_level=dict(message.steiner_by_level),
        seconds=dict(message.seconds),
        confidence=dict(message.confidence),
        warnings=list(message.warnings),
        ghost_loss=_ghost_loss(message.ghost_loss) if message.HasField("ghost_loss") else None,
        ghost_losses={key: _ghost_loss(loss) for key, loss in message.ghost_losses.items()},
    )


def _ghost_loss(message: geometry_pb2.GhostLoss) -> results.GhostLoss:
    return results.GhostLoss(before=message.before, after=message.after)


def build(message: session_service_pb2.Build) -> results.Build:
    """Where a build stands."""
    state = session_service_pb2.BuildState.Name(message.state)
    return results.Build(
        id=message.id,
        state=state.removeprefix("BUILD_STATE_").lower(),
        stage=message.stage,
        fraction=message.fraction,
        report=report(message.report) if message.HasField("report") else None,
        error=build_error(message.error) if message.HasField("error") else None,
    )


def build_error(message: session_service_pb2.BuildError) -> Error:
    """Why a build ended without a result."""
    fields = dict.fromkeys(message.fields, message.message)
    return error_of_reason(message.reason, message.message, fields)


def session_state(message: session_service_pb2.Session) -> results.SessionState:
    """A session as it stands."""
    return results.SessionState(
        id=message.id,
        display_name=message.display_name,
        labels=dict(message.labels),
        shape_ids=list(message.shape_ids),
        correspondences=[
            {shape_id: (at.x, at.y) for shape_id, at in tuple_.points.items()}
            for tuple_ in message.correspondences
        ],
        placements={place.shape_id: (place.at.x, place.at.y) for place in message.placements},
        placements_are_default=message.placements_are_default,
        etag=message.etag,
        create_time=message.create_time.ToDatetime(UTC),
        update_time=message.update_time.ToDatetime(UTC),
        revision=message.revision,
        build=build(message.build) if message.HasField("build") else None,
    )


def mesh(message: geometry_pb2.Mesh) -> results.Mesh:
    """One triangle list that is valid in every drawing."""
    poses = message.poses
    return results.Mesh(
        revision=message.revision,
        shape_ids=[pose.shape_id for pose in poses],
        triangles=np.array(message.triangles, dtype=np.int32).reshape(-1, 3),
        vertices={pose.shape_id: np.array(pose.vertices).reshape(-1, 2) for pose in poses},
        boundary=[np.array(loop.vertices, dtype=np.int32) for loop in message.boundary],
        outlines={pose.shape_id: _rings(pose.outlines) for pose in poses},
        landmarks=np.array(message.landmarks, dtype=np.int32),
        turns={pose.shape_id: pose.turns for pose in poses},
        textures={pose.shape_id: _texture(pose.texture) for pose in poses},
        report=report(message.report),
    )


def _vertices(message: pose_service_pb2.Frame) -> NDArray[np.float32]:
    """(V, 2), whichever way they came."""
    if not message.HasField("quantized"):
        return np.frombuffer(message.vertices, dtype="<f4").reshape(-1, 2)
    grid = message.quantized
    steps = np.frombuffer(grid.values, dtype="<i2").reshape(-1, 2).astype(np.float32)
    centre = np.array([grid.center_x, grid.center_y], dtype=np.float32)
    return (steps * np.float32(grid.step) + centre).astype(np.float32)


def frame(
    message: pose_service_pb2.Frame,
    shape_ids: Sequence[str],
    revision: str,
    *,
    fading: bool = False,
) -> results.Frame:
    """A drawing at a place of pose space."""
    return results.Frame(
        vertices=_vertices(message),
        weights=dict(zip(shape_ids, message.weights, strict=False)),
        texture_weights=dict(zip(shape_ids, message.texture_weights, strict=False)),
        folds=message.folds,
        mended=message.mended,
        revision=revision,
        fading=fading,
    )


def pixels(rgba: bytes, width: int, height: int) -> NDArray[np.uint8]:
    """A picture that came as plain bytes: (H, W, 4), free to be written to."""
    return np.frombuffer(rgba, np.uint8).reshape(height, width, 4).copy()


def animation_frame(
    message: pose_service_pb2.AnimateResponse, shape_ids: Sequence[str]
) -> results.AnimationFrame:
    """A frame of an animation."""
    still = frame(message.frame, shape_ids, message.revision)
    return results.AnimationFrame(
        **vars(still),
        index=message.index,
        time=message.time,
        at=(message.at.x, message.at.y),
    )
