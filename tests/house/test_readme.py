# SPDX-License-Identifier: Apache-2.0
"""Every command and every call that README shows does what it says."""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text()
BIN = ROOT / "build/bin"
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```$", README, re.MULTILINE | re.DOTALL)


def blocks(language: str) -> list[str]:
    return [text for kind, text in BLOCKS if kind == language]


@pytest.fixture
def folder(tmp_path):
    """A folder with the drawings that the calls name, made of our own."""
    for name, pose in (("stand", "stand"), ("jump", "jump"), ("wave", "wave")):
        drawing = ROOT / f"deploy/drawings/figure-{pose}.svg"
        subprocess.run(
            ["rsvg-convert", "-w", "200", drawing, "-o", tmp_path / f"{name}.png"], check=True
        )
    return tmp_path


@pytest.fixture
def environment(folder):
    """Where the programs are found and sessions are kept."""
    paths = [str(BIN), str(Path(sys.executable).parent), os.environ["PATH"]]
    return {**os.environ, "PATH": os.pathsep.join(paths), "XDG_DATA_HOME": str(folder / "data")}


def run(command, folder, environment) -> str:
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, f"{command}: {done.stdout}{done.stderr}"
    return done.stdout


def test_the_two_commands_are_what_checks_run():
    two = [line.split()[0] for line in blocks("sh")[0].splitlines()]
    assert two == ["deploy/demo", "tests/run"]  # tests/house/test_demo.py runs the first
    assert all(os.access(ROOT / command, os.X_OK) for command in two)
    assert "tests/run" in (ROOT / ".ci/run").read_text().splitlines()


def test_the_path_leads_to_both_programs():
    script = blocks("sh")[1] + "command -v posespaced posespace"
    done = subprocess.run(["bash", "-c", script], cwd=ROOT, capture_output=True, text=True)
    found = [Path(line) for line in done.stdout.split()]
    assert found == [BIN / "posespaced", ROOT / "build/venv/bin/posespace"]


def test_the_shell_commands_leave_what_they_name(folder, environment):
    commands = blocks("sh")[2].splitlines()
    assert len(commands) == 2
    for command in commands:
        run(shlex.split(command), folder, environment)
    mesh = json.loads((folder / "tux/mesh.json").read_text())
    assert [shape["id"] for shape in mesh["shapes"]] == ["stand", "jump", "wave"]
    assert (folder / "tux.gif").read_bytes().startswith(b"GIF89a")


def test_the_python_call_runs(folder, environment):
    (call,) = blocks("python")
    script = call + "    print(frame.vertices.shape, pixels.shape)\n"
    assert "(512, 512, 4)" in run([sys.executable, "-c", script], folder, environment)


def test_the_cpp_call_is_the_examples():
    (call,) = blocks("cpp")  # tests/client_cpp/test_installed.py builds and runs it
    assert call in (ROOT / "client/cpp/examples/quickstart.cpp").read_text()


def test_the_service_listens_where_it_is_told(folder, environment):
    program, *arguments = shlex.split(blocks("sh")[3])
    assert (ROOT / program).samefile(shutil.which("posespaced", path=environment["PATH"]))
    address = arguments[arguments.index("--listen") + 1]
    free = address.rsplit(":", 1)[0] + ":0"  # the port of the page may be taken
    arguments[arguments.index(address)] = free
    service = subprocess.Popen(
        [ROOT / program, *arguments], cwd=folder, env=environment, stdout=subprocess.PIPE, text=True
    )
    try:
        assert service.stdout is not None
        ready = service.stdout.readline()
        assert ready.startswith("posespace ready grpc=")
    finally:
        service.terminate()
        service.wait(timeout=30)


def test_every_folder_of_the_tree_has_its_line():
    tracked = subprocess.run(
        ["git", "ls-files", "-co", "--exclude-standard"],
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
    ).stdout.split()
    top = {name.split("/")[0] for name in tracked if "/" in name and not name.startswith(".")}
    rooms = {
        "/".join(name.split("/")[:2]) for name in tracked if name.startswith(("server/", "client/"))
    }
    rooms = {room for room in rooms if (ROOT / room).is_dir()}
    for folder in (top - {"server", "client"}) | rooms:
        assert f"`{folder}/`" in README, f"README does not say what {folder}/ is"
