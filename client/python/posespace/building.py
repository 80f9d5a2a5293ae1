# SPDX-License-Identifier: Apache-2.0
"""A build watched to its end."""

from __future__ import annotations

import contextlib
import math
import time
from collections.abc import Callable, Iterator

from posespace import messages
from posespace.channel import Channel
from posespace.errors import Cancelled, DeadlineExceeded, Error, Unavailable
from posespace.results import BuildReport
from posespace.v1 import session_service_pb2

OnProgress = Callable[[str, float], object]

_FIRST_PAUSE, _LONGEST_PAUSE = 0.05, 1.0  # seconds between tries to reach the service again


def build_and_wait(
    channel: Channel,
    request: session_service_pb2.StartBuildRequest,
    on_progress: OnProgress | None,
    timeout: float | None,
) -> BuildReport:
    """Starts a build and follows it to its end; see Session.build."""
    deadline = None if timeout is None else time.monotonic() + timeout
    session_id = request.session_id
    patience = math.inf if timeout is None else timeout  # a full queue is waited for
    started = channel.call(channel.sessions.StartBuild, request, patience=patience)
    try:
        for build in _changes(channel, session_id, deadline):
            if build.id != started.build.id:
                raise Cancelled(
                    f"another build of session '{session_id}' has replaced this one",
                    reason="CANCELLED",
                )
            if on_progress is not None:
                on_progress(build.stage, build.fraction)
            if build.HasField("error"):
                raise messages.build_error(build.error)
            if build.state == session_service_pb2.BUILD_STATE_SUCCEEDED:
                break
        return messages.report(build.report)
    except DeadlineExceeded as error:
        if error.reason:  # the service's own limit
            raise
        _cancel(channel, session_id, started)
        outcome = "another caller's build goes on" if started.attached else "its build is cancelled"
        raise DeadlineExceeded(
            f"session '{session_id}' was not built within {timeout:g} s; {outcome}"
        ) from None
    except Error:
        raise
    except BaseException:  # Ctrl-C, or what on_progress raised
        _cancel(channel, session_id, started)
        raise


def _cancel(
    channel: Channel, session_id: str, started: session_service_pb2.StartBuildResponse
) -> None:
    """Stops a build that was started here; others may wait for one that was there already."""
    if started.attached:
        return
    request = session_service_pb2.CancelBuildRequest(
        session_id=session_id, build_id=started.build.id
    )
    with contextlib.suppress(Error):
        channel.call(channel.sessions.CancelBuild, request)


def _changes(
    channel: Channel, session_id: str, deadline: float | None
) -> Iterator[session_service_pb2.Build]:
    """The build after each change, without end: where the stream breaks, it is taken up again after
    the last change seen."""
    after_sequence = 0
    while True:
        request = session_service_pb2.WatchBuildRequest(
            session_id=session_id, after_sequence=after_sequence
        )
        remaining = None if deadline is None else max(0.0, deadline - time.monotonic())
        watch = channel.stream(channel.sessions.WatchBuild, request, remaining)
        with contextlib.closing(watch), contextlib.suppress(Unavailable):
            for event in watch:
                after_sequence = event.build.sequence
                yield event.build
        build = _once_reached(channel, session_id)
        if build.sequence > after_sequence:
            after_sequence = build.sequence
            yield build


def _once_reached(channel: Channel, session_id: str) -> session_service_pb2.Build:
    """The build as it stands, as soon as the service answers; Unavailable when it does not within
    the client's timeout."""
    request = session_service_pb2.GetSessionRequest(session_id=session_id)
    give_up = time.monotonic() + channel.timeout
    pause = _FIRST_PAUSE
    while True:
        time.sleep(pause)
        pause = min(2 * pause, _LONGEST_PAUSE)
        try:
            build: session_service_pb2.Build
            build = channel.call(channel.sessions.GetSession, request).session.build
            return build
        except Unavailable:
            if time.monotonic() > give_up:
                raise
