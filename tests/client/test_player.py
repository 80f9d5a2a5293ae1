# SPDX-License-Identifier: Apache-2.0
"""The stream of frames."""

from __future__ import annotations

import itertools
import threading
import time

import numpy as np
import posespace
import pytest
from synthetic_drawings import star
from walk_session import make_walk

NAN = float("nan")


@pytest.fixture
def other(client):
    """A built session of two stars, with fewer vertices than a figure."""
    session = client.create_session()
    session.put_shape("sharp", polygon=star())
    session.put_shape("turned", polygon=star(turn=0.3))
    session.set_placements({"sharp": (0, 0), "turned": (1, 0)})
    session.build(target_edge_length=0.3)
    yield session
    session.delete()


def test_frames_come_in_order_and_equal_single_blends(walk):
    points = np.random.default_rng(2).uniform(-0.5, 1.5, (200, 2))
    expected = walk.blend_many(points)
    with walk.play() as player:
        frames = list(player.frames(points))
    assert np.array_equal([frame.vertices for frame in frames], expected)
    single = walk.blend(at=points[7])
    assert frames[7].weights == single.weights
    assert frames[7].texture_weights == single.texture_weights
    assert frames[7].revision == single.revision


def test_points_are_read_only_as_far_ahead_as_frames_are_under_way(walk):
    asked = itertools.count()
    with walk.play() as player:
        endless = ((0.0, next(asked) * 1e-3) for _ in itertools.repeat(None))
        frames = player.frames(endless)
        for _ in range(10):
            next(frames)
        assert next(asked) <= 10 + player.max_in_flight
        frames.close()


def test_frames_given_up_do_not_disturb_later_ones(walk):
    with walk.play() as player:
        given_up = player.frames([(t, 0.0) for t in np.linspace(0, 1, 50)])
        next(given_up)
        given_up.close()
        again = list(player.frames([(0.25, 0.5)]))
    assert np.array_equal(again[0].vertices, walk.blend(at=(0.25, 0.5)).vertices)


def test_two_series_of_frames_and_a_tick_can_be_interleaved(walk):
    left, right = [(0.1 * k, 0.0) for k in range(9)], [(0.0, 0.1 * k) for k in range(9)]
    with walk.play() as player:
        pairs = zip(player.frames(left), player.frames(right), strict=True)
        for k, (a, b) in enumerate(pairs):
            (c,) = player.tick([player.avatar.item(at=(0.05 * k, 0.7))])
            assert np.array_equal(a.vertices, walk.blend(at=left[k]).vertices)
            assert np.array_equal(b.vertices, walk.blend(at=right[k]).vertices)
            assert np.array_equal(c.vertices, walk.blend(at=(0.05 * k, 0.7)).vertices)


def test_a_bad_point_is_raised_in_its_turn_and_the_stream_goes_on(walk):
    with walk.play() as player:
        frames = player.frames([(0, 0), (NAN, 0), (1, 0)])
        next(frames)
        with pytest.raises(posespace.InvalidArgument) as refusal:
            next(frames)
        assert refusal.value.reason == "POSE_NOT_FINITE"
        assert len(list(player.frames([(0, 0), (1, 0)]))) == 2


def test_a_tick_answers_many_avatars_of_several_sessions_in_order(walk, other):
    with walk.play() as player:
        figure, stars = player.avatar, player.bind(other)
        assert (figure.shape_ids, stars.shape_ids) == (walk.shape_ids, other.shape_ids)
        items = [
            figure.item(at=(0.3, 0.3)),
            stars.item(at=(0.5, 0)),
            figure.item(weights={"wave": 1.0}),
            stars.item(at=(0.5, 0), method="linear"),
        ]
        answers = player.tick(items)
    expected = [
        walk.blend(at=(0.3, 0.3)),
        other.blend(at=(0.5, 0)),
        walk.blend(weights={"wave": 1.0}),
        other.blend(at=(0.5, 0), method="linear"),
    ]
    for answer, frame in zip(answers, expected, strict=True):
        assert np.array_equal(answer.vertices, frame.vertices)
        assert answer.weights == frame.weights
        assert answer.revision == frame.revision
    assert stars.vertex_count == len(expected[1].vertices) != figure.vertex_count


