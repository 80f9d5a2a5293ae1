# SPDX-License-Identifier: Apache-2.0
"""What `cmake --install` brings is enough for a project elsewhere, and its examples work."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import posespace
import pytest
from PIL import Image, ImageDraw

ROOT = Path(__file__).resolve().parents[2]
BUILT = ROOT / "build/release"


def run(*command: object, cwd: Path | None = None) -> str:
    done = subprocess.run(
        [str(word) for word in command], cwd=cwd, capture_output=True, text=True, timeout=600
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def prefix(tmp_path_factory) -> Path:
    """Where it is installed."""
    folder = tmp_path_factory.mktemp("prefix")
    run("cmake", "--install", BUILT, "--prefix", folder)
    return folder


@pytest.fixture(scope="module")
def examples(prefix, tmp_path_factory) -> Path:
    """The examples, built from a copy that knows nothing of this repository."""
    folder = tmp_path_factory.mktemp("examples")
    shutil.copytree(ROOT / "client/cpp/examples", folder / "source")
    cache = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
    run(
        *("cmake", "-S", folder / "source", "-B", folder / "build", "-G", "Ninja", *cache),
        *(f"-DCMAKE_PREFIX_PATH={prefix}", "-DCMAKE_BUILD_TYPE=Release"),
        "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Wshadow -Werror",
    )
    run("cmake", "--build", folder / "build")
    return folder / "build"


@pytest.fixture(scope="module")
def server(prefix) -> Iterator[posespace.LocalServer]:
    with posespace.serve_locally(binary=prefix / "bin/posespaced") as running:
        yield running


def test_the_avatar_server_answers_every_avatar_of_every_tick(examples, server):
    said = run(examples / "avatar_server", server.address, 500, 60, 2)
    assert re.search(r"^500 avatars at 60 Hz: 120 ticks, \d+ late, 0 refused$", said, re.MULTILINE)
    assert re.search(r"latency p50 [\d.]+ ms, p99 [\d.]+ ms; [1-9][\d.]* kB", said)
    with posespace.connect(server.address) as client:
        assert client.sessions() == [], "it cleans up"


def test_the_avatar_server_says_what_it_cannot_reach(examples):
    done = subprocess.run(
        [examples / "avatar_server", "127.0.0.1:1"], capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 1
    assert "127.0.0.1:1" in done.stderr


def test_the_quickstart_plays_what_lies_between_two_drawings(examples, server, tmp_path):
    for name, top in (("stand", 120), ("jump", 40)):
        image = Image.new("RGBA", (200, 260))
        pen = ImageDraw.Draw(image)
        pen.ellipse((60, top - 30, 140, top + 50), "#222222")
        pen.rectangle((70, top + 20, 130, 250), "#222222")
        image.save(tmp_path / f"{name}.png")
    lines = run(examples / "quickstart", server.address, cwd=tmp_path).splitlines()
    assert re.fullmatch(r"\d+ vertices", lines[0])
    assert [line.split(":")[0] for line in lines[1:]] == ["0", "1", "2"] * 60


def test_a_program_that_has_googleapis_brings_its_own(prefix, tmp_path):
    (tmp_path / "CMakeLists.txt").write_text(
        """
        cmake_minimum_required(VERSION 3.25)
        project(host LANGUAGES CXX)
        add_library(googleapis INTERFACE)
        add_library(posespace::google_rpc ALIAS googleapis)
        find_package(posespace REQUIRED)
        get_target_property(linked posespace::client INTERFACE_LINK_LIBRARIES)
        get_target_property(theirs posespace::google_rpc ALIASED_TARGET)
        message(STATUS "client: ${linked}; google_rpc: ${theirs}")
        """
    )
    said = run("cmake", "-S", tmp_path, "-B", tmp_path / "b", f"-DCMAKE_PREFIX_PATH={prefix}")
    assert re.search(r"client: .*posespace::google_rpc.*; google_rpc: googleapis", said)


def test_the_installed_client_brings_no_header_of_the_wire(prefix):
    headers = {path.name for path in prefix.rglob("*.h")}
    assert "client.h" in headers
    assert not [name for name in headers if "pb" in name or "grpc" in name]


def test_the_installed_service_draws_svg_documents(server):
    with posespace.connect(server.address) as client:
        session = client.create_session()
        shape = session.put_shape("stand", svg=ROOT / "deploy/drawings/figure-stand.svg")
        assert len(shape.outline[0]) > 16
        session.delete()
