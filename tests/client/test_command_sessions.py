# SPDX-License-Identifier: Apache-2.0
"""posespace inspect and posespace sessions."""

from __future__ import annotations

import time

import pytest
from command_line import answer, refusal, run
from synthetic_drawings import star
from walk_session import make_walk


def test_inspect_says_everything_about_a_built_session(server, walk):
    said = answer("--server", server.address, "inspect", walk.id)
    state, report = walk.state(), walk.mesh().report
    assert [shape["id"] for shape in said["shapes"]] == ["stand", "step", "wave"]
    for shape, known in zip(said["shapes"], walk.shapes(), strict=True):
        assert shape["size"] == list(known.size)
        assert shape["outline_points"] == [len(ring) for ring in known.outline]
        assert shape["warnings"] == known.warnings
        assert shape["confidence"] == report.confidence[shape["id"]]
        assert shape["placement"] == list(state.placements[shape["id"]])
    assert said["build"] == {
        "state": "succeeded",
        "stage": "weights",
        "fraction": 1.0,
        "error": None,
        "reason": None,
    }
    assert said["revision"] == state.revision and not said["placements_are_default"]
    assert said["report"]["triangles"] == report.triangles
    assert said["report"]["min_angle"] == report.min_angle
    assert said["report"]["levels"] == report.levels

    shown = run("--server", server.address, "inspect", walk.id).stdout
    for words in (walk.id, "stand", "200 x 260", "(1, 0.2)", "degrees", "succeeded"):
        assert words in shown
    assert f"{report.triangles:,}" in shown and state.revision in shown


def test_inspect_shows_warnings_marks_and_default_places(server, session):
    session.put_shape("star", polygon=star(), holes=[[(95, 95), (105, 95), (105, 105), (95, 105)]])
    session.set_correspondences([{"star": star()[0]}])
    said = answer("--server", server.address, "inspect", session.id)
    assert said["report"] is None and said["build"] is None and said["placements_are_default"]
    (shape,) = said["shapes"]
    assert shape["holes_filled"] == 1 and shape["confidence"] is None
    assert said["correspondences"] == [{"star": star()[0].tolist()}]

    shown = run("--server", server.address, "inspect", session.id).stdout
    assert "not built yet" in shown and "default" in shown
    for warning in shape["warnings"]:
        assert warning in shown


def test_inspect_says_that_a_drawing_has_no_place_yet(server, session):
    session.put_shape("a", polygon=star())
    session.set_placements({"a": (0, 0)})
    session.put_shape("b", polygon=star(turn=0.2))
    said = answer("--server", server.address, "inspect", session.id)
    assert [shape["placement"] for shape in said["shapes"]] == [[0, 0], None]
    assert "nowhere yet" in run("--server", server.address, "inspect", session.id).stdout


def test_inspect_of_an_empty_session(server, session):
    assert answer("--server", server.address, "inspect", session.id)["shapes"] == []
    assert "no drawings" in run("--server", server.address, "inspect", session.id).stdout


def test_sessions_are_listed_shown_and_removed(server, client):
    made = client.create_session("listed", display_name="A list", labels={"who": "us"})
    made.put_shape("star", polygon=star())
    (listed,) = [
        each
        for each in answer("--server", server.address, "sessions", "ls")["sessions"]
        if each["session"] == "listed"
    ]
    assert listed == answer("--server", server.address, "sessions", "show", "listed")
    assert listed["display_name"] == "A list" and listed["labels"] == {"who": "us"}
    assert listed["shapes"] == ["star"] and listed["build"] is None and listed["revision"] == ""
    shown = run("--server", server.address, "sessions", "ls").stdout
    assert any("listed" in line and "not built" in line for line in shown.splitlines())
    assert "label who" in run("--server", server.address, "sessions", "show", "listed").stdout

    client.create_session("also-listed")
    removed = answer("--server", server.address, "sessions", "rm", "listed", "also-listed")
    assert removed == {"removed": ["listed", "also-listed"]}
    ids = {session.id for session in client.sessions()}
    assert not ids & {"listed", "also-listed"}


def test_removing_stops_at_a_session_that_is_not_there(server, client):
    client.create_session("there")
    done = run("--server", server.address, "sessions", "rm", "there", "not-there", "there-too")
    assert done.returncode == 1 and done.stdout == "removed there\n"
    assert "'not-there'" in done.stderr


def test_a_service_without_sessions_says_so():
    assert run("--store", "memory", "sessions", "ls").stdout == "no sessions\n"
    assert answer("--store", "memory", "sessions", "ls") == {"sessions": []}


@pytest.mark.parametrize("name", ["", "a b", "../x", "x" * 64])
def test_names_that_no_session_can_have_are_refused(server, name):
    assert refusal(1, "--server", server.address, "sessions", "show", name)


def test_a_cancelled_build_says_so_with_its_reason(server, client):
    walk = make_walk(client)

    def give_up(stage, fraction):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        walk.build(tolerance=0.001, target_edge_length=0.02, on_progress=give_up)
    said = answer("--server", server.address, "inspect", walk.id)["build"]
    give_up_at = time.monotonic() + 60
    while said["state"] == "running" and time.monotonic() < give_up_at:  # until the build notices
        said = answer("--server", server.address, "inspect", walk.id)["build"]
    assert (said["state"], said["reason"]) == ("cancelled", "CANCELLED") and said["error"]
    assert "cancelled: " in run("--server", server.address, "inspect", walk.id).stdout
    walk.delete()
