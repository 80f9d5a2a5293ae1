# SPDX-License-Identifier: Apache-2.0
"""posespace blend, render and animate."""

from __future__ import annotations

import json

import numpy as np
import pytest
from command_line import answer, refusal, run
from PIL import Image


@pytest.fixture
def at_walk(server, walk):
    """The beginning of commands, and the session they name."""
    return ["--server", server.address], walk


def test_blend_answers_the_frame_of_the_client(at_walk):
    server, walk = at_walk
    for arguments, place in (
        (["--at", "0.3,0.2"], {"at": (0.3, 0.2)}),
        (["--at", "-1,-.5"], {"at": (-1, -0.5)}),
        (["--at=-.5,1"], {"at": (-0.5, 1)}),
        (["--weights", "stand=0.25,wave=0.75"], {"weights": {"stand": 0.25, "wave": 0.75}}),
    ):
        said = answer(*server, "blend", walk.id, *arguments)
        frame = walk.blend(**place)
        assert said["session"] == walk.id and said["revision"] == frame.revision
        assert np.array_equal(np.array(said["vertices"], np.float32), frame.vertices)
        assert said["weights"] == frame.weights
        assert said["texture_weights"] == frame.texture_weights
        assert said["folds"] == 0


def test_blend_is_json_without_asking(at_walk):
    server, walk = at_walk
    assert json.loads(run(*server, "blend", walk.id, "--at", "0,0").stdout)["folds"] == 0


def test_weights_of_an_unknown_drawing_name_it_and_those_there_are(at_walk):
    server, walk = at_walk
    said = refusal(1, *server, "blend", walk.id, "--weights", "stand=0.5,run=0.5")
    assert "'run'" in said and "stand, step, wave" in said


@pytest.mark.parametrize(
    ("position", "says"),
    [
        (["--at", "nan,0"], "finite"),
        (["--weights", "stand=0.5"], "sum"),
        (["--weights", "stand=inf,wave=0"], "finite"),
    ],
)
def test_bad_places_are_refused(at_walk, tmp_path, position, says):
    server, walk = at_walk
    assert says in refusal(1, *server, "blend", walk.id, *position)
    out = tmp_path / "x.png"
    assert says in refusal(1, *server, "render", walk.id, *position, "-o", out)
    assert not out.exists()


def test_render_writes_the_picture_of_the_client(at_walk, tmp_path):
    server, walk = at_walk
    out = tmp_path / "new" / "walk.png"
    said = answer(*server, "render", walk.id, "--at", "0.5,0.3", "--size", "120x90", "--out", out)
    assert said == {"session": walk.id, "file": str(out), "size": [120, 90]}
    with Image.open(out) as picture:
        assert picture.size == (120, 90) and picture.mode == "RGBA"
        assert np.array_equal(np.asarray(picture), walk.render(at=(0.5, 0.3), size=(120, 90)))


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--size", "0x100", "-o", "x.png"], "0"),
        (["--size", "100x5000", "-o", "x.png"], "4096"),
        (["-o", "x.jpg"], "x.jpg: a picture is written as .png"),
        (["-o", "/dev/null/x.png"], "/dev/null"),
    ],
)
def test_pictures_that_cannot_be_are_refused(at_walk, tmp_path, arguments, says):
    server, walk = at_walk
    done = run(*server, "render", walk.id, "--at", "0,0", *arguments, cwd=tmp_path)
    assert done.returncode == 1 and says in done.stderr
    assert not list(tmp_path.iterdir())


PATH = "0,0 1,0.2 0.4,1"


@pytest.mark.parametrize("suffix", ["png", "gif", "webp"])
def test_animate_writes_a_file_that_plays(at_walk, tmp_path, suffix):
    server, walk = at_walk
    out = tmp_path / f"walk.{suffix}"
    arguments = ["--path", PATH, "--fps", "10", "--duration", "1.5", "--loop", "--size", "80x100"]
    said = answer(*server, "animate", walk.id, *arguments, "-o", out)
    assert said == {
        "session": walk.id,
        "file": str(out),
        "frames": 15,
        "fps": 10,
        "seconds": 1.5,
        "loop": True,
        "size": [80, 100],
    }
    path = [(0, 0), (1, 0.2), (0.4, 1)]
    drawn = walk.render_animation(path, fps=10, duration=1.5, loop=True, size=(80, 100))
    with Image.open(out) as animation:
        assert (animation.n_frames, animation.size) == (15, (80, 100))
        assert animation.info["loop"] == 0
        for k, pixels in enumerate(drawn):
            animation.seek(k)
            shown = np.asarray(animation.convert("RGBA"))
            assert animation.info["duration"] == 100
            if suffix == "gif":
                painted = pixels[..., 3] >= 128
                assert np.array_equal(shown[..., 3] == 255, painted)
                assert np.abs(shown.astype(int) - pixels)[painted].mean() < 8
            else:
                assert np.array_equal(shown[..., 3], pixels[..., 3])
            if suffix == "png":
                assert np.array_equal(shown, pixels)


