# SPDX-License-Identifier: Apache-2.0
"""The command without a server: a service meanwhile, whose store keeps sessions between calls."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import time

import posespace
import pytest
from command_line import COMMAND, answer, refusal, run, walk_files
from PIL import Image
from posespace.local import _find


def test_sessions_are_kept_between_calls_where_the_user_keeps_data(tmp_path):
    data = {"XDG_DATA_HOME": str(tmp_path / "data")}
    arguments = ["build", *walk_files(tmp_path), "--session", "walk", "--out", tmp_path / "out"]
    built = answer(*arguments, **data)
    assert (tmp_path / "data" / "posespace" / "posespaced.sqlite").is_file()
    (kept,) = answer("sessions", "ls", **data)["sessions"]
    assert (kept["session"], kept["revision"]) == ("walk", built["revision"])
    assert answer("blend", "walk", "--at", "0.5,0.5", **data)["revision"] == built["revision"]
    assert answer(*arguments, **data)["rebuilt"] is False
    answer("sessions", "rm", "walk", **data)
    assert answer("sessions", "ls", **data) == {"sessions": []}


def test_without_a_folder_for_data_it_is_the_usual_one(tmp_path):
    home = {"HOME": str(tmp_path), "XDG_DATA_HOME": ""}
    answer("sessions", "ls", **home)
    assert (tmp_path / ".local" / "share" / "posespace" / "posespaced.sqlite").is_file()


def test_a_store_is_named_by_its_path_either_way(tmp_path):
    drawing = walk_files(tmp_path)[0]
    store = tmp_path / "deep" / "my.db"
    arguments = ["build", drawing, "--session", "one", "--out", tmp_path / "out"]
    answer("--store", store, *arguments)
    assert len(answer("--store", f"sqlite:{store}", "sessions", "ls")["sessions"]) == 1
    assert len(answer("sessions", "ls", "--store", store)["sessions"]) == 1


def test_a_service_keeps_what_a_command_built(tmp_path):
    store = tmp_path / "store.db"
    arguments = ["build", *walk_files(tmp_path), "--session", "walk", "--out", tmp_path / "out"]
    built = answer("--store", store, *arguments)
    with (
        posespace.serve_locally(store=f"sqlite:{store}") as server,
        posespace.connect(server.address) as client,
    ):
        assert client.session("walk").blend(at=(0, 0)).revision == built["revision"]


def test_a_command_that_is_killed_leaves_a_store_that_the_next_one_uses(tmp_path):
    store = tmp_path / "store.db"
    files = walk_files(tmp_path)
    answer("--store", store, "build", *files[:2], "--session", "walk", "--out", tmp_path / "out")
    build = subprocess.Popen(
        [COMMAND, "--store", store, "build", *files, "--session", "walk", "--out", tmp_path / "out"]
    )
    time.sleep(0.3)
    build.send_signal(signal.SIGKILL)
    build.wait()
    assert answer("--store", store, "blend", "walk", "--at", "0,0")["folds"] == 0


def test_two_commands_at_once_take_turns(tmp_path):
    store, files = tmp_path / "store.db", walk_files(tmp_path)
    builds = [
        subprocess.Popen(
            [COMMAND, "--store", store, "build", file, "--session", file.stem, "--out", tmp_path],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        for file in files
    ]
    for build in builds:
        _, said = build.communicate(timeout=60)
        assert build.returncode == 0, said
        assert "Traceback" not in said
    kept = answer("--store", store, "sessions", "ls")["sessions"]
    assert [session["session"] for session in kept] == ["stand", "step", "wave"]


def test_a_store_that_a_service_has_open_is_refused_with_the_reason(tmp_path):
    store = tmp_path / "store.db"
    with posespace.serve_locally(store=f"sqlite:{store}"):
        said = refusal(3, "--store", store, "sessions", "ls")
    assert str(store) in said and "another process" in said


def test_a_store_that_cannot_be_is_refused(tmp_path):
    (tmp_path / "text").write_text("this is no database, and it is long enough to tell" * 100)
    (tmp_path / "folder").mkdir()
    for store in (tmp_path / "text", tmp_path / "folder", tmp_path / "text" / "below"):
        done = run("--store", store, "sessions", "ls")
        assert done.returncode in (1, 3) and str(tmp_path) in done.stderr
    assert (tmp_path / "text").read_text().startswith("this is no database")


@pytest.fixture
def shell(tmp_path):
    """Runs lines as a user's shell does, in a folder with the drawings they name."""
    _, jump, _ = walk_files(tmp_path)
    jump.rename(tmp_path / "jump.png")
    environment = {
        **os.environ,
        "PATH": f"{COMMAND.parent}:{os.environ['PATH']}",
        "POSESPACED": str(_find(None)),
        "XDG_DATA_HOME": str(tmp_path / "data"),
    }

    def run_lines(lines):
        return subprocess.run(
            ["sh", "-e", "-c", lines],
            cwd=tmp_path,
            env=environment,
            capture_output=True,
            text=True,
            timeout=120,
        )

    return run_lines


def test_the_examples_of_the_help_do_what_they_say(shell, tmp_path):
    helped = run("--help").stdout.partition("examples:")[2]
    lines = re.findall(r"^  (posespace .*)$", helped, re.MULTILINE)
    assert len(lines) == 2
    done = shell("\n".join(lines))
    assert done.returncode == 0 and done.stderr == "", done.stderr
    assert {path.name for path in (tmp_path / "tux").iterdir()} == {
        "mesh.json",
        "report.json",
        "contact-sheet.png",
    }
    with Image.open(tmp_path / "tux.gif") as animation:
        assert animation.n_frames == 90 and animation.info["loop"] == 0