def test_an_items_error_stays_in_its_place(walk, other):
    with walk.play() as player:
        gone = player.bind(other)
        player.unbind(gone)
        good, not_finite, off, unbound = player.tick(
            [
                player.avatar.item(at=(0, 0)),
                player.avatar.item(at=(NAN, 0)),
                player.avatar.item(weights={"stand": 0.7}),
                gone.item(at=(0, 0)),
            ]
        )
        assert isinstance(good, posespace.Frame)
        assert not_finite.reason == "POSE_NOT_FINITE"
        assert off.reason == "WEIGHTS_SUM_NOT_ONE"
        assert isinstance(unbound, posespace.NotBuilt) and unbound.reason == "SLOT_NOT_BOUND"
        assert len(list(player.frames([(0, 0)]))) == 1


def test_a_tick_larger_than_a_message_is_split(walk):
    with walk.play() as player:
        count = 2 * player.max_items + 17
        points = np.random.default_rng(4).uniform(0, 1, (count, 2))
        answers = player.tick([player.avatar.item(at=at) for at in points])
    assert np.array_equal([frame.vertices for frame in answers], walk.blend_many(points))


def test_a_tick_of_nothing_is_answered_with_nothing(walk):
    with walk.play() as player:
        assert player.tick([]) == []


def test_frames_without_weights_are_the_same_otherwise(walk):
    with walk.play() as player:
        (bare,) = player.frames([(0.2, 0.2)], with_weights=False)
    assert bare.weights == bare.texture_weights == {}
    assert np.array_equal(bare.vertices, walk.blend(at=(0.2, 0.2)).vertices)


def test_compact_frames_are_off_by_no_more_than_half_a_step(walk):
    places = [(0.2, 0.2), (0.7, 0.1), (1.5, -0.4)]
    with walk.play() as player:
        frames = list(player.frames(places, compact=True))
        ticked = player.tick([player.avatar.item(at=at) for at in places], compact=True)
    for at, frame, same in zip(places, frames, ticked, strict=True):
        exact = walk.blend(at=at).vertices
        longer = np.ptp(exact, axis=0).max()
        assert frame.vertices.dtype == np.float32
        assert np.array_equal(frame.vertices, same.vertices)
        assert 0 < np.abs(frame.vertices - exact).max() <= longer / 128_000 + 1e-4


def test_blend_options_hold_for_frames(walk):
    with walk.play() as player:
        (frame,) = player.frames([(0.6, 0.2)], method="linear")
    assert np.array_equal(frame.vertices, walk.blend(at=(0.6, 0.2), method="linear").vertices)


def test_frames_follow_new_placements_and_say_so(client):
    session = make_walk(client)
    with session.play() as player:
        (before,) = player.frames([(0.5, 0.5)])
        revision = session.set_placements(
            {"stand": (0, 0), "step": (0.5, 0.5), "wave": (0, 1)}
        ).revision
        (after,) = player.frames([(0.5, 0.5)])
        assert before.revision != after.revision == revision == player.avatar.revision
        while after.fading:
            (after,) = player.frames([(0.5, 0.5)])
        assert after.weights["step"] == pytest.approx(1)
    session.delete()


def shares(before, after, frames):
    """How far each frame's weights have come from those of `before` to those of `after`."""
    old, new = (np.array(list(frame.weights.values())) for frame in (before, after))
    for frame in frames:
        weights = np.array(list(frame.weights.values()))
        share = (weights - old) @ (new - old) / ((new - old) @ (new - old))
        assert np.allclose(weights, old + share * (new - old), atol=1e-9)
        yield share


