# SPDX-License-Identifier: Apache-2.0
"""The stream of frames that avatar servers live on."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from types import TracebackType
from typing import TYPE_CHECKING, Any

from posespace import messages
from posespace.channel import Channel
from posespace.errors import Conflict, Error, NotBuilt, NotFound, Unavailable, error_of_reason
from posespace.messages import BlendMethod, Place, ShearLimit, StretchBlend
from posespace.play_stream import PlayStream
from posespace.results import Frame, MeshPoint
from posespace.v1 import pose_service_pb2

if TYPE_CHECKING:
    from posespace.session import Session


_FORMATS = (pose_service_pb2.VERTEX_FORMAT_FLOAT32, pose_service_pb2.VERTEX_FORMAT_INT16)


class Avatar:
    """A session bound to a stream; made by Player.bind, it makes items for Player.tick.

    session_id, slot   What is bound where.
    revision           The pose space its next results are of; it follows rebuilds, and is empty
                       once the session was deleted.
    vertex_count       Vertices of a frame.
    shape_ids          Drawings, in the order of weights.
    """

    def __init__(self, session_id: str, slot: int, pinned: str = "") -> None:
        self.session_id = session_id
        self.slot = slot
        self._pinned = pinned  # a revision to stay with
        self.revision = ""
        self.vertex_count = 0
        self.shape_ids: list[str] = []

    def item(
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
    ) -> Item:
        """avatar.item(at=(0, 0.5)): a query as in Session.blend, to be answered by Player.tick."""
        options = messages.blend_options(
            method, shear_limit, refits, sigma, stretch, repair, anchor
        )
        query = messages.query(at, weights, self.shape_ids, options)
        message = pose_service_pb2.PlayRequest.Item(slot=self.slot, query=query)
        return Item(self, message, None if weights is None else self.shape_ids)

    def _bind_message(self) -> pose_service_pb2.PlayRequest:
        bind = messages.make(
            pose_service_pb2.PlayRequest.Bind,
            slot=self.slot,
            session_id=self.session_id,
            pinned_revision=self._pinned,
        )
        return pose_service_pb2.PlayRequest(bind=bind)

    def _follow(self, message: Any) -> None:
        self.revision = message.revision
        if not message.revision:
            return
        self.vertex_count = message.vertex_count
        self.shape_ids = list(message.shape_ids)


class Item:
    """One avatar's query in a tick; made by Avatar.item."""

    def __init__(
        self,
        avatar: Avatar,
        message: pose_service_pb2.PlayRequest.Item,
        meant_for: list[str] | None = None,
    ) -> None:
        self.avatar = avatar
        self._message = message
        self._meant_for = meant_for  # the drawings that its weights name, in order

    def _answer(self, result: pose_service_pb2.PlayResponse.ItemResult) -> Frame | Error:
        avatar = self.avatar
        if self._meant_for is not None and avatar.revision and self._meant_for != avatar.shape_ids:
            return Conflict(
                f"session '{avatar.session_id}' was built again from other drawings than the "
                f"weights are for: {', '.join(avatar.shape_ids)}",
                reason="REVISION_NOT_FOUND",
            )
        if result.reason == "SLOT_NOT_BOUND" and not avatar.revision:
            return NotFound(
                f"session '{avatar.session_id}' was deleted", reason="SESSION_NOT_FOUND"
            )
        if result.reason:
            return error_of_reason(result.reason, result.error_message)
        return messages.frame(result.frame, avatar.shape_ids, avatar.revision, fading=result.fading)


