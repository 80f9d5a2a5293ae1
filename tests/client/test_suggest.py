# SPDX-License-Identifier: Apache-2.0
"""What matching would do, before anything is built."""

from __future__ import annotations

import numpy as np
import posespace
import pytest
from synthetic_drawings import WALK, figure, star, wavy_blob

# One arm up: seen in a mirror it is another drawing.
WAVES = {
    "a": {"left_arm": -35, "right_arm": 115, "left_leg": -12, "right_leg": 24},
    "b": {"left_arm": -40, "right_arm": 120, "left_leg": -15, "right_leg": 20},
    "c": {"left_arm": -45, "right_arm": 125, "left_leg": -10, "right_leg": 28},
}


def put_waves(session, mirrored=()):
    for name, pose in WAVES.items():
        pixels = figure(**pose)
        session.put_shape(name, image=pixels[:, ::-1] if name in mirrored else pixels)


def test_it_shows_the_same_places_on_every_drawing(session):
    for name in ("step", "wave", "stand"):
        session.put_shape(name, image=figure(**WALK[name]))
    found = session.suggest()
    assert list(found.arcs) == ["step", "wave", "stand"]
    for name, arc in found.arcs.items():
        assert arc.shape == (64, 2)
        assert tuple(arc[0]) == found.starts[name]
        assert 0 < found.confidence[name] <= 1
    # The figure's left foot is the outline's lowest place left of the middle, in every drawing.
    feet = {
        name: max(range(64), key=lambda k: (arc[k, 0] < 90) * arc[k, 1])
        for name, arc in found.arcs.items()
    }
    assert np.ptp(list(feet.values())) <= 2
    assert found.etag == session.state().etag


def test_it_changes_nothing(session):
    put_waves(session, mirrored="b")
    before = session.state()
    session.suggest()
    after = session.state()
    assert after.etag == before.etag and after.build is None
    assert session.shape("b").warnings == []


def test_it_proposes_to_flip_a_drawing_that_faces_the_other_way(session):
    put_waves(session, mirrored="b")
    found = session.suggest()
    assert found.flips == ["b"]
    assert found.flip_gain > 1.05
    report = session.build()
    assert any("'b' seems to face the other way" in warning for warning in report.warnings)


def test_a_build_says_nothing_of_flips_when_all_face_alike(session):
    put_waves(session)
    found = session.suggest()
    assert found.flips == [] and found.flip_gain == 1
    assert not any("the other way" in warning for warning in session.build().warnings)


def test_marks_decide_what_it_shows(session):
    for name in ("a", "b"):
        session.put_shape(name, polygon=star())
    ring = session.shape("a").outline[0]
    tip, next_tip = ring[0], ring[2]
    session.set_correspondences([{"a": tip, "b": next_tip}])
    found = session.suggest(samples=1000)
    at = np.linalg.norm(found.arcs["a"] - tip, axis=1).argmin()
    assert np.linalg.norm(found.arcs["b"][at] - next_tip) < 2


@pytest.mark.parametrize("samples", [1, 1024])
def test_it_samples_as_finely_as_asked(session, samples):
    session.put_shape("star", polygon=star())
    assert session.suggest(samples=samples).arcs["star"].shape == (samples, 2)


@pytest.mark.parametrize("samples", [0, -1, 1025])
def test_it_refuses_other_numbers_of_samples(session, samples):
    session.put_shape("star", polygon=star())
    with pytest.raises(posespace.InvalidArgument, match="samples"):
        session.suggest(samples=samples)


def test_it_needs_a_drawing(session):
    with pytest.raises(posespace.NotBuilt) as refused:
        session.suggest()
    assert refused.value.reason == "NO_SHAPES"


def test_it_is_stopped_with_the_caller(session):
    for k in range(24):
        session.put_shape(f"s{k}", polygon=wavy_blob(5 + k, 0.2))
    with pytest.raises(posespace.DeadlineExceeded):
        session.suggest(timeout=0.05)
    session.delete()


