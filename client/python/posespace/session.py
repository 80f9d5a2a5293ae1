# SPDX-License-Identifier: Apache-2.0
"""A session: drawings of one character, placed in a plane, and every drawing in between."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Literal, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from posespace import messages
from posespace.building import OnProgress, build_and_wait
from posespace.channel import Channel
from posespace.errors import Error, InvalidArgument, NotFound
from posespace.messages import BlendMethod, Place, ShearLimit
from posespace.pictures import Picture, decode_png, picture_bytes
from posespace.player import Player
from posespace.results import Build, BuildReport, Frame, Mesh, SessionState, Shape
from posespace.v1 import pose_service_pb2, session_service_pb2

_BATCH = 256  # queries in one message, the service's limit unless it was told otherwise
_REBUILDS = 5  # that may overtake one call before it gives up

# What weights are refused with that are meant for other drawings than the built ones.
_OTHER_DRAWINGS = ("SHAPE_NOT_FOUND", "WEIGHTS_COUNT_MISMATCH")

T = TypeVar("T")


class Session:
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
        self._channel = channel
        self._id = session_id
        self._built: tuple[str, list[str]] | None = None  # a revision, and its drawings in order

    @property
    def id(self) -> str:
        """The id it was made with, or that the service chose."""
        return self._id

    @property
    def shape_ids(self) -> list[str]:
        """The drawings in the order of upload, which is the order of weights."""
        return self.state().shape_ids

    def __repr__(self) -> str:
        return f"<posespace.Session {self._id!r} at {self._channel.address}>"

    # What the session holds.

    def state(self) -> SessionState:
        """session.state().placements, .correspondences, .etag, .revision, .build, ..."""
        request = messages.make(session_service_pb2.GetSessionRequest, session_id=self._id)
        return messages.session_state(
            self._channel.call(self._channel.sessions.GetSession, request).session
        )

    def delete(self, *, etag: str = "") -> None:
        """Forgets the session, its drawings and its pose space; a running build is cancelled.

        With `etag`, only when the session still has it; else Conflict.
        """
        self._channel.call(
            self._channel.sessions.DeleteSession,
            messages.make(session_service_pb2.DeleteSessionRequest, session_id=self._id, etag=etag),
        )

    def put_shape(
        self,
        shape_id: str,
        *,
        image: Picture | None = None,
        foreground: Literal["alpha"] = "alpha",
        threshold: int | None = None,
        polygon: ArrayLike | None = None,
        holes: Sequence[ArrayLike] = (),
        texture: Picture | None = None,
        replace: bool = False,
    ) -> Shape:
        """Adds a drawing and answers how it was understood.

            session.put_shape("stand", image="stand.png")
            session.put_shape("jump", image=pixels)             # (H, W, 3 or 4) uint8, or PNG bytes
            session.put_shape("star", polygon=ring, holes=[ring])

        image       Path, bytes of a PNG, or array with straight alpha.
        foreground  Which pixels are the drawing: "alpha", those whose alpha reaches the threshold.
        threshold   1 to 255; 128 by default.
        polygon     Ring (K, 2) in drawing pixels, simple, either orientation; `holes` likewise.
        texture     Picture whose pixels are the polygon's drawing pixels; one colour without it.
        replace     Overwrite a drawing of the same id.

        Raises InvalidDrawing (the message says why no outline can be made of it), AlreadyExists
        when the id has another drawing, ResourceExhausted when the picture is too large to send.
        """
        request = messages.make(
            session_service_pb2.PutShapeRequest,
            session_id=self._id,
            shape_id=shape_id,
            replace=replace,
        )
        if image is not None and polygon is not None:
            raise InvalidArgument(
                f"shape '{shape_id}': give either image= or polygon=", reason="INVALID_OPTION"
            )
        if image is not None:
            source = messages.make(
                session_service_pb2.ImageSource,
                foreground=messages.foreground(foreground),
                threshold=threshold,
            )
            with messages.argument("image", image):
                source.data = picture_bytes(image, shape_id)
            request.image.CopyFrom(source)
        if polygon is not None:
            what = f"shape '{shape_id}': "
            request.polygon.outer.CopyFrom(messages.ring(polygon, what + "polygon"))
            request.polygon.holes.extend(messages.ring(hole, what + "a hole") for hole in holes)
            if texture is not None:
                with messages.argument("texture", texture):
                    request.polygon.texture = picture_bytes(texture, shape_id)
        return messages.shape(self._channel.call(self._channel.sessions.PutShape, request).shape)

    def shape(self, shape_id: str) -> Shape:
        """A drawing's outline and warnings.  Raises NotFound."""
        request = messages.make(
            session_service_pb2.GetShapeRequest, session_id=self._id, shape_id=shape_id
        )
        return messages.shape(self._channel.call(self._channel.sessions.GetShape, request).shape)

    def shapes(self) -> list[Shape]:
        """All drawings, in the order of upload."""
        request = session_service_pb2.ListShapesRequest(session_id=self._id)
        listed = self._channel.call(self._channel.sessions.ListShapes, request)
        return [messages.shape(message) for message in listed.shapes]

    def delete_shape(self, shape_id: str) -> None:
        """Removes a drawing, its marks and its placement.  Raises NotFound."""
        self._channel.call(
            self._channel.sessions.DeleteShape,
            messages.make(
                session_service_pb2.DeleteShapeRequest, session_id=self._id, shape_id=shape_id
            ),
        )

    def set_correspondences(
        self, tuples: Iterable[Mapping[str, Place]], *, etag: str = ""
    ) -> SessionState:
        """Replaces all marked places; they take effect with the next build.

            session.set_correspondences([{"stand": (40, 12), "jump": (52, 9)}, ...])

        Each tuple marks one place of the character in any of the drawings, in drawing pixels.

        Raises InvalidArgument with every fault in `fields` (LANDMARK_OFF_OUTLINE,
        LANDMARKS_OUT_OF_ORDER, ...), NotFound, and Conflict when `etag` is given and outdated.
        """
        with messages.argument("tuples", tuples):
            marks = [messages.correspondence(points) for points in tuples]
        request = messages.make(
            session_service_pb2.SetCorrespondencesRequest,
            session_id=self._id,
            tuples=marks,
            etag=etag,
        )
        changed = self._channel.call(self._channel.sessions.SetCorrespondences, request)
        return messages.session_state(changed.session)

    def set_placements(self, placements: Mapping[str, Place], *, etag: str = "") -> SessionState:
        """Places the drawings in pose space; a built session follows at once, with a new revision.

            session.set_placements({"stand": (0, 0), "jump": (0, 1)})

        One point for every drawing, in any unit; none at all returns to the default, the unit
        circle in the order of upload.

        Raises InvalidArgument (PLACEMENTS_COINCIDE, PLACEMENT_NOT_FINITE), NotFound, and Conflict
        when `etag` is given and outdated.
        """
        with messages.argument("placements", placements):
            placed = [messages.placement(shape_id, at) for shape_id, at in placements.items()]
        request = messages.make(
            session_service_pb2.SetPlacementsRequest,
            session_id=self._id,
            placements=placed,
            etag=etag,
        )
        changed = self._channel.call(self._channel.sessions.SetPlacements, request)
        return messages.session_state(changed.session)

    # Building.

    def build(
        self,
        *,
        tolerance: float | None = None,
        target_edge_length: float | None = None,
        on_progress: OnProgress | None = None,
        timeout: float | None = None,
    ) -> BuildReport:
        """Builds the pose space and waits until it is there.

            report = session.build(on_progress=lambda stage, fraction: print(stage, fraction))

        tolerance           Farthest the mesh outline may lie from the drawing's, relative to the
                            square root of its area, 0.001 to 0.2; 0.03 by default.
        target_edge_length  Of mesh edges, in the same unit, 0.02 to 1; 0.08 by default.
        on_progress         Called with the stage's name and the fraction done, which never falls.
        timeout             Seconds to wait; by default as long as the service lets a build take.

        With the same inputs as a running or finished build it attaches to that one; else it starts
        one, and waits for its place when too many builds are queued.  Ctrl-C, an exception in
        on_progress and the timeout cancel a build that this call started, and only that.  A dropped
        connection does not: watching goes on once the service answers again within the client's
        timeout.

        Raises NotBuilt (NO_SHAPES) without drawings, InvalidArgument when drawings or marks
        contradict each other, Cancelled when somebody cancels or replaces the build,
        ResourceExhausted when the queue stays full for `timeout`, DeadlineExceeded after it.
        """
        request = self._build_request(tolerance, target_edge_length)
        return build_and_wait(self._channel, request, on_progress, timeout)

    def start_build(
        self, *, tolerance: float | None = None, target_edge_length: float | None = None
    ) -> Build:
        """Starts building as `build` does and returns at once; `state().build` says how it goes."""
        request = self._build_request(tolerance, target_edge_length)
        return messages.build(self._channel.call(self._channel.sessions.StartBuild, request).build)

    def cancel_build(self) -> None:
        """Stops the running build; without one it has no effect."""
        self._channel.call(
            self._channel.sessions.CancelBuild,
            session_service_pb2.CancelBuildRequest(session_id=self._id),
        )

    def _build_request(
        self, tolerance: float | None, target_edge_length: float | None
    ) -> session_service_pb2.StartBuildRequest:
        options = messages.make(
            session_service_pb2.BuildOptions,
            tolerance=tolerance,
            target_edge_length=target_edge_length,
        )
        return session_service_pb2.StartBuildRequest(session_id=self._id, options=options)

    # The built pose space.

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

        Raises NotBuilt, InvalidArgument (POSE_NOT_FINITE, WEIGHTS_SUM_NOT_ONE, ...), NotFound for
        weights of an unknown drawing.
        """
        options = messages.blend_options(method, shear_limit, refits, sigma)

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
    ) -> NDArray[np.float32]:
        """The vertices at many points of pose space: (K, 2) -> (K, V, 2) float32.

            walk = session.blend_many([(0, t) for t in np.linspace(0, 1, 60)])

        All of one revision, also when there are too many points for one message.  Options and
        errors as in `blend`; one bad point refuses the whole call, and `fields` names it.
        """
        places = messages.points_array(points, "points")
        options = messages.blend_options(method, shear_limit, refits, 0.0)

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
        sigma: float = 0.0,
    ) -> NDArray[np.uint8]:
        """A picture of the drawing there: (H, W, 4) uint8, rows from the top, straight alpha, sRGB.

            pixels = session.render(at=(0.0, 0.5), size=(320, 240))

        size  Width and height, 1 to 4096.
        view  What to show: x, y, width, height in drawing pixels, fitted with its aspect kept.  By
              default the box of all drawings and of their halves, with a margin; the same always.

        Place, options and errors as in `blend`; InvalidArgument also for sizes.
        """
        width, height = messages.picture_size(size)
        options = messages.blend_options(method, shear_limit, refits, sigma)
        request = pose_service_pb2.RenderRequest(
            session_id=self._id,
            width=width,
            height=height,
            format=pose_service_pb2.IMAGE_FORMAT_RGBA,
        )
        if view is not None:
            request.view.CopyFrom(messages.box(view))
        channel = self._channel

        def ask(revision: str, shape_ids: list[str]) -> NDArray[np.uint8]:
            query = messages.query(at, weights, shape_ids, options)
            del request.queries[:]
            request.queries.append(query)
            (answer,) = channel.stream(channel.poses.Render, request, channel.timeout)
            if revision and answer.revision != revision:
                raise NotFound("rendered another revision", reason="REVISION_NOT_FOUND")
            return np.frombuffer(answer.image, np.uint8).reshape(height, width, 4).copy()

        return ask("", []) if weights is None else self._of_one_revision(ask)

    def play(self, *, revision: str = "") -> Player:
        """Opens the stream of frames, with this session bound to it; see Player.

            with session.play() as player:
                for frame in player.frames(points): ...

        revision  Stay with this built pose space; by default frames follow rebuilds.

        Raises NotBuilt.
        """
        return Player(self._channel, self._id, revision)

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
