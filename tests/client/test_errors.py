# SPDX-License-Identifier: Apache-2.0
"""What is wrong is said with drawing, place and limit, and the service goes on."""

from __future__ import annotations

import io
import re
import threading

import numpy as np
import posespace
import pytest
from PIL import Image
from synthetic_drawings import WALK, figure, png_of, star
from walk_session import make_walk

NAN = float("nan")
CARD = figure(**WALK["stand"])


@pytest.fixture(autouse=True)
def service_goes_on(client):
    yield
    client.ping()


def refused(kind: type[posespace.Error], reason: str, *words: str):
    """Expects exactly this kind of error, with its reason, and the words in its message."""

    class Refusal:
        def __enter__(self):
            self.raised = pytest.raises(kind)
            self.info = self.raised.__enter__()
            return self.info

        def __exit__(self, *exception):
            swallowed = self.raised.__exit__(*exception)
            error = self.info.value
            assert type(error) is kind
            assert error.reason == reason
            for word in words:
                assert word in str(error), f"'{word}' is not in: {error}"
            return swallowed

    return Refusal()


# Drawings.


def test_no_drawing_at_all(session):
    with refused(posespace.InvalidDrawing, "SHAPE_SOURCE_MISSING", "ghost"):
        session.put_shape("ghost")


@pytest.mark.parametrize("size", [(1, 1), (30, 30)])
def test_a_transparent_picture(session, size):
    with refused(posespace.InvalidDrawing, "OUTLINE_EMPTY", "ghost", "128"):
        session.put_shape("ghost", image=np.zeros((*size, 4), np.uint8))


def test_a_picture_of_one_pixel(session):
    with refused(posespace.InvalidDrawing, "OUTLINE_TOO_SMALL", "dot"):
        session.put_shape("dot", image=np.full((1, 1, 4), 255, np.uint8))