def test_an_avatar_glides_from_old_placements_to_new_ones_and_arrives_exactly(client):
    session = make_walk(client)
    with session.play() as player:
        (before,) = player.frames([(0.5, 0.5)])
        session.set_placements({"stand": (0, 0), "step": (0.5, 0.5), "wave": (0, 1)})
        exact = session.blend(at=(0.5, 0.5))
        frames = list(player.frames([(0.5, 0.5)]))
        while frames[-1].fading:
            frames += player.frames([(0.5, 0.5)])
        # At explicit weights nothing changes.
        (chosen,) = player.tick([player.avatar.item(weights={"wave": 1.0})])
    assert not before.fading and not exact.fading and not chosen.fading
    assert all(frame.fading for frame in frames[:-1])
    assert np.array_equal(frames[0].vertices, before.vertices)
    assert frames[0].weights == before.weights
    assert np.array_equal(frames[-1].vertices, exact.vertices)
    assert frames[-1].weights == exact.weights
    assert frames[-1].texture_weights == exact.texture_weights
    way = list(shares(before, exact, frames))
    assert way == sorted(way)
    session.delete()


def test_an_avatar_is_between_old_placements_and_new_ones_for_as_long_as_the_service_is_told():
    with (
        posespace.serve_locally(flags=["--placement-fade", "10000"]) as server,
        posespace.connect(server.address) as client,
    ):
        session = make_walk(client)
        with session.play() as player:
            (before,) = player.frames([(0.5, 0.5)])
            session.set_placements({"stand": (0, 0), "step": (0.5, 0.5), "wave": (0, 1)})
            (first,) = player.frames([(0.5, 0.5)])
            time.sleep(0.3)
            (later,) = player.frames([(0.5, 0.5)])
            assert first.fading and later.fading
            start, share = shares(before, session.blend(at=(0.5, 0.5)), [first, later])
            assert start == 0.0 < share < 1.0
            moved = np.abs(later.vertices - before.vertices).max()
            assert moved > 0.0


def test_weights_meant_for_other_drawings_are_not_taken_for_these(client):
    session = make_walk(client)
    with session.play() as player:
        item = player.avatar.item(weights={"stand": 1.0})
        session.delete_shape("stand")
        session.put_shape("star", polygon=star())
        session.set_placements({"step": (0, 0), "wave": (1, 0), "star": (0, 1)})
        session.build()
        deadline = time.monotonic() + 10
        while player.avatar.shape_ids == ["stand", "step", "wave"]:
            assert time.monotonic() < deadline
            next(player.frames([(0, 0)]))
        (answer,) = player.tick([item])
        assert isinstance(answer, posespace.Conflict)
        (frame,) = player.tick([player.avatar.item(weights={"star": 1.0})])
        assert isinstance(frame, posespace.Frame)
    session.delete()


def test_a_pinned_revision_stays(client):
    session = make_walk(client)
    revision = session.state().revision
    with session.play(revision=revision) as player:
        (before,) = player.frames([(0.5, 0.5)])
        session.set_placements({"stand": (0, 0), "step": (0.5, 0.5), "wave": (0, 1)})
        (after,) = player.frames([(0.5, 0.5)])
        assert np.array_equal(before.vertices, after.vertices)
        assert after.revision == revision
    with pytest.raises(posespace.NotFound) as refusal:
        session.play(revision=revision)
    assert refusal.value.reason == "REVISION_NOT_FOUND"
    session.delete()


def test_a_session_deleted_under_a_stream_errs_alone(client, walk):
    doomed = make_walk(client)
    with walk.play() as player:
        avatar = player.bind(doomed)
        doomed.delete()
        dead, alive = player.tick([avatar.item(at=(0, 0)), player.avatar.item(at=(0, 0))])
        assert isinstance(dead, posespace.NotFound) and dead.reason == "SESSION_NOT_FOUND"
        assert isinstance(alive, posespace.Frame)


