# SPDX-License-Identifier: Apache-2.0
"""The command `posespace`, as a shell runs it."""

from __future__ import annotations

import json
import subprocess
import sysconfig
from importlib.metadata import version
from pathlib import Path

COMMAND = Path(sysconfig.get_path("scripts")) / "posespace"
NOBODY = "127.0.0.1:1"


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([COMMAND, *arguments], capture_output=True, text=True)


def test_version():
    done = run("--version")
    assert (done.returncode, done.stdout) == (0, f"posespace {version('posespace')}\n")


def test_ping_says_that_the_service_answers(server):
    for arguments in (["--server", server.address, "ping"], ["ping", "--server", server.address]):
        done = run(*arguments)
        assert done.returncode == 0, done.stderr
        assert server.address in done.stdout


def test_ping_in_json(server):
    done = run("--json", "ping", "--server", server.address)
    answer = json.loads(done.stdout)
    assert answer["server"] == server.address and answer["milliseconds"] > 0


def test_an_unreachable_service_is_status_3():
    done = run("ping", "--server", NOBODY)
    assert done.returncode == 3
    assert NOBODY in done.stderr and not done.stdout
    assert "Traceback" not in done.stderr


def test_wrong_usage_is_status_2():
    for arguments in ([], ["dance"], ["ping", "--loud"]):
        done = run(*arguments)
        assert done.returncode == 2
        assert "usage: posespace" in done.stderr
