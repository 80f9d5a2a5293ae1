# SPDX-License-Identifier: Apache-2.0
"""What a session is made of: its drawings, marks and placements, and its build."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence

from numpy.typing import ArrayLike

from posespace import messages
from posespace.building import OnProgress, build_and_wait
from posespace.channel import Channel
from posespace.errors import InvalidArgument
from posespace.messages import Foreground, Place, Rotation
from posespace.pictures import Picture, file_bytes, picture_bytes
from posespace.results import Build, BuildReport, SessionState, Shape, Suggestion
from posespace.v1 import session_service_pb2

_MATCHING = 120.0  # seconds: the service's limit for a build unless it was told otherwise


class Authoring:
    """The part of Session that makes it; the rest reads what was built."""

    def __init__(self, channel: Channel, session_id: str) -> None:
        self._channel = channel
        self._id = session_id

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
        svg: str | os.PathLike[str] | bytes | None = None,
        foreground: Foreground = "alpha",
        threshold: int | None = None,
        polygon: ArrayLike | None = None,
        holes: Sequence[ArrayLike] = (),
        texture: Picture | None = None,
        flip: bool = False,
        replace: bool = False,
    ) -> Shape:
        """Adds a drawing and answers how it was understood.

            session.put_shape("stand", image="stand.png")
            session.put_shape("jump", image=pixels)             # (H, W, 3 or 4) uint8, or bytes
            session.put_shape("run", image="scan.jpg", foreground="dark")
            session.put_shape("wave", svg="wave.svg")
            session.put_shape("star", polygon=ring, holes=[ring])

        image       Path or bytes of a PNG, JPEG or WebP file, or array with straight alpha.
        svg         Path or bytes of an SVG document or its gzip; one user unit is one drawing
                    pixel.  Nothing outside the document is loaded.
        foreground  Which pixels are the drawing.  "alpha": those whose alpha reaches the threshold;
                    a picture that is opaque all over loses its paper, the one colour around the
                    drawing.  "light", "dark": those lighter, or darker, than the plain background.
        threshold   1 to 255.  Of alpha: 128 by default.  Of brightness, as the distance from the
                    background: by default half of the picture's range.
        polygon     Ring (K, 2) in drawing pixels, either orientation; `holes` likewise.  A ring
                    that crosses itself is filled by the non-zero rule and traced anew.
        texture     Picture whose pixels are the polygon's drawing pixels; one colour without it.
        flip        Keep its mirror image, as accepted from `suggest`: left and right exchanged
                    about the middle of the picture, or of the polygon's box when it has none.
                    Outline, marks and mesh are then in the mirror image's coordinates; marks in
                    the same drawing unflipped move with it.
        replace     Overwrite a drawing of the same id.

        Whatever was done to the drawing is said in the answer's `warnings`.

        Raises InvalidDrawing (the message says why no outline can be made of it), AlreadyExists
        when the id has another drawing, ResourceExhausted when the picture is too large to send.
        """
        request = messages.make(
            session_service_pb2.PutShapeRequest,
            session_id=self._id,
            shape_id=shape_id,
            flip=flip,
            replace=replace,
        )
        options = {"foreground": messages.foreground(foreground), "threshold": threshold}
        sources = {"image": image, "svg": svg, "polygon": polygon}
        given = [name for name, value in sources.items() if value is not None]
        if len(given) > 1:
            raise InvalidArgument(
                f"shape '{shape_id}': give one of image=, svg= and polygon=, not {given}",
                reason="INVALID_OPTION",
            )
        if image is not None:
            with messages.argument("image", image):
                request.image.data = picture_bytes(image, shape_id)
            request.image.MergeFrom(messages.make(session_service_pb2.ImageSource, **options))
        if svg is not None:
            with messages.argument("svg", svg):
                request.svg.document = file_bytes(svg)
            request.svg.MergeFrom(messages.make(session_service_pb2.SvgSource, **options))
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

        Each tuple marks one place of the character in any of the drawings, in drawing pixels.  A
        mark in a single drawing makes its place a vertex and ties it to nothing: builds warn of it.

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

    def suggest(
        self,
        *,
        samples: int | None = None,
        rotation: Rotation = "upright",
        timeout: float = _MATCHING,
    ) -> Suggestion:
        """What automatic matching would do with the drawings and marks as they are.

            found = session.suggest()
            for shape_id in found.flips:                 # they seem to face the other way:
                show(shape_id, found.confidence, found.arcs, found.starts)    # ask a person, then
                session.put_shape(shape_id, image=..., flip=True, replace=True)

        Nothing is changed: flips are proposals, which are wrong for a drawing that only looks as if
        it faced the other way.

        samples   Places of the outline to answer in `arcs`, 1 to 1024; 64 by default.
        rotation  As in `build`.
        timeout   Seconds to wait.

        Raises NotBuilt (NO_SHAPES) without drawings, InvalidArgument when drawings or marks
        contradict each other, DeadlineExceeded.
        """
        request = messages.make(
            session_service_pb2.SuggestCorrespondencesRequest,
            session_id=self._id,
            samples=samples,
            rotation=messages.rotation(rotation),
        )
        suggest = self._channel.sessions.SuggestCorrespondences
        return messages.suggestion(self._channel.call(suggest, request, timeout=timeout))

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
        max_vertices: int | None = None,
        rotation: Rotation = "upright",
        align: bool | None = None,
        on_progress: OnProgress | None = None,
        timeout: float | None = None,
    ) -> BuildReport:
        """Builds the pose space and waits until it is there.

            report = session.build(on_progress=lambda stage, fraction: print(stage, fraction))

        tolerance           Farthest the mesh outline may lie from the drawing's, relative to the
                            square root of its area, 0.001 to 0.2; 0.03 by default.
        target_edge_length  Of mesh edges, in the same unit, 0.02 to 1; 0.08 by default.
        max_vertices        Of the mesh, 3 to what the service allows (8,000 unless it was started
                            with another limit), which is the default: refinement stops there.
        rotation            "upright": what lies in the same place of two drawings is probably the
                            same.  "any": drawings may be turned at will.
        align               Whether inner vertices move so that what is drawn inside corresponds,
                            eyes to eyes; report.ghost_loss says what it gained.  True by default.
        on_progress         Called with the stage's name and the fraction done, which never falls.
        timeout             Seconds to wait; by default as long as the service lets a build take.

        With the same inputs as a running or finished build it attaches to that one; else it starts
        one, and waits for its place when too many builds are queued.  Ctrl-C, an exception in
        on_progress and the timeout cancel a build that this call started, and only that.  A dropped
        connection does not: watching goes on once the service answers again within the client's
        timeout.

        Raises NotBuilt (NO_SHAPES) without drawings, InvalidArgument when drawings or marks
        contradict each other or drawings do not fit into `max_vertices`, Cancelled when somebody
        cancels or replaces the build, ResourceExhausted when the queue stays full for `timeout`,
        DeadlineExceeded after it.
        """
        request = self._build_request(tolerance, target_edge_length, max_vertices, rotation, align)
        return build_and_wait(self._channel, request, on_progress, timeout)

    def start_build(
        self,
        *,
        tolerance: float | None = None,
        target_edge_length: float | None = None,
        max_vertices: int | None = None,
        rotation: Rotation = "upright",
        align: bool | None = None,
    ) -> Build:
        """Starts building as `build` does and returns at once; `state().build` says how it goes."""
        request = self._build_request(tolerance, target_edge_length, max_vertices, rotation, align)
        return messages.build(self._channel.call(self._channel.sessions.StartBuild, request).build)

    def cancel_build(self) -> None:
        """Stops the running build; without one it has no effect."""
        self._channel.call(
            self._channel.sessions.CancelBuild,
            session_service_pb2.CancelBuildRequest(session_id=self._id),
        )

    def _build_request(
        self,
        tolerance: float | None,
        target_edge_length: float | None,
        max_vertices: int | None,
        rotation: Rotation,
        align: bool | None,
    ) -> session_service_pb2.StartBuildRequest:
        options = messages.make(
            session_service_pb2.BuildOptions,
            tolerance=tolerance,
            target_edge_length=target_edge_length,
            max_vertices=max_vertices,
            rotation=messages.rotation(rotation),
            align=align,
        )
        return session_service_pb2.StartBuildRequest(session_id=self._id, options=options)
