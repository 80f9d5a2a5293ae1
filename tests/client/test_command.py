# SPDX-License-Identifier: Apache-2.0
"""The command `posespace`: what holds for all of its commands."""

from __future__ import annotations

import json
import os
import pty
import signal
import subprocess
import time
from importlib.metadata import version
from pathlib import Path

import pytest
from command_line import COMMAND, answer, refusal, run, walk_files
from synthetic_drawings import wavy_blob

NOBODY = "127.0.0.1:1"
COMMANDS = [
    ["build"],
    ["suggest"],
    ["blend"],
    ["render"],
    ["animate"],
    ["inspect"],
    ["sessions"],
    ["sessions", "ls"],
    ["sessions", "show"],
    ["sessions", "rm"],
    ["ping"],
]


def test_version():
    done = run("--version")
    assert (done.returncode, done.stdout) == (0, f"posespace {version('posespace')}\n")


@pytest.mark.parametrize(
    "command", [[], *COMMANDS], ids=lambda words: " ".join(words) or "posespace"
)
def test_help_shows_an_example_and_fits_a_terminal(command):
    done = run(*command, "--help", COLUMNS="80")
    assert done.returncode == 0
    assert f"  posespace {' '.join(command)}".rstrip() in done.stdout.partition("example")[2]
    assert max(map(len, done.stdout.splitlines())) <= 80


def test_ping_says_that_the_service_answers(server):
    for arguments in (["--server", server.address, "ping"], ["ping", "--server", server.address]):
        done = run(*arguments)
        assert done.returncode == 0, done.stderr
        assert server.address in done.stdout


def test_ping_in_json(server):
    said = answer("ping", "--server", server.address)
    assert said["server"] == server.address and said["milliseconds"] > 0


def test_without_a_server_a_command_runs_one_of_its_own():
    assert answer("--store", "memory", "ping")["server"] is None


def test_an_unreachable_service_is_status_3():
    assert NOBODY in refusal(3, "ping", "--server", NOBODY)
    assert NOBODY in refusal(3, "blend", "tux", "--at", "0,0", "--server", NOBODY)


def test_no_program_to_run_is_status_3():
    said = refusal(3, "--store", "memory", "ping", POSESPACED="/nowhere/posespaced")
    assert "/nowhere/posespaced" in said


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ([], "COMMAND"),
        (["dance"], "dance"),
        (["ping", "--loud"], "--loud"),
        (["--server", NOBODY, "--store", "memory", "ping"], "either --server or --store"),
        (["--server", "", "ping"], "HOST:PORT"),
        (["blend", "tux"], "--at --weights"),
        (["blend", "tux", "--at", "here"], "'here' is not X,Y"),
        (["blend", "tux", "--at", "1"], "'1' is not X,Y"),
        (["blend", "tux", "--at", "1,2,3"], "'1,2,3' is not X,Y"),
        (["blend", "tux", "--at", "0,0", "--weights", "a=1"], "not allowed with"),
        (["blend", "tux", "--weights", "stand"], "'stand' is not ID=WEIGHT"),
        (["blend", "tux", "--weights", "a=1,a=0"], "weighs 'a' twice"),
        (["render", "tux", "--at", "0,0", "--size", "big", "-o", "x.png"], "'big' is not WIDTH"),
        (["render", "tux", "--at", "0,0"], "-o"),
        (["animate", "tux", "-o", "x.gif"], "--path --path-file"),
        (["animate", "tux", "--path", "", "-o", "x.gif"], "'' is not points"),
        (["animate", "tux", "--path", "0,0 1", "-o", "x.gif"], "'1' is not points"),
        (["animate", "tux", "--path", "0,0", "--easing", "odd", "-o", "x.gif"], "odd"),
        (["build", "--out", "x"], "DRAWING"),
        (["build", "a.png"], "--out"),
        (["build", "a.png", "--place", "a", "--out", "x"], "'a' is not ID=X,Y"),
        (["build", "a.png", "--threshold", "high", "--out", "x"], "high"),
        (["sessions"], "COMMAND"),
        (["sessions", "rm"], "SESSION"),
    ],
)
def test_wrong_usage_is_status_2(arguments, says):
    said = refusal(2, *arguments)
    assert "usage: posespace" in said and says in said


@pytest.mark.parametrize(
    "arguments",
    [
        ["blend", "nobody", "--at", "0,0"],
        ["render", "nobody", "--at", "0,0", "-o", "x.png"],
        ["animate", "nobody", "--path", "0,0", "-o", "x.png"],
        ["inspect", "nobody"],
        ["sessions", "show", "nobody"],
        ["sessions", "rm", "nobody"],
    ],
    ids=lambda arguments: arguments[0],
)
def test_an_unknown_session_is_refused_by_name(server, arguments):
    assert "nobody" in refusal(1, "--server", server.address, *arguments)


def test_a_refusal_in_json_has_its_reason(server):
    done = run("--json", "--server", server.address, "inspect", "nobody")
    assert done.returncode == 1
    error = json.loads(done.stdout)["error"]
    assert error["reason"] == "SESSION_NOT_FOUND"
    assert done.stderr == f"posespace: {error['message']}\n"


def test_a_session_that_is_not_built_is_refused(server, session):
    said = refusal(1, "--server", server.address, "blend", session.id, "--at", "0,0")
    assert session.id in said


