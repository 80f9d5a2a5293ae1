# SPDX-License-Identifier: Apache-2.0
"""posespace suggest, and build --flip, which accepts what it proposes."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from command_line import answer, refusal, run
from PIL import Image
from synthetic_drawings import figure, png_of

ROOT = Path(__file__).resolve().parents[2]

# One arm up, and one of them in a mirror.
POSES = {
    "a": {"left_arm": -35, "right_arm": 115, "left_leg": -12, "right_leg": 24},
    "b": {"left_arm": -40, "right_arm": 120, "left_leg": -15, "right_leg": 20},
    "c": {"left_arm": -45, "right_arm": 125, "left_leg": -10, "right_leg": 28},
}


@pytest.fixture(scope="module")
def waves(server, client, tmp_path_factory):
    """The files and the options that name the service and the session."""
    folder = tmp_path_factory.mktemp("waves")
    for name, pose in POSES.items():
        pixels = figure(**pose)
        (folder / f"{name}.png").write_bytes(png_of(pixels[:, ::-1] if name == "b" else pixels))
    files = [folder / f"{name}.png" for name in POSES]
    service = ["--server", server.address]
    answer(*service, "build", *files, "--session", "waves", "--out", folder / "out")
    yield service, files, folder
    client.session("waves").delete()


def test_it_names_the_drawing_that_faces_the_other_way(waves):
    service, _, _ = waves
    said = run(*service, "suggest", "waves")
    assert said.returncode == 0, said.stderr
    assert "seem to face the other way: b" in said.stdout
    assert "--session waves --flip b" in said.stdout


def test_drawings_that_may_be_turned_at_will_are_matched_by_suggest_and_built(waves, tmp_path):
    service, files, _ = waves
    upright = answer(*service, "suggest", "waves")
    turned = answer(*service, "suggest", "waves", "--rotation", "any")
    assert turned["confidence"] != upright["confidence"]
    said = [
        answer(*service, "build", *files[:2], "--rotation", rotation, "--out", tmp_path / rotation)
        for rotation in ("upright", "any")
    ]
    assert said[0]["revision"] != said[1]["revision"]


def test_its_document_is_what_docs_say_and_its_picture_shows_every_drawing(waves):
    service, _, folder = waves
    said = answer(*service, "suggest", "waves", "-o", folder / "matching.png")
    section = (ROOT / "docs/command.md").read_text().partition("## Suggestions")[2]
    described = re.findall(r"^\| `(\w+)` \|", section.partition("## Paths")[0], re.MULTILINE)
    assert sorted(described) == sorted(said)
    assert said["flips"] == ["b"] and said["flip_gain"] > 1.05
    for name in POSES:
        assert np.array(said["arcs"][name]).shape == (256, 2)
        assert said["arcs"][name][0] == said["starts"][name]
    with Image.open(folder / "matching.png") as sheet:
        width, height = sheet.size
        assert width > 3 * 200 and height > 200
        assert len(sheet.getcolors(1 << 20)) > 200  # as many colours as places, and more


def test_a_flip_is_accepted_by_build_and_then_no_longer_proposed(waves):
    service, files, folder = waves
    said = answer(*service, "build", *files, "--session", "waves", "--flip", "b", "--out", folder)
    assert {shape["id"]: shape["flipped"] for shape in said["shapes"]} == {
        "a": False,
        "b": True,
        "c": False,
    }
    assert answer(*service, "suggest", "waves")["flips"] == []


def test_a_flip_of_a_drawing_without_its_file_is_refused_before_anything_is_changed(waves):
    service, files, folder = waves
    before = answer(*service, "inspect", "waves")["etag"]
    said = refusal(
        1, *service, "build", files[0], "--session", "waves", "--flip", "b", "--out", folder
    )
    assert "--flip b" in said and "a" in said
    assert answer(*service, "inspect", "waves")["etag"] == before


def test_a_session_without_drawings_has_no_suggestion(server, client):
    empty = client.create_session()
    assert "drawing" in refusal(1, "--server", server.address, "suggest", empty.id)
    empty.delete()