def test_a_truncated_png(session):
    whole = png_of(figure(**WALK["stand"]))
    for length in (8, 40, len(whole) // 2, len(whole) - 20):
        with refused(posespace.InvalidDrawing, "IMAGE_UNDECODABLE", "torn"):
            session.put_shape("torn", image=whole[:length])


def test_a_picture_of_no_bytes(session):
    with refused(posespace.InvalidDrawing, "SHAPE_SOURCE_MISSING", "blank"):
        session.put_shape("blank", image=b"")


@pytest.mark.parametrize("data", [b"hello", b"GIF89a" + bytes(100)])
def test_bytes_that_are_no_picture(session, data):
    with refused(posespace.InvalidDrawing, "IMAGE_UNDECODABLE", "junk"):
        session.put_shape("junk", image=data)


def test_a_picture_with_too_many_pixels_is_refused_by_its_header(session):
    file = io.BytesIO()
    Image.new("1", (8000, 8000)).save(file, format="PNG")
    with refused(posespace.InvalidDrawing, "IMAGE_TOO_LARGE", "wall", "8000", "32000000"):
        session.put_shape("wall", image=file.getvalue())


def test_a_request_that_is_too_large_names_the_limit(session):
    noise = np.random.default_rng(0).integers(0, 255, (2500, 2500, 4), dtype=np.uint8)
    with refused(posespace.ResourceExhausted, "REQUEST_TOO_LARGE", "23.", "16 MiB"):
        session.put_shape("noise", image=noise)


@pytest.mark.parametrize(
    "array",
    [
        np.zeros((4, 4)),
        np.zeros((4, 4, 4)),
        np.zeros((4, 4, 2), np.uint8),
        np.zeros((0, 4, 4), np.uint8),
    ],
    ids=["grey", "float", "two channels", "no rows"],
)
def test_an_array_that_is_no_picture(session, array):
    with refused(posespace.InvalidDrawing, "IMAGE_UNDECODABLE", "array", "(H, W, 3)"):
        session.put_shape("array", image=array)


def test_a_file_that_is_not_there(session):
    with pytest.raises(FileNotFoundError, match="nowhere"):
        session.put_shape("stand", image="nowhere.png")


def test_a_hole_that_crosses_the_outline_names_both_edges(session):
    hole = [(150, 100), (250, 100), (150, 120)]
    with refused(posespace.InvalidDrawing, "OUTLINE_SELF_INTERSECTS", "star", "edge") as refusal:
        session.put_shape("star", polygon=star(), holes=[hole])
    assert any(field.startswith("polygon.holes[0][") for field in refusal.value.fields)
    assert any(field.startswith("polygon.outer[") for field in refusal.value.fields)


@pytest.mark.parametrize("bad", [NAN, float("inf"), -float("inf")])
def test_a_polygon_with_a_point_that_is_not_finite(session, bad):
    ring = star()
    ring[3, 1] = bad
    with pytest.raises(posespace.InvalidArgument, match="finite") as refusal:
        session.put_shape("star", polygon=ring)
    assert "'star'" in str(refusal.value), "names the drawing"
    assert re.search(r"\b[37]\b", str(refusal.value)), "names point 3, or coordinate 7"


@pytest.mark.parametrize("ring", [[], [(0, 0)], [(0, 0), (5, 5)], [(0, 0), (5, 5), (9, 9)]])
def test_a_polygon_without_area(session, ring):
    with pytest.raises(posespace.InvalidDrawing, match="line"):
        session.put_shape("line", polygon=ring)


def test_a_polygon_of_another_form(session):
    with refused(posespace.InvalidArgument, "INVALID_OPTION", "(K, 2)", "(10, 3)"):
        session.put_shape("star", polygon=np.zeros((10, 3)))


def test_too_many_outline_points(session):
    angle = np.linspace(0, 2 * np.pi, 20_001, endpoint=False)
    ring = 500 + 400 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    with refused(posespace.InvalidDrawing, "OUTLINE_TOO_LONG", "disc", "20001", "20000"):
        session.put_shape("disc", polygon=ring)


@pytest.mark.parametrize("threshold", [0, 256, -1])
def test_a_threshold_out_of_range(session, threshold):
    with refused(posespace.InvalidArgument, "INVALID_OPTION", "threshold", "255"):
        session.put_shape("stand", image=figure(**WALK["stand"]), threshold=threshold)


def test_a_foreground_that_is_not_there(session):
    with refused(posespace.InvalidArgument, "INVALID_OPTION", "foreground", "alpha"):
        session.put_shape("stand", image=figure(**WALK["stand"]), foreground="bright")


def test_both_a_picture_and_a_polygon(session):
    with refused(posespace.InvalidArgument, "INVALID_OPTION", "star"):
        session.put_shape("star", image=figure(**WALK["stand"]), polygon=star())


def test_an_id_used_twice(session):
    session.put_shape("star", polygon=star(5))
    with refused(posespace.AlreadyExists, "SHAPE_EXISTS", "star"):
        session.put_shape("star", polygon=star(6))
    assert len(session.shape("star").outline[0]) == 10


def test_too_many_drawings(session):
    for k in range(64):
        session.put_shape(f"s{k}", polygon=star())
    with refused(posespace.InvalidArgument, "TOO_MANY_SHAPES", "64"):
        session.put_shape("s64", polygon=star())


@pytest.mark.parametrize("shape_id", ["", "a b", ".hidden", "x" * 64, "né", "a/b"])
def test_a_drawing_id_of_another_form(session, shape_id):
    with refused(posespace.InvalidArgument, "INVALID_ID", "63"):
        session.put_shape(shape_id, polygon=star())


def test_a_drawing_that_is_not_there(session):
    for call in (session.shape, session.delete_shape):
        with refused(posespace.NotFound, "SHAPE_NOT_FOUND", "nobody"):
            call("nobody")


# Marked places.


@pytest.fixture
def two_stars(session):
    session.put_shape("a", polygon=star())
    session.put_shape("b", polygon=star(turn=0.1))
    return session


def marks(*rows: tuple[int, int]):
    return [{"a": star()[i], "b": star(turn=0.1)[j]} for i, j in rows]


def test_landmarks_outside_the_drawing_are_all_named(two_stars):
    wrong = [{"a": (1000, 1000)}, *marks((0, 0)), {"b": (-500, 3)}]
    with refused(posespace.InvalidArgument, "LANDMARK_OFF_OUTLINE", "'a'") as refusal:
        two_stars.set_correspondences(wrong)
    fields = list(refusal.value.fields)
    assert any("tuples[0]" in field and "a" in field for field in fields), fields
    assert any("tuples[2]" in field and "b" in field for field in fields), fields
    assert not any("tuples[1]" in field for field in fields), fields


def test_landmarks_in_contradictory_order(two_stars):
    with refused(posespace.InvalidArgument, "LANDMARKS_OUT_OF_ORDER", "'a'", "'b'") as refusal:
        two_stars.set_correspondences(marks((0, 0), (2, 4), (4, 2), (6, 6)))
    assert refusal.value.fields


def test_a_landmark_that_is_not_finite(two_stars):
    with refused(posespace.InvalidArgument, "LANDMARK_NOT_FINITE", "'a'") as refusal:
        two_stars.set_correspondences([{"a": (NAN, 1), "b": (100, 10)}])
    assert any("tuples[0]" in field for field in refusal.value.fields)


def test_a_landmark_in_an_unknown_drawing(two_stars):
    with refused(posespace.NotFound, "SHAPE_NOT_FOUND", "nobody"):
        two_stars.set_correspondences([{"a": (100, 10), "nobody": (100, 10)}])


def test_too_many_landmarks(two_stars):
    with refused(posespace.InvalidArgument, "TOO_MANY_LANDMARKS", "257", "256"):
        two_stars.set_correspondences([{"a": (100, 10)}] * 257)


def test_refused_landmarks_leave_the_old_ones(two_stars):
    two_stars.set_correspondences(marks((0, 0)))
    with pytest.raises(posespace.InvalidArgument):
        two_stars.set_correspondences([{"a": (1000, 1000)}])
    assert len(two_stars.state().correspondences) == 1


def test_a_point_of_three_numbers(two_stars):
    with refused(posespace.InvalidArgument, "INVALID_OPTION", "'a'"):
        two_stars.set_correspondences([{"a": (1, 2, 3)}])


# Placements.


def test_coincident_placements(two_stars):
    with refused(posespace.InvalidArgument, "PLACEMENTS_COINCIDE", "'a'", "'b'"):
        two_stars.set_placements({"a": (0.5, 0.5), "b": (0.5, 0.5)})


@pytest.mark.parametrize("bad", [NAN, float("inf")])
def test_a_placement_that_is_not_finite(two_stars, bad):
    with refused(posespace.InvalidArgument, "PLACEMENT_NOT_FINITE", "'b'"):
        two_stars.set_placements({"a": (0, 0), "b": (0, bad)})


def test_a_placement_of_an_unknown_drawing(two_stars):
    with refused(posespace.NotFound, "SHAPE_NOT_FOUND", "nobody"):
        two_stars.set_placements({"a": (0, 0), "b": (0, 1), "nobody": (1, 1)})


# Building and blending.


def test_a_build_without_drawings(session):
    with refused(posespace.NotBuilt, "NO_SHAPES", session.id):
        session.build()


@pytest.mark.parametrize(
    "option",
    [
        {"tolerance": 0.0},
        {"tolerance": NAN},
        {"tolerance": 0.3},
        {"target_edge_length": 0.001},
        {"max_vertices": 2},
        {"max_vertices": 8001},
    ],
)
def test_build_options_out_of_range(two_stars, option):
    with refused(posespace.InvalidArgument, "INVALID_OPTION", *option):
        two_stars.build(**option)


def test_a_blend_before_a_build(two_stars):
    calls = [
        two_stars.mesh,
        two_stars.play,
        lambda: two_stars.blend(at=(0, 0)),
        lambda: two_stars.blend_many([(0, 0)]),
        lambda: two_stars.weights([(0, 0)]),
        lambda: two_stars.render(at=(0, 0)),
        lambda: two_stars.texture("a"),
    ]
    for call in calls:
        with refused(posespace.NotBuilt, "SESSION_NOT_BUILT", two_stars.id):
            call()


@pytest.mark.parametrize("at", [(NAN, 0), (0, float("inf"))])
def test_a_pose_that_is_not_finite(walk, at):
    for call in (walk.blend, walk.render):
        with refused(posespace.InvalidArgument, "POSE_NOT_FINITE"):
            call(at=at)
    with refused(posespace.InvalidArgument, "POSE_NOT_FINITE") as refusal:
        walk.blend_many([(0, 0), (0, 1), at])
    assert any("queries[2]" in field for field in refusal.value.fields)


@pytest.mark.parametrize(
    ("weights", "reason"),
    [
        ({"stand": NAN, "step": 1}, "WEIGHTS_NOT_FINITE"),
        ({"stand": float("inf"), "step": -float("inf")}, "WEIGHTS_NOT_FINITE"),
        ({"stand": 0.5, "step": 0.6}, "WEIGHTS_SUM_NOT_ONE"),
        ({}, "WEIGHTS_SUM_NOT_ONE"),
    ],
)
def test_weights_that_make_no_sense(walk, weights, reason):
    for call in (walk.blend, walk.render):
        with refused(posespace.InvalidArgument, reason):
            call(weights=weights)


def test_weights_of_an_unknown_drawing(walk):
    with refused(posespace.NotFound, "SHAPE_NOT_FOUND", "nobody", "stand"):
        walk.blend(weights={"nobody": 1.0})


@pytest.mark.parametrize(
    "option", [{"refits": 4}, {"refits": -1}, {"sigma": NAN}, {"sigma": 1.5}, {"sigma": -0.1}]
)
def test_blend_options_out_of_range(walk, option):
    with refused(posespace.InvalidArgument, "INVALID_OPTION", *option):
        walk.blend(at=(0, 0), **option)


def test_methods_that_are_not_there(walk):
    with refused(posespace.InvalidArgument, "INVALID_OPTION", "method", "'rigid'"):
        walk.blend(at=(0, 0), method="magic")
    with refused(posespace.InvalidArgument, "INVALID_OPTION", "shear_limit", "'band'"):
        walk.blend(at=(0, 0), shear_limit="magic")


def test_neither_or_both_of_place_and_weights(walk):
    for call in (walk.blend, walk.render):
        with refused(posespace.InvalidArgument, "INVALID_OPTION", "at=", "weights="):
            call()
        with refused(posespace.InvalidArgument, "INVALID_OPTION", "at=", "weights="):
            call(at=(0, 0), weights={"stand": 1})


@pytest.mark.parametrize("size", [(0, 10), (10, -1), (4097, 10)])
def test_a_render_size_out_of_range(walk, size):
    with refused(posespace.InvalidArgument, "INVALID_OPTION", "4096"):
        walk.render(at=(0, 0), size=size)


@pytest.mark.parametrize("view", [(0, 0, 0, 10), (0, 0, -5, 5), (NAN, 0, 5, 5)])
def test_a_view_that_shows_nothing(walk, view):
    with refused(posespace.InvalidArgument, "INVALID_OPTION", "view"):
        walk.render(at=(0, 0), view=view)


# Sessions.


def test_a_closed_client_says_so(server, walk):
    with posespace.connect(server.address) as client:
        session = client.session(walk.id)
    for call in (client.ping, session.play, lambda: session.render(at=(0, 0))):
        with refused(posespace.Unavailable, "", "closed"):
            call()


def test_an_unknown_session(client):
    with refused(posespace.NotFound, "SESSION_NOT_FOUND", "nobody"):
        client.session("nobody")


def test_every_call_on_a_deleted_session(client):
    session = make_walk(client)
    session.delete()
    calls = [
        session.state,
        session.shapes,
        session.mesh,
        session.build,
        session.cancel_build,
        session.delete,
        session.play,
        lambda: session.put_shape("star", polygon=star()),
        lambda: session.blend(at=(0, 0)),
        lambda: session.render(at=(0, 0)),
    ]
    for call in calls:
        with refused(posespace.NotFound, "SESSION_NOT_FOUND", session.id):
            call()


def test_a_session_id_used_twice(client):
    session = client.create_session("twin")
    with refused(posespace.AlreadyExists, "SESSION_EXISTS", "twin"):
        client.create_session("twin")
    session.delete()


@pytest.mark.parametrize("session_id", ["a b", "-", "x" * 64, "../etc"])
def test_a_session_id_of_another_form(client, session_id):
    with refused(posespace.InvalidArgument, "INVALID_ID", "63"):
        client.create_session(session_id)


def test_too_many_sessions_are_refused_with_a_time_to_retry():
    with (
        posespace.serve_locally(flags=["--max-sessions", "2"]) as server,
        posespace.connect(server.address, timeout=0.9) as client,
    ):
        client.create_session()
        client.create_session()
        with refused(posespace.ResourceExhausted, "SESSION_LIMIT", "2") as refusal:
            client.create_session()
        assert refusal.value.retry_after > 0


def test_a_session_that_finds_no_place_gets_one_when_another_goes():
    with (
        posespace.serve_locally(flags=["--max-sessions", "1"]) as server,
        posespace.connect(server.address, timeout=10.0) as client,
    ):
        first = client.create_session()
        threading.Timer(0.2, first.delete).start()
        second = client.create_session()
        assert [session.id for session in client.sessions()] == [second.id]


@pytest.mark.parametrize(
    ("words", "call"),
    [
        ("session_id is", lambda client, walk: client.create_session("\ud800")),
        ("session_id is", lambda client, walk: client.session("\ud800")),
        ("session_id is", lambda client, walk: client.create_session(7)),
        ("labels is", lambda client, walk: client.create_session(labels={"a": "\ud800"})),
        ("shape_id is", lambda client, walk: walk.put_shape("\ud800", polygon=star())),
        ("shape_id is", lambda client, walk: walk.shape("\ud800")),
        ("shape_id is", lambda client, walk: walk.texture_png("\ud800")),
        ("image is", lambda client, walk: walk.put_shape("new", image="a\0b")),
        ("threshold is", lambda client, walk: walk.put_shape("new", image=b"", threshold=2**40)),
        ("polygon is", lambda client, walk: walk.put_shape("new", polygon="abc")),
        ("a hole is", lambda client, walk: walk.put_shape("new", polygon=star(), holes=["abc"])),
        ("placements is", lambda client, walk: walk.set_placements({"\ud800": (0, 0)})),
        (
            "the placement of shape 'stand' is",
            lambda client, walk: walk.set_placements({"stand": 7}),
        ),
        ("placements is", lambda client, walk: walk.set_placements(7)),
        (
            "the mark in shape 'stand' is",
            lambda client, walk: walk.set_correspondences([{"stand": ("a", "b")}]),
        ),
        ("tuples is", lambda client, walk: walk.set_correspondences([{"\ud800": (0, 0)}])),
        ("tuples is", lambda client, walk: walk.set_correspondences([7])),
        ("tolerance is", lambda client, walk: walk.start_build(tolerance="fine")),
        ("at is", lambda client, walk: walk.blend(at=("a", "b"))),
        ("at is", lambda client, walk: walk.blend(at=7)),
        ("weights is", lambda client, walk: walk.blend(weights={"stand": "all"})),
        ("refits is", lambda client, walk: walk.blend(at=(0, 0), refits=1.5)),
        ("sigma is", lambda client, walk: walk.blend(at=(0, 0), sigma="sharp")),
        ("points is", lambda client, walk: walk.blend_many([(0, 0), (1,)])),
        ("size is", lambda client, walk: walk.render(at=(0, 0), size=(2**40, 1))),
        ("size is", lambda client, walk: walk.render(at=(0, 0), size=(1.5, 2))),
        ("size is", lambda client, walk: walk.render(at=(0, 0), size=7)),
        ("view is", lambda client, walk: walk.render(at=(0, 0), view=(1, 2, 3))),
    ],
)
def test_values_that_no_message_can_carry_are_refused_by_name(client, walk, words, call):
    with refused(posespace.InvalidArgument, "INVALID_OPTION", words):
        call(client, walk)


def test_a_refused_picture_is_named_by_its_path(session):
    with refused(posespace.InvalidDrawing, "IMAGE_UNDECODABLE") as refusal:
        session.put_shape("jump", image=b"no picture")
    assert list(refusal.value.fields) == ["image.data"]


@pytest.mark.parametrize(
    ("fields", "call"),
    [
        (["image.data"], lambda s: s.put_shape("c", image=b"GIF89a")),
        (["image.data"], lambda s: s.put_shape("c", image=b"")),
        (["image.data"], lambda s: s.put_shape("c", image=np.zeros((9, 9, 4), np.uint8))),
        (["image.threshold"], lambda s: s.put_shape("c", image=png_of(CARD), threshold=0)),
        (
            ["image.threshold"],
            lambda s: s.put_shape("c", image=png_of(CARD), foreground="dark", threshold=256),
        ),
        (["polygon.outer"], lambda s: s.put_shape("c", polygon=[(0, 0), (1, 1)])),
        (["polygon.outer[1]"], lambda s: s.put_shape("c", polygon=[(0, 0), (NAN, 1), (2, 0)])),
        (
            ["polygon.holes[0][2]"],
            lambda s: s.put_shape("c", polygon=star(), holes=[[(0, 0), (1, 1), (1e9, 0)]]),
        ),
        (["polygon.texture"], lambda s: s.put_shape("c", polygon=star(), texture=b"GIF89a")),
        (["shape_id"], lambda s: s.put_shape("a", polygon=star(7))),
        (
            ["tuples[0].points['b']", "tuples[1].points['a']"],
            lambda s: s.set_correspondences([{"b": (9e3, 0)}, {"a": (9e3, 0)}]),
        ),
        (["tuples[0].points['a']"], lambda s: s.set_correspondences([{"a": (NAN, 0)}])),
        (["tuples[0].points['no']"], lambda s: s.set_correspondences([{"no": (1, 0)}])),
        (["tuples[0]"], lambda s: s.set_correspondences([{}])),
        (["placements['b'].at"], lambda s: s.set_placements({"a": (0, 0), "b": (0, NAN)})),
        (["placements['b'].at"], lambda s: s.set_placements({"a": (0, 0), "b": (0, 0)})),
        (["placements['b']"], lambda s: s.set_placements({"a": (0, 0)})),
        (["placements['no']"], lambda s: s.set_placements({"no": (0, 0)})),
        (["options.tolerance"], lambda s: s.build(tolerance=0.3)),
        (["options.target_edge_length"], lambda s: s.build(target_edge_length=0.0)),
        (["options.max_vertices"], lambda s: s.build(max_vertices=0)),
    ],
)
def test_a_field_at_fault_is_named_by_its_path_in_the_request(two_stars, fields, call):
    with pytest.raises(posespace.Error) as refusal:
        call(two_stars)
    assert list(refusal.value.fields) == fields, str(refusal.value)


@pytest.mark.parametrize(
    ("field", "call"),
    [
        ("queries[0].at", lambda s: s.blend(at=(NAN, 0))),
        ("queries[2].at", lambda s: s.blend_many([(0, 0), (0, 1), (NAN, 0)])),
        ("queries[0].weights", lambda s: s.blend(weights={"stand": 0.5})),
        ("queries[0].options.refits", lambda s: s.blend(at=(0, 0), refits=9)),
        ("width", lambda s: s.render(at=(0, 0), size=(0, 10))),
        ("view", lambda s: s.render(at=(0, 0), view=(0, 0, 0, 10))),
    ],
)
def test_a_query_at_fault_is_named_by_its_path_in_the_request(walk, field, call):
    with pytest.raises(posespace.Error) as refusal:
        call(walk)
    assert list(refusal.value.fields) == [field], str(refusal.value)


def test_the_tree_has_one_root():
    kinds = [
        posespace.InvalidDrawing, posespace.InvalidArgument, posespace.NotFound,
        posespace.AlreadyExists, posespace.NotBuilt, posespace.Conflict,
        posespace.ResourceExhausted, posespace.Unavailable, posespace.DeadlineExceeded,
        posespace.Cancelled, posespace.Unauthenticated, posespace.PermissionDenied,
        posespace.InternalError,
    ]  # fmt: skip
    for kind in kinds:
        error = kind("words", reason="REASON")
        assert isinstance(error, posespace.Error)
        assert (str(error), error.reason, error.fields, error.retry_after) == (
            "words",
            "REASON",
            {},
            None,
        )
