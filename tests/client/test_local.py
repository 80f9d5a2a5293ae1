# SPDX-License-Identifier: Apache-2.0
"""Starting and ending a service of one's own."""

from __future__ import annotations

import os
import shutil
import signal
import stat
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import posespace
import pytest
from posespace.local import _find


def is_running(pid: int) -> bool:
    try:
        return "Z" not in Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except FileNotFoundError:
        return False


def wait_until(condition: Callable[[], bool]) -> None:
    deadline = time.monotonic() + 20
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.05)


def wait_until_ended(pid: int) -> None:
    wait_until(lambda: not is_running(pid))


def script(path: Path, text: str) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return path


def test_the_service_ends_with_its_block_and_leaves_no_log():
    with posespace.serve_locally() as server, posespace.connect(server.address) as client:
        client.ping()
        assert is_running(server.pid)
        wait_until(lambda: "event=ready" in server.log)
    assert not is_running(server.pid)
    assert server.log == ""
    server.stop()


def test_the_service_ends_with_its_block_when_that_fails():
    with pytest.raises(ZeroDivisionError), posespace.serve_locally() as server:
        raise ZeroDivisionError
    assert not is_running(server.pid)


def test_two_services_have_two_addresses():
    with posespace.serve_locally() as one, posespace.serve_locally() as two:
        assert one.address != two.address


@pytest.mark.skipif(not shutil.which("setpriv"), reason="needs setpriv to watch the parent")
def test_the_service_dies_with_a_killed_parent():
    parent = subprocess.Popen(
        [
            sys.executable,
            "-c",
            "import posespace, time; server = posespace.serve_locally();"
            "print(server.pid, flush=True); time.sleep(60)",
        ],
        stdout=subprocess.PIPE,
        text=True,
    )
    assert parent.stdout is not None
    pid = int(parent.stdout.readline())
    assert is_running(pid)
    parent.send_signal(signal.SIGKILL)
    parent.wait()
    wait_until_ended(pid)


def test_a_program_that_ends_without_a_block_stops_its_service():
    done = subprocess.run(
        [sys.executable, "-c", "import posespace; print(posespace.serve_locally().pid)"],
        capture_output=True,
        text=True,
        check=True,
    )
    wait_until_ended(int(done.stdout))


def test_a_service_that_does_not_start_shows_its_log():
    with pytest.raises(posespace.Unavailable, match=r"(?s)status 2.*store.*nonsense"):
        posespace.serve_locally(store="nonsense")


def test_a_program_that_never_gets_ready_is_given_up(tmp_path):
    idle = script(tmp_path / "idle", "echo waiting for nothing >&2; exec sleep 60")
    with pytest.raises(posespace.Unavailable, match=r"(?s)in time.*waiting for nothing"):
        posespace.serve_locally(binary=idle, startup_timeout=0.5)


def test_a_service_that_does_not_end_when_asked_is_killed(tmp_path):
    stubborn = script(
        tmp_path / "stubborn",
        "trap '' TERM; echo posespace ready grpc=127.0.0.1:1; while :; do sleep 1; done",
    )
    server = posespace.serve_locally(binary=stubborn, stop_timeout=0.5)
    assert server.address == "127.0.0.1:1"
    server.stop()
    assert not is_running(server.pid)


def test_the_program_is_found_by_argument_environment_path_and_folder(tmp_path, monkeypatch):
    by_folder = script(tmp_path / "tree/build/bin/posespaced", ":")
    by_path = script(tmp_path / "path/posespaced", ":")
    by_environment = script(tmp_path / "environment/posespaced", ":")
    by_argument = script(tmp_path / "argument/any-name", ":")
    (tmp_path / "tree/deep/er").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "tree/deep/er")
    monkeypatch.delenv("POSESPACED", raising=False)
    monkeypatch.setenv("PATH", os.defpath)

    assert _find(None) == by_folder
    monkeypatch.setenv("PATH", str(by_path.parent))
    assert _find(None) == by_path
    monkeypatch.setenv("POSESPACED", str(by_environment))
    assert _find(None) == by_environment
    assert _find(by_argument) == by_argument


def test_no_program_says_where_it_was_looked_for(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("POSESPACED", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(FileNotFoundError, match=r"POSESPACED.*build/bin/posespaced"):
        posespace.serve_locally()
    with pytest.raises(FileNotFoundError, match="nowhere"):
        posespace.serve_locally(binary="nowhere")
    monkeypatch.setenv("POSESPACED", "/nowhere/posespaced")
    with pytest.raises(FileNotFoundError, match="POSESPACED=/nowhere"):
        posespace.serve_locally()
