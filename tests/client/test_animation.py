# SPDX-License-Identifier: Apache-2.0
"""Session.animate and Session.render_animation: a path, frame by frame."""

from __future__ import annotations

import itertools
import time

import numpy as np
import posespace
import pytest
from synthetic_drawings import star
from walk_session import make_walk

PATH = [(0, 0), (1, 0.2), (0.4, 1)]


def test_frames_come_in_order_with_their_time_and_place(walk):
    frames = list(walk.animate(PATH, fps=20, duration=1.0))
    assert [frame.index for frame in frames] == list(range(len(frames)))
    assert np.allclose([frame.time for frame in frames[:-1]], np.arange(len(frames) - 1) / 20)
    assert frames[0].at == PATH[0] and frames[-1].at == PATH[-1]
    assert {frame.revision for frame in frames} == {walk.state().revision}


def test_each_frame_is_the_blend_at_its_place(walk):
    for frame in walk.animate(PATH, fps=5):
        blend = walk.blend(at=frame.at)
        assert np.allclose(frame.vertices, blend.vertices, atol=1e-3)
        assert frame.weights == pytest.approx(blend.weights, abs=1e-9)
        assert frame.folds == blend.folds


def test_a_path_may_be_an_array_with_or_without_times(walk):
    plain = [frame.at for frame in walk.animate(np.array(PATH, float), fps=10, duration=2)]
    timed = np.array([(0, 0, 0), (1, 0.2, 0.5), (0.4, 1, 3)])
    frames = list(walk.animate(timed, fps=10))
    assert plain[0] == PATH[0] and plain[-1] == PATH[-1]
    assert frames[5].at == pytest.approx(PATH[1]) and frames[30].at == pytest.approx(PATH[2])


def test_a_loop_ends_one_frame_before_it_begins_again(walk):
    frames = list(walk.animate(PATH, fps=10, duration=3, loop=True))
    assert len(frames) == 30
    steps = np.hypot(*np.diff([frame.at for frame in [*frames, frames[0]]], axis=0).T)
    assert steps.min() > 0 and steps[-1] < 2 * np.median(steps)


def test_easing_begins_and_ends_at_rest(walk):
    def first_step(easing):
        first, second = itertools.islice(walk.animate(PATH, fps=30, easing=easing), 2)
        return np.hypot(*np.subtract(second.at, first.at))

    assert first_step("in-out") < 0.2 * first_step("uniform")


def test_options_are_those_of_blend(walk):
    for frame in walk.animate(PATH, fps=2, method="linear"):
        assert np.allclose(
            frame.vertices, walk.blend(at=frame.at, method="linear").vertices, atol=1e-3
        )


def test_a_single_point_is_a_single_frame(walk):
    (frame,) = walk.animate([(0.4, 0.4)])
    assert (frame.index, frame.time, frame.at) == (0, 0, (0.4, 0.4))


def test_paced_frames_come_at_their_instants_and_not_before(walk):
    start = time.monotonic()
    frames = list(walk.animate([(0, 0), (1, 0)], fps=20, duration=0.5, paced=True))
    assert len(frames) == 11 and time.monotonic() - start > 0.45


def test_leaving_early_ends_the_stream():
    with (
        posespace.serve_locally(flags=["--max-streams", "2"]) as server,
        posespace.connect(server.address) as client,
    ):
        walk = make_walk(client)
        for _ in range(5):  # more than may be open at once
            for frame in walk.animate([(0, 0), (1, 0)], fps=1000, duration=90):
                if frame.index == 3:
                    break
            pictures = walk.render_animation([(0, 0), (1, 0)], fps=100, duration=90, size=(64, 64))
            next(pictures)
            pictures.close()


def test_nothing_is_asked_before_the_first_frame_is_taken(client, session):
    frames = session.animate(PATH)
    session.put_shape("star", polygon=star())
    session.build()
    assert next(frames).index == 0


def test_weights_are_named_after_a_rebuild_with_other_drawings(client, session):
    session.put_shape("a", polygon=star())
    session.build()
    assert set(next(session.animate([(0, 0)])).weights) == {"a"}
    session.put_shape("b", polygon=star(turn=0.3))
    session.build()
    assert set(next(session.animate([(0, 0)])).weights) == {"a", "b"}


def test_pictures_are_those_of_render(walk):
    path, fps = [(0, 0), (0.4, 1)], 8
    places = [frame.at for frame in walk.animate(path, fps=fps)]
    pictures = list(walk.render_animation(path, fps=fps, size=(60, 80)))
    assert len(pictures) == len(places)
    for at, pixels in zip(places, pictures, strict=True):
        assert pixels.shape == (80, 60, 4) and pixels.dtype == np.uint8 and pixels.flags.writeable
        assert np.array_equal(pixels, walk.render(at=at, size=(60, 80)))


def test_a_view_shows_a_part(walk):
    view = (60, 10, 80, 80)
    (pixels,) = walk.render_animation([(0, 0)], size=(50, 50), view=view)
    assert np.array_equal(pixels, walk.render(at=(0, 0), size=(50, 50), view=view))


@pytest.mark.parametrize(
    ("path", "options", "says"),
    [
        ([], {}, "waypoint"),
        (7, {}, "path is 7"),
        ([(0, 0), (1,)], {}, r"path\[1\] must be x, y or x, y, seconds"),
        ([(0, 0), ("a", "b")], {}, r"path\[1\]"),
        ([(0, 0), (float("nan"), 0)], {}, "finite"),
        ([(0, 0), (0, 0)], {}, "waypoint"),
        ([(0, 0, 0), (1, 1)], {}, "time"),
        ([(0, 0, 1), (1, 1, 0.5)], {}, "time"),
        (PATH, {"fps": 0}, "fps"),
        (PATH, {"fps": "fast"}, "fps is 'fast'"),
        (PATH, {"easing": "bouncy"}, "easing is 'bouncy', not one of 'uniform', 'in-out'"),
        (PATH, {"duration": -1}, "duration"),
        (PATH, {"duration": 3600, "fps": 1000}, "frames"),
        (PATH, {"method": "wild"}, "method"),
        (PATH, {"sigma": 2}, "sigma"),
    ],
)
def test_a_bad_path_is_refused_by_what_is_wrong_with_it(walk, path, options, says):
    with pytest.raises(posespace.InvalidArgument, match=says):
        next(walk.animate(path, **options))
    with pytest.raises(posespace.InvalidArgument, match=says):
        next(walk.render_animation(path, size=(8, 8), **options))


def test_a_session_that_is_not_built_is_refused(session):
    with pytest.raises(posespace.NotBuilt):
        next(session.animate(PATH))
    with pytest.raises(posespace.NotBuilt):
        next(session.render_animation(PATH))