def test_frames_of_a_deleted_session_say_that_it_was_deleted(client):
    session = make_walk(client)
    with session.play() as player:
        next(player.frames([(0, 0)]))
        session.delete()
        gone = f"session '{session.id}' was deleted"
        with pytest.raises(posespace.NotFound, match=gone) as refusal:
            list(player.frames([(0, 0)]))
        assert refusal.value.reason == "SESSION_NOT_FOUND"
        assert player.avatar.revision == ""
        (answer,) = player.tick([player.avatar.item(weights={"stand": 1.0})])
        assert isinstance(answer, posespace.NotFound) and answer.reason == "SESSION_NOT_FOUND"


def test_more_sessions_than_slots_are_refused(walk):
    with walk.play() as player:
        for _ in range(player.max_slots - 1):
            player.bind(walk)
        with pytest.raises(posespace.InvalidArgument) as refusal:
            player.bind(walk)
        assert refusal.value.reason == "SLOT_LIMIT"
        assert len(list(player.frames([(0, 0)]))) == 1


def test_a_freed_slot_is_used_again(walk, other):
    with walk.play() as player:
        first = player.bind(other)
        player.unbind(first)
        assert player.bind(other).slot == first.slot


def test_unknown_and_unbuilt_sessions_are_refused_at_binding(client, walk, session):
    with walk.play() as player:
        with pytest.raises(posespace.NotBuilt):
            player.bind(session)
        assert len(list(player.frames([(0, 0)]))) == 1


def test_a_closed_player_says_so(walk):
    with walk.play() as player:
        pass
    with pytest.raises(posespace.Unavailable, match="closed"):
        list(player.frames([(0, 0)]))


def test_many_streams_play_at_once(walk):
    points = np.random.default_rng(6).uniform(0, 1, (100, 2))
    expected, wrong = walk.blend_many(points), []

    def play() -> None:
        with walk.play() as player:
            frames = [frame.vertices for frame in player.frames(points)]
            if not np.array_equal(frames, expected):
                wrong.append(frames)

    threads = [threading.Thread(target=play) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


@pytest.fixture
def short_lived():
    """A service whose streams are old after a second."""
    with posespace.serve_locally(flags=["--max-stream-age", "1"]) as server:
        yield server


def test_a_player_outlives_its_streams(short_lived):
    with posespace.connect(short_lived.address) as client:
        session = make_walk(client)
        mesh = session.mesh()
        with session.play() as player:
            pinned = player.bind(session, revision=mesh.revision)
            first_stream, end = player._stream, time.monotonic() + 5.0
            while player._stream is first_stream and time.monotonic() < end:
                frames = list(player.frames([(0, 0)] * 9))
                for frame in frames:
                    assert np.abs(frame.vertices - mesh.vertices["stand"]).max() < 1e-2
                time.sleep(0.01)
            assert player._stream is not first_stream
            (frame,) = player.tick([pinned.item(at=(1, 0.2))])
            assert np.abs(frame.vertices - mesh.vertices["step"]).max() < 1e-2


def test_a_session_deleted_before_the_stream_is_left_errs_alone(short_lived):
    with posespace.connect(short_lived.address) as client:
        session, other = make_walk(client), make_walk(client)
        with session.play() as player:
            gone = player.bind(other)
            other.delete()
            first_stream, end = player._stream, time.monotonic() + 5.0
            while player._stream is first_stream and time.monotonic() < end:
                kept, lost = player.tick([player.avatar.item(at=(0, 0)), gone.item(at=(0, 0))])
                assert isinstance(kept, posespace.Frame)
                assert isinstance(lost, posespace.NotFound)
                time.sleep(0.01)
            assert player._stream is not first_stream
            kept, lost = player.tick([player.avatar.item(at=(0, 0)), gone.item(at=(0, 0))])
            assert isinstance(kept, posespace.Frame)
            assert isinstance(lost, posespace.NotFound)
