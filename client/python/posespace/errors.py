# SPDX-License-Identifier: Apache-2.0
"""What a call can be refused with.

try:
    session.put_shape("jump", image="jump.png")
except posespace.InvalidDrawing as error:
    print(error)            # names the drawing, the point and the limit
    print(error.reason)     # "OUTLINE_EMPTY"; stable, for programs
    print(error.fields)     # {"image.data": "..."}: the fields at fault, if any

What a moment's wait may mend (a full queue, say) has been tried again until the timeout before it
is raised.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import cast

import grpc
from google.rpc import error_details_pb2  # type: ignore[import-untyped]
from grpc_status import rpc_status


class Error(Exception):
    """Base of everything the service, or the way to it, refuses.

    reason       Stable name of the cause, such as "SESSION_NOT_FOUND"; empty when the cause lies
                 outside the service.
    fields       Path of each field at fault -> what is wrong with it.
    retry_after  Seconds after which another try may succeed; None when trying again is no use.
    """

    def __init__(
        self,
        message: str,
        *,
        reason: str = "",
        fields: Mapping[str, str] | None = None,
        retry_after: float | None = None,
    ) -> None:
        super().__init__(message)
        self.reason = reason
        self.fields = dict(fields or {})
        self.retry_after = retry_after


class InvalidArgument(Error):
    """An argument makes no sense; the message names it and the limit it breaks."""


class InvalidDrawing(InvalidArgument):
    """A picture or polygon that no outline can be made of."""


class NotFound(Error):
    """No such session, drawing, revision or build."""


class AlreadyExists(Error):
    """The id is taken, with other content."""


class NotBuilt(Error):
    """The session has to be built first; with reason NO_SHAPES it first needs a drawing."""


class Conflict(Error):
    """Somebody else changed the session since the etag was read."""


class ResourceExhausted(Error):
    """A limit or a queue of the service is full, or a request is too large."""


class Unavailable(Error):
    """The service cannot be reached, has ended, or is about to."""


class DeadlineExceeded(Error):
    """No answer within the timeout."""


class Cancelled(Error):
    """The call or the build was cancelled."""


class Unauthenticated(Error):
    """The service does not know who is calling."""


class PermissionDenied(Error):
    """The caller may not do this."""


class InternalError(Error):
    """A bug in the service."""


_BY_CODE: dict[grpc.StatusCode, type[Error]] = {
    grpc.StatusCode.INVALID_ARGUMENT: InvalidArgument,
    grpc.StatusCode.OUT_OF_RANGE: InvalidArgument,
    grpc.StatusCode.NOT_FOUND: NotFound,
    grpc.StatusCode.ALREADY_EXISTS: AlreadyExists,
    grpc.StatusCode.FAILED_PRECONDITION: NotBuilt,
    grpc.StatusCode.ABORTED: Conflict,
    grpc.StatusCode.RESOURCE_EXHAUSTED: ResourceExhausted,
    grpc.StatusCode.UNAVAILABLE: Unavailable,
    grpc.StatusCode.DEADLINE_EXCEEDED: DeadlineExceeded,
    grpc.StatusCode.CANCELLED: Cancelled,
    grpc.StatusCode.UNAUTHENTICATED: Unauthenticated,
    grpc.StatusCode.PERMISSION_DENIED: PermissionDenied,
    grpc.StatusCode.INTERNAL: InternalError,
    grpc.StatusCode.DATA_LOSS: InternalError,
}

# Builds and streams carry reasons without a status code.
_BY_REASON: dict[str, type[Error]] = {
    "SESSION_NOT_FOUND": NotFound,
    "SHAPE_NOT_FOUND": NotFound,
    "REVISION_NOT_FOUND": NotFound,
    "BUILD_NOT_FOUND": NotFound,
    "SESSION_EXISTS": AlreadyExists,
    "SHAPE_EXISTS": AlreadyExists,
    "NO_SHAPES": NotBuilt,
    "SESSION_NOT_BUILT": NotBuilt,
    "BUILD_FAILED": NotBuilt,
    "SLOT_NOT_BOUND": NotBuilt,
    "ETAG_MISMATCH": Conflict,
    "SESSION_LIMIT": ResourceExhausted,
    "STREAM_LIMIT": ResourceExhausted,
    "BUILD_QUEUE_FULL": ResourceExhausted,
    "COMPUTE_QUEUE_FULL": ResourceExhausted,
    "DRAINING": Unavailable,
    "STORE_UNAVAILABLE": Unavailable,
    "SNAPSHOT_CORRUPT": InternalError,
    "BUILD_TIMEOUT": DeadlineExceeded,
    "CANCELLED": Cancelled,
    "INTERNAL": InternalError,
}


def _is_of_a_drawing(reason: str) -> bool:
    return reason.startswith(("IMAGE_", "OUTLINE_")) or reason == "SHAPE_SOURCE_MISSING"


def error_of_reason(reason: str, message: str, fields: Mapping[str, str] | None = None) -> Error:
    """The error of a refusal that came inside a message, with no status code."""
    kind = InvalidDrawing if _is_of_a_drawing(reason) else _BY_REASON.get(reason, InvalidArgument)
    return kind(message, reason=reason, fields=fields)


def error_of_call(error: grpc.RpcError, address: str, timeout: float | None) -> Error:
    """The error of a call that failed, with its google.rpc details."""
    code, message = error.code(), error.details() or ""
    reason = ""
    fields: dict[str, str] = {}
    retry_after = None
    status = rpc_status.from_call(cast(grpc.Call, error))
    for detail in status.details if status is not None else ():
        if detail.Is(error_details_pb2.ErrorInfo.DESCRIPTOR):
            info = error_details_pb2.ErrorInfo()
            detail.Unpack(info)
            reason = info.reason
        elif detail.Is(error_details_pb2.BadRequest.DESCRIPTOR):
            bad_request = error_details_pb2.BadRequest()
            detail.Unpack(bad_request)
            for at_fault in bad_request.field_violations:
                said = fields.get(at_fault.field)
                words = f"{said}; {at_fault.description}" if said else at_fault.description
                fields[at_fault.field] = words
        elif detail.Is(error_details_pb2.RetryInfo.DESCRIPTOR):
            retry = error_details_pb2.RetryInfo()
            detail.Unpack(retry)
            retry_after = retry.retry_delay.seconds + retry.retry_delay.nanos * 1e-9

    kind = _BY_CODE.get(code, Error)
    if kind is InvalidArgument and _is_of_a_drawing(reason):
        kind = InvalidDrawing
    if not reason:  # the transport's own words, which do not say where
        if kind is Unavailable:
            message = f"the service at {address} is not there: {message}"
        elif kind is DeadlineExceeded and timeout is not None:
            message = f"no answer from {address} within {timeout:g} s"
        elif kind is Error:
            message = f"{code.name.lower()}: {message}"
    return kind(message, reason=reason, fields=fields, retry_after=retry_after)