def test_animate_writes_single_frames(at_walk, tmp_path):
    server, walk = at_walk
    out = tmp_path / "frames" / "%03d.png"
    arguments = ["--path", PATH, "--fps", "4", "--easing", "in-out", "--size", "40x50"]
    done = run(*server, "animate", walk.id, *arguments, "-o", out)
    assert done.returncode == 0 and "9 frames" in done.stdout
    assert sorted(path.name for path in out.parent.iterdir()) == [f"{k:03}.png" for k in range(9)]
    eased = walk.render_animation(
        [(0, 0), (1, 0.2), (0.4, 1)], fps=4, easing="in-out", size=(40, 50)
    )
    for k, pixels in enumerate(eased):
        with Image.open(out.parent / f"{k:03}.png") as frame:
            assert np.array_equal(np.asarray(frame), pixels)


@pytest.mark.parametrize(
    "content",
    [
        "0 0 0\n1 0.2 0.5\n0.4 1 2\n",
        "# x y seconds\n\n0, 0, 0   # here\n1,0.2,0.5\n 0.4\t1\t2",
        "[[0, 0, 0], [1, 0.2, 0.5], [0.4, 1, 2]]",
    ],
    ids=["lines", "lines with notes", "JSON"],
)
def test_a_path_file_says_where_and_when(at_walk, tmp_path, content):
    server, walk = at_walk
    (tmp_path / "path").write_text(content)
    arguments = ["--path-file", tmp_path / "path", "--fps", "10", "--size", "40x50"]
    out = tmp_path / "walk.png"
    assert answer(*server, "animate", walk.id, *arguments, "-o", out)["frames"] == 21
    with Image.open(out) as animation:
        animation.seek(5)
        assert np.array_equal(np.asarray(animation), walk.render(at=(1, 0.2), size=(40, 50)))


def test_times_may_stand_on_the_command_line_and_places_be_negative(at_walk, tmp_path):
    server, walk = at_walk
    out = tmp_path / "walk.png"
    for path, frames in (("-1,0,0 0,0,2", 9), ("-1,0", 1), ("-.5,.5 1,1", 5)):
        arguments = ["--path", path, "--fps", "4", "--size", "30x40", "-o", out]
        assert answer(*server, "animate", walk.id, *arguments)["frames"] == frames


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("", "no waypoint"),
        ("0 0\n1\n", "line 2 is '1'"),
        ("0 0\n1 up\n", "line 2 is '1 up'"),
        ("[[0, 0], [1]]", "waypoint 1 is [1]"),
        ("[[0, 0], [true, 1]]", "waypoint 1"),
        ("[", "not JSON"),
        ("[]", "a path in JSON"),
        ('{"path": 1}', "a path in JSON"),
        ("\x80", None),
        ("0 0 0\n1 1 0\n", "time"),
        ("0 0 0\n1 1\n", "time"),
        ("0 0\n0 0\n", "waypoint"),
    ],
)
def test_bad_path_files_are_refused_by_what_is_wrong_with_them(at_walk, tmp_path, content, says):
    server, walk = at_walk
    (tmp_path / "path").write_bytes(content.encode("latin-1"))
    out = tmp_path / "x.png"
    arguments = ["--path-file", tmp_path / "path", "-o", out]
    assert (says or "UTF-8") in refusal(1, *server, "animate", walk.id, *arguments)
    assert [path.name for path in tmp_path.iterdir()] == ["path"]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["-o", "x.mp4"], "x.mp4"),
        (["--fps", "60", "-o", "x.gif"], "at most 50"),
        (["--fps", "0", "-o", "x.png"], "fps is 0"),
        (["--duration", "-1", "-o", "x.png"], "duration"),
        (["--duration", "3600", "--fps", "1000", "-o", "x.png"], "frames"),
        (["--size", "9999x10", "-o", "x.png"], "4096"),
        (["--path-file", "nowhere", "-o", "x.png"], "nowhere"),
    ],
)
def test_animations_that_cannot_be_are_refused(at_walk, tmp_path, arguments, says):
    server, walk = at_walk
    if "--path-file" not in arguments:
        arguments = ["--path", PATH, *arguments]
    done = run(*server, "animate", walk.id, *arguments, cwd=tmp_path)
    assert done.returncode == 1 and says in done.stderr, done.stderr
    assert not list(tmp_path.iterdir())