class Player:
    """A stream of frames, open as long as its `with`; made by Session.play.  One thread at a time.

        with session.play() as player:
            for frame in player.frames((0.0, t / 60) for t in range(60)):
                draw(frame.vertices)

            crowd = [player.avatar, player.bind(other_session)]      # many avatars, one message
            for frame in player.tick([avatar.item(at=(0, 0.5)) for avatar in crowd]):
                ...

    New placements of a session, with the same mesh, do not make its avatars jump: frames at points
    come over to them within 150 ms (unless the service was told otherwise) of the first one that is
    asked for, and have `fading` set meanwhile.  Who asks only for avatars that have moved, asks
    again for those, too.

    When the service wants the stream to end (it ends itself, or the stream is old), what is under
    way is still answered, and the player goes on over a new stream if it gets one.

    avatar     The session that play() was called on.
    max_slots, max_items, max_in_flight
               Limits of the stream: sessions bound, items in a tick, frames under way at once.
    """

    def __init__(self, channel: Channel, session_id: str, revision: str) -> None:
        self._channel = channel
        self._avatars: dict[int, Avatar] = {}
        self._asked: dict[int, list[Item]] = {}  # frames under way
        self._answers: dict[int, list[Frame | Error]] = {}  # here, and not yet their turn
        self._next_frame_id = 1
        self._stream = self._open()
        try:
            self.avatar = self._bind(session_id, revision)
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Player:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Ends the stream; what is still under way is lost."""
        self._stream.close()

    def bind(self, session: Session, *, revision: str = "") -> Avatar:
        """Adds a session to the stream.

        revision  Stay with this built pose space even when the session is built again; by default
                  results follow the session.

        Raises NotFound, NotBuilt; InvalidArgument (SLOT_LIMIT) beyond max_slots.
        """
        return self._bind(session.id, revision)

    def unbind(self, avatar: Avatar) -> None:
        """Frees an avatar's slot for another."""
        if self._avatars.get(avatar.slot) is avatar:
            del self._avatars[avatar.slot]
            self._send(
                pose_service_pb2.PlayRequest(
                    unbind=pose_service_pb2.PlayRequest.Unbind(slot=avatar.slot)
                )
            )

    def frames(
        self,
        points: Iterable[Place],
        *,
        avatar: Avatar | None = None,
        method: BlendMethod = "rigid",
        refits: int | None = None,
        shear_limit: ShearLimit | None = None,
        stretch: StretchBlend = "linear",
        repair: bool = False,
        anchor: MeshPoint | None = None,
        sigma: float = 0.0,
        with_weights: bool = True,
        compact: bool = False,
    ) -> Iterator[Frame]:
        """One frame a point, in order.

        Up to max_in_flight frames are under way while yours is being used, so `points` is read that
        far ahead; it may be endless.  Options as in Session.blend; `avatar` is by default the
        session that play() was called on; without weights frames are smaller on the wire.
        `compact` ones have half the bytes: vertices travel as int16 and are off by at most
        1/128,000 of the longer side of the drawing's box.

        Raises the errors of Session.blend for a point that cannot be answered (the stream goes on),
        NotFound once the session was deleted, DeadlineExceeded when a frame takes longer than the
        client's timeout, Unavailable when the service ends (DRAINING: it said so in time) and no
        other takes its place.
        """
        avatar = avatar or self.avatar
        options = messages.blend_options(
            method, shear_limit, refits, sigma, stretch, repair, anchor
        )
        under_way: deque[int] = deque()

        def oldest() -> Frame:
            frame = self._await(under_way.popleft())[0]
            if isinstance(frame, Error):
                raise frame
            return frame

        try:
            for at in points:
                query = messages.query(at, None, (), options)
                message = pose_service_pb2.PlayRequest.Item(slot=avatar.slot, query=query)
                under_way.append(self._ask([Item(avatar, message)], with_weights, compact))
                if len(under_way) >= max(1, self.max_in_flight):
                    yield oldest()
            while under_way:
                yield oldest()
        finally:  # abandoned: their results are dropped as they come
            for frame_id in under_way:
                self._forget(frame_id)

    def tick(
        self, items: Iterable[Item], *, with_weights: bool = True, compact: bool = False
    ) -> list[Frame | Error]:
        """Many avatars' frames, asked for in one message and answered together, in order.

        An item that cannot be answered has its error in its place, not raised: one avatar's mistake
        leaves the others alone.  More than max_items items go in several messages.  `compact` as in
        frames().

        Raises DeadlineExceeded when the answer takes longer than the client's timeout, Unavailable
        when the service ends.
        """
        items = list(items)
        step = max(1, self.max_items)
        asked = [
            self._ask(items[first : first + step], with_weights, compact)
            for first in range(0, len(items), step)
        ]
        try:
            return [answer for frame_id in asked for answer in self._await(frame_id)]
        finally:
            for frame_id in asked:
                self._forget(frame_id)

    def _open(self) -> PlayStream:
        stream = PlayStream(self._channel)
        self.max_slots: int = stream.welcome.max_slots
        self.max_items: int = stream.welcome.max_items
        self.max_in_flight: int = stream.welcome.max_in_flight
        return stream

    def _bind(self, session_id: str, revision: str) -> Avatar:
        slot = next(slot for slot in range(len(self._avatars) + 1) if slot not in self._avatars)
        avatar = Avatar(session_id, slot, revision)
        self._send(avatar._bind_message())
        self._await_bound(avatar)
        self._avatars[slot] = avatar
        return avatar

    def _await_bound(self, avatar: Avatar) -> None:
        give_up = time.monotonic() + self._channel.timeout
        while True:
            bound = self._receive(give_up).bound
            if bound.slot == avatar.slot and (bound.reason or bound.revision):
                break
        if bound.reason:
            raise error_of_reason(bound.reason, bound.error_message)
        avatar._follow(bound)

    def _move(self) -> None:
        """Leaves a stream that the service wants to end for a new one, with the same avatars."""
        give_up = time.monotonic() + self._channel.timeout
        try:
            while self._stream.unanswered:
                self._receive(give_up)
            stream = self._open()
        except Unavailable:
            return  # there is no other: the old one says how it ends
        self._stream.close()
        self._stream = stream
        for avatar in self._avatars.values():
            if not avatar.revision:  # its session was deleted
                continue
            self._stream.send(avatar._bind_message())
            try:
                self._await_bound(avatar)
            except (NotFound, NotBuilt):
                avatar.revision = ""

    def _ask(self, items: list[Item], with_weights: bool, compact: bool) -> int:
        frame_id = self._next_frame_id
        self._next_frame_id += 1
        self._send(
            pose_service_pb2.PlayRequest(
                tick=pose_service_pb2.PlayRequest.Tick(
                    frame_id=frame_id,
                    items=[item._message for item in items],
                    with_weights=with_weights,
                    vertex_format=_FORMATS[compact],
                )
            )
        )
        self._asked[frame_id] = items
        return frame_id

    def _await(self, frame_id: int) -> list[Frame | Error]:
        """The answers of one frame; those of others are kept for their turn."""
        give_up = time.monotonic() + self._channel.timeout
        while frame_id not in self._answers:
            self._receive(give_up)
        return self._answers.pop(frame_id)

    def _forget(self, frame_id: int) -> None:
        self._asked.pop(frame_id, None)
        self._answers.pop(frame_id, None)

    def _send(self, request: pose_service_pb2.PlayRequest) -> None:
        if self._stream.draining:
            self._move()
        self._stream.send(request)

    def _receive(self, give_up: float) -> pose_service_pb2.PlayResponse:
        """The next message, already taken note of."""
        message = self._stream.receive(give_up)
        kind = message.WhichOneof("message")
        if kind == "frame_result":
            self._take(message.frame_result)
        elif kind == "revision_changed" and message.revision_changed.slot in self._avatars:
            self._avatars[message.revision_changed.slot]._follow(message.revision_changed)
        return message

    def _take(self, result: pose_service_pb2.PlayResponse.FrameResult) -> None:
        """Keeps a frame's answers, with the revision that its avatars have at this moment."""
        items = self._asked.pop(result.frame_id, None)
        if items is None:  # nobody waits for it any more
            return
        self._answers[result.frame_id] = [
            item._answer(answer) for item, answer in zip(items, result.items, strict=True)
        ]
