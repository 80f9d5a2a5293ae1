# SPDX-License-Identifier: Apache-2.0
"""The connection: its settings, deadlines of calls, tries, and their errors."""

from __future__ import annotations

import random
import re
import time
from collections.abc import Generator
from types import SimpleNamespace
from typing import Any

import grpc
from google.protobuf.descriptor import ServiceDescriptor
from google.protobuf.message_factory import GetMessageClass
from grpc_health.v1 import health_pb2

from posespace.errors import Error, ResourceExhausted, Unavailable, error_of_call
from posespace.v1 import pose_service_pb2, session_service_pb2

_OPTIONS: list[tuple[str, int]] = [
    # The service's own values: a dead peer is noticed within 40 s even while nothing is said.
    ("grpc.keepalive_time_ms", 30_000),
    ("grpc.keepalive_timeout_ms", 10_000),
    ("grpc.keepalive_permit_without_calls", 1),
    ("grpc.http2.max_pings_without_data", 0),
    # A service that comes back is found again at once.
    ("grpc.initial_reconnect_backoff_ms", 100),
    ("grpc.min_reconnect_backoff_ms", 1_000),
    ("grpc.max_reconnect_backoff_ms", 2_000),
    # Answers are as large as the pictures and batches that were asked for.
    ("grpc.max_receive_message_length", -1),
    ("grpc.max_send_message_length", -1),
    # A channel of one's own, so that closing it leaves others alone; and never by way of a proxy
    # that the environment names for the web.
    ("grpc.use_local_subchannel_pool", 1),
    ("grpc.enable_http_proxy", 0),
]

_TOO_LARGE = re.compile(r"[Rr]eceived message larger than max \(\d+ vs\.? (\d+)\)")


def _service(module: Any, name: str) -> ServiceDescriptor:
    service: ServiceDescriptor = module.DESCRIPTOR.services_by_name[name]
    return service


def _calls(channel: grpc.Channel, service: ServiceDescriptor) -> SimpleNamespace:
    """The calls of a service, by name."""
    calls = SimpleNamespace()
    for method in service.methods:
        streams = method.client_streaming, method.server_streaming
        make: Any = {
            (False, False): channel.unary_unary,
            (False, True): channel.unary_stream,
            (True, False): channel.stream_unary,
            (True, True): channel.stream_stream,
        }[streams]
        call = make(
            f"/{service.full_name}/{method.name}",
            request_serializer=GetMessageClass(method.input_type).SerializeToString,
            response_deserializer=GetMessageClass(method.output_type).FromString,
        )
        setattr(calls, method.name, call)
    return calls


def _pause_before_another_try(refusal: Error, give_up: float) -> bool:
    """Waits as long as the refusal asks for; False when it asks for none or there is no time."""
    if not isinstance(refusal, ResourceExhausted | Unavailable) or refusal.retry_after is None:
        return False
    # Callers that were refused together must not come back together.
    pause = refusal.retry_after * random.uniform(1.0, 2.0)
    if time.monotonic() + pause >= give_up:
        return False
    time.sleep(pause)
    return True


class Channel:
    """One connection, for any number of threads.

    sessions, poses, health
                     The calls of the services, to be made through `call` and `stream`.
    timeout          Seconds that a call may take unless it says otherwise.

    What the service refuses for now, with a time after which to try again (a full queue, say), is
    tried again until the call's timeout would pass; then the last refusal is raised.
    """

    def __init__(self, address: str, timeout: float) -> None:
        self.address = address
        self.timeout = timeout
        self.grpc = grpc.insecure_channel(address, options=_OPTIONS)
        self.sessions = _calls(self.grpc, _service(session_service_pb2, "SessionService"))
        self.poses = _calls(self.grpc, _service(pose_service_pb2, "PoseService"))
        self.health = _calls(self.grpc, _service(health_pb2, "Health"))

    def close(self) -> None:
        self.grpc.close()

    def begin(self, method: Any, request: Any, timeout: float | None = None) -> Any:
        """What a call returns, before it is known how it ends."""
        try:
            return method(request, timeout=timeout)
        except ValueError as error:  # the transport's way to say that the channel is closed
            raise Unavailable(f"the client of {self.address} cannot call: {error}") from None

    def call(
        self,
        method: Any,
        request: Any,
        *,
        timeout: float | None = None,
        patience: float | None = None,
    ) -> Any:
        """The answer of a call, or posespace.Error.

        timeout   Seconds that it may take; the channel's own by default.
        patience  Seconds in which a refused call may be tried again, each time with the whole
                  timeout; by default all tries share the timeout.
        """
        limit = self.timeout if timeout is None else timeout
        give_up = time.monotonic() + (limit if patience is None else patience)
        while True:
            try:
                shared = max(0.0, give_up - time.monotonic())
                return self.begin(method, request, shared if patience is None else limit)
            except grpc.RpcError as error:
                refusal = self.error_of(error, limit, request)
            if not _pause_before_another_try(refusal, give_up):
                raise refusal

    def stream(
        self, method: Any, request: Any, timeout: float | None
    ) -> Generator[Any, None, None]:
        """The answers of a call one by one, or posespace.Error; ended early, it is cancelled.

        Only a stream that has not begun is tried again.
        """
        give_up = time.monotonic() + (self.timeout if timeout is None else timeout)
        while True:
            begun = False
            remaining = None if timeout is None else max(0.0, give_up - time.monotonic())
            answers = self.begin(method, request, remaining)
            try:
                for answer in answers:
                    begun = True
                    yield answer
                return
            except grpc.RpcError as error:
                refusal = self.error_of(error, timeout, request)
            finally:
                answers.cancel()
            if begun or not _pause_before_another_try(refusal, give_up):
                raise refusal

    def error_of(
        self, error: grpc.RpcError, timeout: float | None = None, request: Any = None
    ) -> Error:
        """A failed call as an error that says what to do about it."""
        told = error_of_call(error, self.address, timeout)
        limit = _TOO_LARGE.search(str(told)) if isinstance(told, ResourceExhausted) else None
        if limit is None or request is None:
            return told
        mebibytes = 2**20
        return ResourceExhausted(
            f"the request has {request.ByteSize() / mebibytes:.1f} MiB; the service takes at most "
            f"{int(limit[1]) / mebibytes:g} MiB at once",
            reason="REQUEST_TOO_LARGE",
        )