def test_a_reader_that_has_enough_is_no_matter(server, walk):
    done = subprocess.run(
        f"'{COMMAND}' --server {server.address} blend {walk.id} --at 0,0 | head -c 20",
        shell=True,
        capture_output=True,
        text=True,
    )
    assert len(done.stdout) == 20 and done.stderr == ""


def test_names_that_a_terminal_cannot_show_are_no_matter(server, client, walk, tmp_path):
    named = client.create_session("named", display_name="Füße 🦶")
    out = os.fsencode(tmp_path) + b"/caf\xe9.png"
    command = [COMMAND, "--server", server.address]
    for arguments in (["inspect", "named"], ["render", walk.id, "--at", "0,0", "-o", out]):
        done = subprocess.run(
            [*command, *arguments], capture_output=True, env={"PYTHONIOENCODING": "ascii"}
        )
        assert (done.returncode, done.stderr) == (0, b""), done.stderr
    assert os.path.exists(out)
    named.delete()


def test_an_answer_that_cannot_be_written_is_refused(server):
    for arguments in ("ping", "--json ping", "--json inspect nobody"):
        done = subprocess.run(
            f"'{COMMAND}' --server {server.address} {arguments} > /dev/full",
            shell=True,
            capture_output=True,
            text=True,
        )
        assert done.returncode == 1
        assert done.stderr.startswith("posespace: ") and done.stderr.count("\n") == 1


@pytest.mark.parametrize("loaded", ["_multiarray_umath", "cygrpc", "_imaging"])
def test_an_interrupt_while_it_is_loaded_ends_it_without_a_word(loaded):
    ping = subprocess.Popen(
        [COMMAND, "--store", "memory", "ping"], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    while ping.poll() is None and loaded not in Path(f"/proc/{ping.pid}/maps").read_text():
        time.sleep(0.001)
    ping.send_signal(signal.SIGINT)
    _, said = ping.communicate(timeout=20)
    assert b"Traceback" not in said
    assert ping.returncode in (-signal.SIGINT, 130)


def test_an_interrupt_for_the_whole_group_is_for_the_command(tmp_path):
    """As a terminal sends it: the service of its own ends only when the command ends it."""
    arguments = ["build", *slow_drawings(tmp_path), *SLOW, "--out", tmp_path / "out"]
    build = subprocess.Popen(
        [COMMAND, "--store", "memory", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    ours = wait_for_service(build.pid)
    os.killpg(build.pid, signal.SIGINT)
    _, said = build.communicate(timeout=20)
    assert (build.returncode, said) == (130, "posespace: interrupted\n")
    assert not os.path.exists(f"/proc/{ours}")


def wait_for_service(parent):
    """The posespaced that a process runs, once it builds."""
    deadline = time.monotonic() + 20
    while time.monotonic() < deadline:
        children = Path(f"/proc/{parent}/task/{parent}/children").read_text().split()
        if children and cpu_seconds(children[0]) > 0.2:
            return children[0]
        time.sleep(0.02)
    pytest.fail("no service began to build")


def cpu_seconds(pid):
    """What a process has computed so far."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def slow_drawings(folder):
    """Drawings whose build to SLOW takes some seconds."""
    files = [folder / f"blob{k}.json" for k in range(6)]
    for k, file in enumerate(files):
        ring = wavy_blob(9 + k, 0.12, rows=900)
        file.write_text(json.dumps({"outer": ring.tolist()}))
    return files


SLOW = ["--tolerance", "0.001", "--target-edge-length", "0.02"]


def until_build_is(client, session_id, wanted):
    """Waits for a state of the session's build."""
    deadline = time.monotonic() + 20
    state = "not there"
    while state != wanted:
        assert time.monotonic() < deadline, f"the build is {state}"
        time.sleep(0.01)
        for session in client.session_states():
            if session.id == session_id and session.build is not None:
                state = session.build.state


@pytest.mark.parametrize(("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_ctrl_c_cancels_the_build_and_leaves_nothing(server, client, tmp_path, number, status):
    files = slow_drawings(tmp_path)
    out, name = tmp_path / "out", f"interrupted-{status}"
    arguments = ["build", *files, *SLOW, "--session", name, "--out", out]
    build = subprocess.Popen(
        [COMMAND, "--server", server.address, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    until_build_is(client, name, "running")
    build.send_signal(number)
    _, said = build.communicate(timeout=20)
    assert build.returncode == status, said
    assert "Traceback" not in said
    until_build_is(client, name, "cancelled")
    assert list(out.iterdir()) == []
    client.session(name).delete()


def test_a_bar_is_shown_on_terminals_only(server, client, tmp_path):
    arguments = ["--server", server.address, "build", *walk_files(tmp_path), "--out", tmp_path]
    silent = run(*arguments, "--session", "seen-by-nobody")
    assert silent.stderr == ""

    ours, theirs = pty.openpty()
    with subprocess.Popen(
        [COMMAND, *arguments, "--session", "seen"], stdout=subprocess.PIPE, stderr=theirs
    ) as build:
        os.close(theirs)
        shown = b""
        while chunk := _read(ours):
            shown += chunk
        assert build.wait() == 0
    os.close(ours)
    assert b"[" in shown and b"%" in shown and b"matching" in shown
    assert shown.endswith(b"\r\x1b[K"), "the bar is gone at the end"
    for name in ("seen", "seen-by-nobody"):
        client.session(name).delete()


def _read(terminal: int) -> bytes:
    try:
        return os.read(terminal, 4096)
    except OSError:  # the other side is closed
        return b""
