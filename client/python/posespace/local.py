# SPDX-License-Identifier: Apache-2.0
"""A service of one's own, for as long as a `with`."""

from __future__ import annotations

import contextlib
import os
import selectors
import shutil
import subprocess
import tempfile
import threading
import time
import weakref
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType

from posespace.errors import Unavailable

_READY = "posespace ready grpc="
_LOG_TAIL = 2_000  # characters of the log that an error shows


def serve_locally(
    store: str = "memory",
    binary: str | os.PathLike[str] | None = None,
    *,
    flags: Sequence[str] = (),
    startup_timeout: float = 20.0,
    stop_timeout: float = 8.0,
) -> LocalServer:
    """Starts posespaced on a free port of this machine and ends it on exit.

        with posespace.serve_locally() as server, posespace.connect(server.address) as client:
            ...

    store            Where sessions are kept: "memory", or "sqlite:PATH", a file that outlives the
                     service, for one service at a time.
    binary           The program; by default what POSESPACED names, else posespaced on PATH, else
                     build/bin/posespaced in the current directory or one above it.
    flags            More flags of posespaced, such as ["--log-level", "debug"].
    startup_timeout  Seconds in which it has to answer.
    stop_timeout     Seconds in which it has to end when asked, before it is killed.

    Raises FileNotFoundError when there is no program, Unavailable, with the end of its log, when it
    does not start.
    """
    program = _find(binary)
    command = [str(program), "--listen", "127.0.0.1:0", "--store", store, *flags]
    return LocalServer(command, startup_timeout, stop_timeout)


class ProgramNotFound(FileNotFoundError):
    """There is no posespaced to run."""


class LocalServer:
    """A running posespaced; made by `serve_locally`.

    address  What `connect` takes.
    pid      Its process.
    """

    def __init__(self, command: Sequence[str], startup_timeout: float, stop_timeout: float) -> None:
        self._stop_timeout = stop_timeout
        with tempfile.NamedTemporaryFile(prefix="posespaced-", suffix=".log", delete=False) as log:
            self._log_path = Path(log.name)
            self._process = subprocess.Popen(
                [*_ending_with_us(), *command],
                stdout=subprocess.PIPE,
                stderr=log,
                process_group=0,  # Ctrl-C in a terminal is for us, who end it in order
            )
        self._stop_at_exit = weakref.finalize(self, _stop, self._process, 1.0, self._log_path)
        try:
            self.address = self._ready_address(time.monotonic() + startup_timeout)
        except BaseException:
            self.stop()
            raise
        self.pid = self._process.pid

    def __enter__(self) -> LocalServer:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.stop()

    def __repr__(self) -> str:
        return f"<posespace.LocalServer {self.address}, process {self.pid}>"

    @property
    def log(self) -> str:
        """What it has logged so far."""
        with contextlib.suppress(FileNotFoundError):
            return self._log_path.read_text(errors="replace")
        return ""

    def stop(self) -> None:
        """Asks it to end, waits, and kills it where it does not.  Again has no effect."""
        if self._stop_at_exit.detach():
            _stop(self._process, self._stop_timeout, self._log_path)

    def _ready_address(self, give_up: float) -> str:
        """The address in the line that it prints once it answers."""
        assert self._process.stdout is not None
        said = b""
        with selectors.DefaultSelector() as selector:
            selector.register(self._process.stdout, selectors.EVENT_READ)
            while True:
                for line in said.decode(errors="replace").splitlines(keepends=True):
                    if line.startswith(_READY) and line.endswith("\n"):
                        return line.removeprefix(_READY).split()[0]
                if not selector.select(max(0.0, give_up - time.monotonic())):
                    raise Unavailable(f"posespaced did not get ready in time{self._log_tail()}")
                more = os.read(self._process.stdout.fileno(), 4096)
                if not more:
                    status = self._process.wait()
                    raise Unavailable(
                        f"posespaced ended with status {status} before it was ready"
                        f"{self._log_tail()}"
                    )
                said += more

    def _log_tail(self) -> str:
        tail = self.log[-_LOG_TAIL:].strip()
        return f"; its log ends with:\n{tail}" if tail else "; it logged nothing"


def _find(binary: str | os.PathLike[str] | None) -> Path:
    named = binary or os.environ.get("POSESPACED")
    if named:
        if found := shutil.which(named):
            return Path(found)
        source = "binary=" if binary else "POSESPACED="
        raise ProgramNotFound(f"{source}{os.fspath(named)} is not a program")
    if found := shutil.which("posespaced"):
        return Path(found)
    here = Path.cwd()
    for folder in (here, *here.parents):
        candidate = folder / "build" / "bin" / "posespaced"
        if os.access(candidate, os.X_OK) and candidate.is_file():
            return candidate
    raise ProgramNotFound(
        "no posespaced: name it by binary= or POSESPACED, put it on PATH, or build it so that "
        f"build/bin/posespaced is in {here} or above"
    )


def _ending_with_us() -> list[str]:
    """A command that has the program end when this process does, even by SIGKILL.

    The kernel watches the thread that started the program, so only the main thread's word holds
    for the process.
    """
    setpriv = shutil.which("setpriv")
    if setpriv and threading.current_thread() is threading.main_thread():
        return [setpriv, "--pdeathsig", "TERM"]
    return []


def _stop(process: subprocess.Popen[bytes], timeout: float, log: Path) -> None:
    process.terminate()
    try:
        process.wait(timeout)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
    if process.stdout is not None:
        process.stdout.close()
    log.unlink(missing_ok=True)
