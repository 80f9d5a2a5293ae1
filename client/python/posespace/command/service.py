# SPDX-License-Identifier: Apache-2.0
"""The service that a command talks to: a running one, or one of its own on a store."""

from __future__ import annotations

import contextlib
import fcntl
import os
import sys
import time
from collections.abc import Iterator
from pathlib import Path

from posespace.client import Client, connect
from posespace.errors import Conflict
from posespace.local import serve_locally

_TIMEOUT = 30.0  # seconds a call may take: large pictures on a busy machine
_PATIENCE = 60.0  # seconds that a store in use is waited for
_NOTICE_AFTER = 1.0  # seconds of waiting without a word


def default_store() -> str:
    """posespaced.sqlite in posespace's folder of the user's data."""
    named = os.environ.get("XDG_DATA_HOME", "")
    home = Path(named) if os.path.isabs(named) else Path.home() / ".local" / "share"
    return f"sqlite:{home / 'posespace' / 'posespaced.sqlite'}"


@contextlib.contextmanager
def service(server: str | None, store: str | None) -> Iterator[Client]:
    """A client of the service at `server`, or of one that runs only meanwhile and keeps sessions in
    `store`: memory, sqlite:PATH or PATH; by default default_store().

    One command at a time uses a store; others wait for their turn.

    Raises FileNotFoundError when there is no posespaced to run, Unavailable, Conflict when the
    store stays in use, OSError.
    """
    if server is not None:
        with connect(server, timeout=_TIMEOUT) as client:
            yield client
        return
    with contextlib.ExitStack() as held:
        url = store or default_store()
        if url != "memory":
            path = Path(url.removeprefix("sqlite:")).expanduser().absolute()
            url = f"sqlite:{path}"
            path.parent.mkdir(parents=True, exist_ok=True)
            held.enter_context(_used_alone(path))
        local = held.enter_context(serve_locally(store=url))
        yield held.enter_context(connect(local.address, timeout=_TIMEOUT))


@contextlib.contextmanager
def _used_alone(store: Path) -> Iterator[None]:
    """Holds the lock of a store, which ends with the process however that ends."""
    start = time.monotonic()
    noticed = False
    with open(store.with_name(store.name + ".lock"), "a+") as lock:
        while True:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except BlockingIOError:
                waited = time.monotonic() - start
            lock.seek(0)
            user = lock.read().strip() or "another command"
            if waited > _PATIENCE:
                raise Conflict(
                    f"the store {store} is in use by {user}; try again when it has ended, or let "
                    f"both talk to one posespaced with --server"
                ) from None
            if waited > _NOTICE_AFTER and not noticed:
                noticed = True
                print(f"posespace: waiting for {user} to leave {store}", file=sys.stderr)
            time.sleep(0.05)
        lock.truncate(0)
        lock.write(f"process {os.getpid()}")
        lock.flush()
        yield
