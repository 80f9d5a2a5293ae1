# SPDX-License-Identifier: Apache-2.0
"""A session: drawings of one character, placed in a plane, and every drawing in between."""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Callable, Generator, Mapping
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from posespace import messages
from posespace.animation import Easing, Waypoints, animation
from posespace.authoring import Authoring
from posespace.channel import Channel
from posespace.errors import Error, NotFound
from posespace.messages import BlendMethod, Edges, Place, ShearLimit, StretchBlend
from posespace.pictures import decode_png
from posespace.player import Player
from posespace.results import AnimationFrame, Frame, Mesh, MeshPoint
from posespace.v1 import pose_service_pb2

_BATCH = 256  # queries in one message, the service's limit unless it was told otherwise
_REBUILDS = 5  # that may overtake one call before it gives up

# What weights are refused with that are meant for other drawings than the built ones.
_OTHER_DRAWINGS = ("SHAPE_NOT_FOUND", "WEIGHTS_COUNT_MISMATCH")

T = TypeVar("T")


class Session(Authoring):
    """A session of the service; made by Client.create_session and Client.session.

        session = client.create_session("tux")
        session.put_shape("stand", image="stand.png")
        session.put_shape("jump", image="jump.png")
        session.set_placements({"stand": (0, 0), "jump": (0, 1)})
        session.build()
        frame = session.blend(at=(0.0, 0.5))      # frame.vertices: (V, 2) float32
        pixels = session.render(at=(0.0, 0.5))    # (512, 512, 4) uint8

    A handle: what it stands for lives in the service, and other clients may change it.  Share it
    between threads freely.

    Drawing coordinates are pixels, x right, y down.  Every call may raise NotFound when the session
    is gone, Unavailable, and DeadlineExceeded after the client's timeout.
    """

    def __init__(self, channel: Channel, session_id: str) -> None:
        super().__init__(channel, session_id)
        self._built: tuple[str, list[str]] | None = None  # a revision, and its drawings in order

    def mesh(self) -> Mesh:
        """The triangles and the vertices of every drawing.  Raises NotBuilt."""
        return messages.mesh(self._mesh_message())

    def texture_png(self, shape_id: str) -> bytes:
        """A drawing's pixels as a PNG file, straight alpha; mesh().textures says where they lie.

        Raises NotFound, NotBuilt.
        """
        request = messages.make(
            pose_service_pb2.GetTextureRequest, session_id=self._id, shape_id=shape_id
        )
        png: bytes = self._channel.call(self._channel.poses.GetTexture, request).png
        return png

    def texture(self, shape_id: str) -> NDArray[np.uint8]:
        """A drawing's pixels (H, W, 4) uint8, straight alpha.  Raises NotFound, NotBuilt."""
        return decode_png(self.texture_png(shape_id))

    def blend(
        self,
        at: Place | None = None,
        *,
        weights: Mapping[str, float] | None = None,
        method: BlendMethod = "rigid",
        refits: int | None = None,
        shear_limit: ShearLimit | None = None,
        stretch: StretchBlend = "linear",
        repair: bool = False,
        anchor: MeshPoint | None = None,
        sigma: float = 0.0,
    ) -> Frame:
        """The drawing at a point of pose space, or at explicit weights.

            frame = session.blend(at=(0.0, 0.5))
            frame = session.blend(weights={"stand": 0.5, "jump": 0.5})

        weights      Finite, summing to 1 within 1e-3; drawings left out weigh 0.  Outside [0, 1]
                     they extrapolate.
        method       "rigid": limbs turn instead of shrinking.  "linear": mean of the vertices.
                     "paper": as published, the first drawing as rest shape, no refits.
        refits       Rotation refits of "rigid", 0 to 3; 3 by default.
        shear_limit  How weights outside [0, 1] act on stretch and texture: "band", "hermite",
                     "off"; by default "band", and "hermite" with "paper".
        sigma        Sharpness of texture transitions, 0 (linear) to 1 (a step).
        stretch      How lengths are mixed by "rigid": "linear"; "log", so that they multiply and
                     never invert; "metric", their squares.  The last two take longer.
        repair       Unfold the frame where triangles fold over (`.mended` says how many); takes
                     milliseconds where there is something to mend.
        anchor       A place of the mesh (`Mesh.point`) by which frames are placed: it lies at the
                     weighted mean of its places in the drawings, so that a foot that stands in all
                     of them stands.  By default the centroid of each part of the mesh does.

        Raises NotBuilt, InvalidArgument (POSE_NOT_FINITE, WEIGHTS_SUM_NOT_ONE, ...), NotFound for
        weights of an unknown drawing.
        """
        options = messages.blend_options(
            method, shear_limit, refits, sigma, stretch, repair, anchor
        )

        def ask(revision: str, shape_ids: list[str]) -> Frame:
            request = pose_service_pb2.BlendRequest(
                session_id=self._id,
                queries=[messages.query(at, weights, shape_ids, options)],
                revision=revision,
            )
            (answer,) = self._channel.call(self._channel.poses.Blend, request).frames
            return messages.frame(answer, shape_ids, revision)

        return self._of_one_revision(ask)

    def blend_many(
        self,
        points: ArrayLike,
        *,
        method: BlendMethod = "rigid",
        refits: int | None = None,
        shear_limit: ShearLimit | None = None,
        stretch: StretchBlend = "linear",
        repair: bool = False,
        anchor: MeshPoint | None = None,
    ) -> NDArray[np.float32]:
        """The vertices at many points of pose space: (K, 2) -> (K, V, 2) float32.

            walk = session.blend_many([(0, t) for t in np.linspace(0, 1, 60)])

        All of one revision, also when there are too many points for one message.  Options and
        errors as in `blend`; one bad point refuses the whole call, and `fields` names it.
        """
        places = messages.points_array(points, "points")
        options = messages.blend_options(method, shear_limit, refits, 0.0, stretch, repair, anchor)

        def ask(revision: str, shape_ids: list[str]) -> NDArray[np.float32]:
            if len(places) == 0:
                return np.empty((0, self._mesh_message(revision).report.vertices, 2), np.float32)
            frames = self._blend_batches(places, options, revision, weights_only=False)
            joined = b"".join(frame.vertices for frame in frames)
            return np.frombuffer(joined, "<f4").reshape(len(places), -1, 2).astype(np.float32)

        return self._of_one_revision(ask)

    def weights(self, points: ArrayLike) -> NDArray[np.float64]:
        """The weights of the drawings at points of pose space: (K, 2) -> (K, N) float64.

        Columns in the order of `shape_ids` at the time of the build; rows sum to 1.  Errors as in
        `blend_many`.
        """
        places = messages.points_array(points, "points")
        options = messages.blend_options("rigid", None, None, 0.0)

        def ask(revision: str, shape_ids: list[str]) -> NDArray[np.float64]:
            frames = self._blend_batches(places, options, revision, weights_only=True)
            return np.array([frame.weights for frame in frames]).reshape(-1, len(shape_ids))

        return self._of_one_revision(ask)

    def render(
        self,
        at: Place | None = None,
        *,
        weights: Mapping[str, float] | None = None,
        size: tuple[int, int] = (512, 512),
        view: tuple[float, float, float, float] | None = None,
        method: BlendMethod = "rigid",
        refits: int | None = None,
        shear_limit: ShearLimit | None = None,
        stretch: StretchBlend = "linear",
        repair: bool = False,
        anchor: MeshPoint | None = None,
        sigma: float = 0.0,
        edges: Edges = "crisp",
    ) -> NDArray[np.uint8]:
        """A picture of the drawing there: (H, W, 4) uint8, rows from the top, straight alpha, sRGB.

            pixels = session.render(at=(0.0, 0.5), size=(320, 240))

        size  Width and height, 1 to 4096.
        view  What to show: x, y, width, height in drawing pixels, fitted with its aspect kept.  By
              default the box of all drawings and of their halves, with a margin; the same always.
        edges What is shown where some drawings are painted and others are not: "crisp" a sharp
              silhouette, by the weighted mean of the distances from their edges; "soft" the mix of
              paint and transparency, with ghosts of what only some drawings have.

        Place, options and errors as in `blend`; InvalidArgument also for sizes.
        """
        request = self._render_request(size, view, edges)
        options = messages.blend_options(
            method, shear_limit, refits, sigma, stretch, repair, anchor
        )
        channel = self._channel

        def ask(revision: str, shape_ids: list[str]) -> NDArray[np.uint8]:
            query = messages.query(at, weights, shape_ids, options)
            del request.queries[:]
            request.queries.append(query)
            (answer,) = channel.stream(channel.poses.Render, request, channel.timeout)
            if revision and answer.revision != revision:
                raise NotFound("rendered another revision", reason="REVISION_NOT_FOUND")
            return messages.pixels(answer.image, request.width, request.height)

        return ask("", []) if weights is None else self._of_one_revision(ask)

    def animate(
        self,
        path: Waypoints,
        *,
        fps: float = 60,
        easing: Easing = "uniform",
        loop: bool = False,
        duration: float | None = None,
        paced: bool = False,
        method: BlendMethod = "rigid",
        refits: int | None = None,
        shear_limit: ShearLimit | None = None,
        stretch: StretchBlend = "linear",
        repair: bool = False,
        anchor: MeshPoint | None = None,
        sigma: float = 0.0,
    ) -> Generator[AnimationFrame, None, None]:
        """Drawings along a smooth path through points of pose space, one by one.

            for frame in session.animate([(0, 0), (0.5, 1), (0, 1)], fps=30, loop=True):
                draw(frame.vertices)

        path      1 to 1,000 points (x, y), or (x, y, seconds from the start) with times that grow.
                  The curve through them has no jump in velocity or acceleration.
        fps       Frames a second, more than 0 to 1,000: frame k is the drawing at k / fps.
        easing    "uniform": as the times say, or at even speed from point to point.  "in-out": the
                  path as a whole starts and ends at rest.
        loop      Go on to the first point and smoothly through it; one round is played, without
                  repeating its first frame.
        duration  Seconds for the whole of a path without times, up to 3,600; by default one second
                  from point to point.
        paced     The service sends each frame at its instant; by default as fast as it is read.

        Nothing is asked before the first frame is taken.  All frames are of one revision.  Leaving
        the loop, or closing the iterator, ends the stream; there is no timeout, but a connection
        that has died is noticed.

        Raises, with the first frame, NotBuilt and InvalidArgument (PATH_INVALID, TOO_MANY_FRAMES,
        ...); other options and errors as in `blend`.
        """
        options = messages.blend_options(
            method, shear_limit, refits, sigma, stretch, repair, anchor
        )
        request = messages.make(
            pose_service_pb2.AnimateRequest,
            session_id=self._id,
            animation=animation(path, fps, easing, loop, duration, options),
            paced=paced,
        )
        return self._animation_frames(request)

    def render_animation(
        self,
        path: Waypoints,
        *,
        fps: float = 60,
        easing: Easing = "uniform",
        loop: bool = False,
        duration: float | None = None,
        size: tuple[int, int] = (512, 512),
        view: tuple[float, float, float, float] | None = None,
        method: BlendMethod = "rigid",
        refits: int | None = None,
        shear_limit: ShearLimit | None = None,
        stretch: StretchBlend = "linear",
        repair: bool = False,
        anchor: MeshPoint | None = None,
        sigma: float = 0.0,
        edges: Edges = "crisp",
    ) -> Generator[NDArray[np.uint8], None, None]:
        """Pictures along a smooth path, one by one: (H, W, 4) uint8 each.

            frames = session.render_animation([(0, 0), (0, 1)], fps=30, size=(320, 320))
            posespace.save_animation(frames, "wave.gif", fps=30)

        At most 10,000 frames.  Path and streaming as in `animate`, pictures as in `render`.
        """
        request = self._render_request(size, view, edges)
        options = messages.blend_options(
            method, shear_limit, refits, sigma, stretch, repair, anchor
        )
        request.animation.CopyFrom(animation(path, fps, easing, loop, duration, options))
        return self._animation_pictures(request)

    def play(self, *, revision: str = "") -> Player:
        """Opens the stream of frames, with this session bound to it; see Player.

            with session.play() as player:
                for frame in player.frames(points): ...

        revision  Stay with this built pose space; by default frames follow rebuilds.

        Raises NotBuilt.
        """
        return Player(self._channel, self._id, revision)

    def _render_request(
        self,
        size: tuple[int, int],
        view: tuple[float, float, float, float] | None,
        edges: Edges,
    ) -> pose_service_pb2.RenderRequest:
        width, height = messages.picture_size(size)
        request = messages.make(
            pose_service_pb2.RenderRequest,
            session_id=self._id,
            width=width,
            height=height,
            format=pose_service_pb2.IMAGE_FORMAT_RGBA,
            edges=messages.edges_value(edges),
        )
        if view is not None:
            request.view.CopyFrom(messages.box(view))
        return request

    def _animation_frames(
        self, request: pose_service_pb2.AnimateRequest
    ) -> Generator[AnimationFrame, None, None]:
        def begin(revision: str, shape_ids: list[str]) -> tuple[Any, Any, list[str]]:
            request.revision = revision
            answers = self._channel.stream(self._channel.poses.Animate, request, None)
            return next(answers), answers, shape_ids

        first, answers, shape_ids = self._of_one_revision(begin)
        with contextlib.closing(answers):
            for answer in itertools.chain([first], answers):
                yield messages.animation_frame(answer, shape_ids)

    def _animation_pictures(
        self, request: pose_service_pb2.RenderRequest
    ) -> Generator[NDArray[np.uint8], None, None]:
        answers = self._channel.stream(self._channel.poses.Render, request, None)
        with contextlib.closing(answers):
            for answer in answers:
                yield messages.pixels(answer.image, request.width, request.height)

    def _blend_batches(
        self,
        places: NDArray[np.float64],
        options: pose_service_pb2.BlendOptions,
        revision: str,
        weights_only: bool,
    ) -> list[pose_service_pb2.Frame]:
        frames: list[pose_service_pb2.Frame] = []
        for first in range(0, len(places), _BATCH):
            request = pose_service_pb2.BlendRequest(
                session_id=self._id,
                queries=messages.at_queries(places[first : first + _BATCH].tolist(), options),
                revision=revision,
                weights_only=weights_only,
            )
            frames += self._channel.call(self._channel.poses.Blend, request).frames
        return frames

    def _of_one_revision(self, ask: Callable[[str, list[str]], T]) -> T:
        """What `ask` answers for the current revision and its drawings.

        Weights travel without names and batches one by one, so each call says which revision it
        means; when a rebuild has overtaken it, it is made again for the new one.
        """
        for _ in range(_REBUILDS):
            from_before = self._built is not None
            try:
                return ask(*self._revision_and_shape_ids())
            except Error as error:
                overtaken = error.reason == "REVISION_NOT_FOUND"
                if not overtaken and not (from_before and error.reason in _OTHER_DRAWINGS):
                    raise
                self._built = None
        return ask(*self._revision_and_shape_ids())

    def _revision_and_shape_ids(self) -> tuple[str, list[str]]:
        if self._built is None:
            mesh = self._mesh_message()
            self._built = (mesh.revision, [pose.shape_id for pose in mesh.poses])
        return self._built

    def _mesh_message(self, revision: str = "") -> Any:
        request = messages.make(
            pose_service_pb2.GetMeshRequest, session_id=self._id, revision=revision
        )
        return self._channel.call(self._channel.poses.GetMesh, request).mesh
