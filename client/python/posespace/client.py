# SPDX-License-Identifier: Apache-2.0
"""The connection to a service, and its sessions."""

from __future__ import annotations

import uuid
from collections.abc import Mapping
from types import TracebackType

from grpc_health.v1 import health_pb2

from posespace import messages
from posespace.channel import Channel
from posespace.errors import Unavailable
from posespace.results import SessionState
from posespace.session import Session
from posespace.v1 import session_service_pb2


def connect(address: str, *, timeout: float = 5.0) -> Client:
    """A client of the service at `address`, "HOST:PORT" or "unix:PATH".

        with posespace.connect("127.0.0.1:7433") as client:
            session = client.create_session("tux")

    timeout  Seconds that a call may take, and that a frame of a stream may be waited for, before
             DeadlineExceeded.  Within it, a call that the service refuses for a moment (a full
             queue) is tried again.  Builds have a timeout of their own.

    Nothing is sent until the first call.
    """
    return Client(Channel(address, timeout))


class Client:
    """Made by `connect`.  Share it between threads freely; close it, or use it in a `with`."""

    def __init__(self, channel: Channel) -> None:
        self._channel = channel

    def __enter__(self) -> Client:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<posespace.Client of {self._channel.address}>"

    def close(self) -> None:
        """Ends the connection; calls and streams under way end as Cancelled."""
        self._channel.close()

    def ping(self) -> None:
        """Returns when the service answers and serves; else raises Unavailable."""
        answer = self._channel.call(self._channel.health.Check, health_pb2.HealthCheckRequest())
        if answer.status != health_pb2.HealthCheckResponse.SERVING:
            raise Unavailable(f"the service at {self._channel.address} is not serving")

    def create_session(
        self,
        session_id: str | None = None,
        *,
        display_name: str = "",
        labels: Mapping[str, str] | None = None,
    ) -> Session:
        """A new, empty session.

            session = client.create_session("tux", display_name="Tux")

        session_id  1-63 of letters, digits, '_', '.', '-', beginning with a letter or digit; None:
                    the service chooses one that cannot be guessed.
        labels      Notes of your own: up to 64, of up to 256 bytes each.

        Raises AlreadyExists, InvalidArgument (INVALID_ID), ResourceExhausted (SESSION_LIMIT).
        """
        request = messages.make(
            session_service_pb2.CreateSessionRequest,
            session_id=session_id or "",
            display_name=display_name,
            labels=labels or {},
            request_id=uuid.uuid4().hex,
        )
        created = self._channel.call(self._channel.sessions.CreateSession, request).session
        return Session(self._channel, created.id)

    def session(self, session_id: str) -> Session:
        """The session of that id.  Raises NotFound."""
        session = Session(self._channel, session_id)
        session.state()
        return session

    def sessions(self) -> list[Session]:
        """All sessions, by id."""
        return [Session(self._channel, state.id) for state in self.session_states()]

    def session_states(self) -> list[SessionState]:
        """All sessions as they stand, by id."""
        request = session_service_pb2.ListSessionsRequest(page_size=1000)
        found: list[SessionState] = []
        while True:
            page = self._channel.call(self._channel.sessions.ListSessions, request)
            found += [messages.session_state(message) for message in page.sessions]
            if not page.next_page_token:
                return found
            request.page_token = page.next_page_token
