# SPDX-License-Identifier: Apache-2.0
"""One Play call: what is said on it, what comes back, and how it ends."""

from __future__ import annotations

import queue
import threading
import time

import grpc

from posespace.channel import Channel
from posespace.errors import DeadlineExceeded, Error, Unavailable
from posespace.v1 import pose_service_pb2


class PlayStream:
    """Messages out and in, in order.  One thread at a time, beside the stream's own.

    welcome  The limits that the service said first.
    """

    def __init__(self, channel: Channel) -> None:
        """Raises Unavailable, DeadlineExceeded."""
        self._channel = channel
        self._outgoing: queue.SimpleQueue[pose_service_pb2.PlayRequest | None] = queue.SimpleQueue()
        self._incoming: queue.SimpleQueue[pose_service_pb2.PlayResponse | Error] = (
            queue.SimpleQueue()
        )
        self._lock = threading.Lock()  # guards the three below
        self._unanswered = 0
        self._stop_sending_at: float | None = None  # the service wants the stream to end
        self._said_all = False
        self._ended: Error | None = None

        self._call = channel.begin(channel.poses.Play, iter(self._outgoing.get, None))
        self._reader = threading.Thread(target=self._read, name="posespace-play", daemon=True)
        self._reader.start()
        try:
            self.welcome = self.receive(time.monotonic() + channel.timeout).welcome
        except BaseException:
            self.close()
            raise

    @property
    def draining(self) -> bool:
        """The service wants this stream to end; another may be opened."""
        with self._lock:
            return self._stop_sending_at is not None

    @property
    def unanswered(self) -> int:
        """Messages that the service has not answered yet."""
        with self._lock:
            return self._unanswered

    def send(self, request: pose_service_pb2.PlayRequest) -> None:
        """Raises Unavailable when the stream has ended or takes nothing more."""
        if self._ended is not None:
            raise self._ended
        with self._lock:
            stop_at = self._stop_sending_at
            if self._said_all or (stop_at is not None and time.monotonic() >= stop_at):
                raise self._drained()
            if request.WhichOneof("message") != "unbind":
                self._unanswered += 1
            self._outgoing.put(request)

    def receive(self, give_up: float) -> pose_service_pb2.PlayResponse:
        """The next message.  Raises how the stream ended, DeadlineExceeded at time `give_up`."""
        if self._ended is not None:
            raise self._ended
        try:
            message = self._incoming.get(timeout=max(0.0, give_up - time.monotonic()))
        except queue.Empty:
            raise DeadlineExceeded(
                f"no answer from {self._channel.address} within {self._channel.timeout:g} s"
            ) from None
        if isinstance(message, Error):
            self._ended = message
            raise message
        return message

    def close(self) -> None:
        """Ends the stream; what is still under way is lost."""
        if self._ended is None:
            self._ended = Unavailable("the player is closed")
        self._outgoing.put(None)
        self._reader.join(timeout=0.5)  # ended by the service, if it has nothing left to answer
        self._call.cancel()

    def _drained(self) -> Unavailable:
        return Unavailable(f"the service at {self._channel.address} is ending", reason="DRAINING")

    def _read(self) -> None:
        """Hands over what the service says; a stream alone would wait for it without a limit."""
        try:
            for message in self._call:
                self._note(message)
                self._incoming.put(message)
            ended = Unavailable(f"the service at {self._channel.address} has ended the stream")
            self._incoming.put(ended if self._stop_sending_at is None else self._drained())
        except grpc.RpcError as error:
            self._incoming.put(self._channel.error_of(error))

    def _note(self, message: pose_service_pb2.PlayResponse) -> None:
        """Says the last word to a service that ends as soon as it owes nothing, so that an idle
        player does not hold it."""
        kind = message.WhichOneof("message")
        with self._lock:
            if kind in ("bound", "frame_result"):
                self._unanswered -= 1
            elif kind == "draining":
                grace = message.draining.stop_sending_in.ToTimedelta().total_seconds()
                self._stop_sending_at = time.monotonic() + grace
            if self._stop_sending_at is not None and self._unanswered == 0:
                self._said_all = True
                self._outgoing.put(None)