def test_an_accepted_flip_is_kept_and_settles_the_matter(session):
    put_waves(session, mirrored="b")
    backwards = figure(**WAVES["b"])[:, ::-1]
    shape = session.put_shape("b", image=backwards, flip=True, replace=True)
    assert shape.flipped and session.shape("b").flipped and not session.shape("a").flipped
    found = session.suggest()
    assert found.flips == []
    assert not any("the other way" in warning for warning in session.build().warnings)
    straight = figure(**WAVES["b"])
    assert np.array_equal(session.texture("b")[..., 3] > 0, straight[..., 3] > 0)


def test_marks_move_with_a_drawing_that_is_flipped(session):
    session.put_shape("a", polygon=star())
    session.put_shape("b", polygon=star())
    x, y = session.shape("b").outline[0][3]
    session.set_correspondences([{"b": (x, y)}])
    session.put_shape("b", polygon=star(), flip=True, replace=True)
    ring = star()
    middle = (ring[:, 0].min() + ring[:, 0].max()) / 2
    (moved,) = session.state().correspondences
    assert moved["b"] == pytest.approx((2 * middle - x, y))
    session.build()


def lopsided(turn: float) -> np.ndarray:
    """A ring without any symmetry, turned by so many radians."""
    angle = np.linspace(0, 2 * np.pi, 120, endpoint=False)
    radius = 60 + 22 * np.sin(2 * angle) + 15 * np.sin(3 * angle + 1)
    return 100 + np.stack([radius * np.cos(angle + turn), radius * np.sin(angle + turn)], axis=1)


def test_drawings_that_may_be_turned_at_will_are_matched_by_their_shapes_alone(session):
    turn = 2.9
    session.put_shape("a", polygon=lopsided(0))
    session.put_shape("b", polygon=lopsided(turn))
    found = session.suggest(rotation="any")
    back = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    assert np.abs((found.arcs["b"] - 100) @ back - (found.arcs["a"] - 100)).max() < 3
    report = session.build(rotation="any")
    assert report.confidence["b"] > 0.5
    assert session.build().revision != report.revision


def test_an_unknown_rotation_is_refused(session):
    session.put_shape("a", polygon=star())
    with pytest.raises(posespace.InvalidArgument, match="rotation"):
        session.suggest(rotation="sideways")


def test_the_order_of_upload_changes_nothing_but_labels(client, session):
    other = client.create_session()
    for target, names in ((session, "abc"), (other, "cab")):
        for name in names:
            target.put_shape(name, image=figure(**WAVES[name]))
    one, two = session.suggest(), other.suggest()
    assert one.confidence == two.confidence and one.starts == two.starts
    assert one.flips == two.flips and one.flip_gain == two.flip_gain
    for name in "abc":
        assert np.array_equal(one.arcs[name], two.arcs[name])
    other.delete()


def test_a_mark_of_one_drawing_is_taken_and_the_build_says_that_it_ties_nothing(session):
    for name in "ab":
        session.put_shape(name, polygon=star())
    place = tuple(star()[0])
    session.set_correspondences([{"a": place, "b": place}, {"b": tuple(star()[4])}])
    (warning,) = [w for w in session.build().warnings if "tuple" in w]
    assert warning.startswith("tuple 1 marks only shape 'b'")


def spiked(x: float) -> np.ndarray:
    """A block with a long spike at x."""
    return np.array(
        [(0, 0), (100, 0), (100, 40), (x + 5, 40), (x, 140), (x - 5, 40), (0, 40)], dtype=float
    )


def test_marks_that_leave_much_without_counterpart_are_named(session):
    session.put_shape("left", polygon=spiked(15))
    session.put_shape("right", polygon=spiked(85))
    marks = [(10, 40), (20, 40), (80, 40), (90, 40)]
    session.set_correspondences([{"left": mark, "right": mark} for mark in marks])
    (warning,) = [w for w in session.build().warnings if "tuples" in w]
    assert "'left' and 'right'" in warning
    assert "tuples 0 and 1" in warning or "tuples 2 and 3" in warning
