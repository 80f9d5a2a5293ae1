# SPDX-License-Identifier: Apache-2.0
"""From drawings to pictures, as a user goes."""

from __future__ import annotations

import math

import numpy as np
import posespace
import pytest
from synthetic_drawings import WALK, figure, png_of, star
from walk_session import make_walk

STAND = figure(**WALK["stand"])


def test_a_picture_is_taken_as_path_bytes_and_array_alike(session, tmp_path):
    path = tmp_path / "stand.png"
    path.write_bytes(png_of(STAND))
    shapes = [
        session.put_shape("path", image=path),
        session.put_shape("name", image=str(path)),
        session.put_shape("bytes", image=path.read_bytes()),
        session.put_shape("array", image=STAND),
    ]
    for shape in shapes:
        assert shape.size == (200, 260)
        assert np.array_equal(shape.outline[0], shapes[0].outline[0])


def test_an_array_without_alpha_is_a_drawing_to_its_edges(session):
    shape = session.put_shape("card", image=np.full((40, 60, 3), 90, np.uint8))
    assert np.allclose(shape.outline[0].min(axis=0), [0, 0], atol=3)
    assert np.allclose(shape.outline[0].max(axis=0), [60, 40], atol=3)


def test_the_threshold_decides_what_is_painted(session):
    pixels = np.zeros((60, 80, 4), np.uint8)
    pixels[10:50, 10:40, 3] = 255
    pixels[10:50, 40:70, 3] = 100
    strict = session.put_shape("strict", image=pixels)
    lenient = session.put_shape("lenient", image=pixels, threshold=50)
    assert np.ptp(strict.outline[0][:, 0]) < 40
    assert np.ptp(lenient.outline[0][:, 0]) > 55


def test_polygons_keep_their_corners_and_report_filled_holes(session):
    hole = 100 + np.array([[-8, -8], [8, -8], [8, 8], [-8, 8]])
    shape = session.put_shape("star", polygon=star(), holes=[hole])
    assert shape.holes_filled == 1
    assert {tuple(p) for p in np.round(shape.outline[0], 6)} >= {
        tuple(p) for p in np.round(star(), 6)
    }


def test_a_polygon_takes_its_pixels_from_a_texture(session):
    paint = np.zeros((200, 200, 4), np.uint8)
    paint[:] = (255, 0, 0, 255)
    session.put_shape("star", polygon=star(), texture=paint)
    session.build()
    pixels = session.render(weights={"star": 1}, size=(200, 200), view=(0, 0, 200, 200))
    assert (pixels[100, 100] == (255, 0, 0, 255)).all()


def test_drawings_are_listed_in_the_order_of_upload_and_can_be_removed(session):
    for name in ("c", "a", "b"):
        session.put_shape(name, polygon=star())
    assert session.shape_ids == ["c", "a", "b"]
    session.delete_shape("a")
    assert [shape.id for shape in session.shapes()] == ["c", "b"]
    assert session.shape("b").size == session.shapes()[1].size


def test_the_same_drawing_again_is_no_error_and_replace_overwrites(session):
    first = session.put_shape("star", polygon=star(5))
    assert np.array_equal(session.put_shape("star", polygon=star(5)).outline[0], first.outline[0])
    replaced = session.put_shape("star", polygon=star(7), replace=True)
    assert len(replaced.outline[0]) == 14
    assert session.shape_ids == ["star"]


def test_default_placements_lie_on_the_unit_circle(session):
    for name in ("a", "b", "c", "d"):
        session.put_shape(name, polygon=star())
    state = session.state()
    assert state.placements_are_default
    at = [state.placements[name] for name in "abcd"]
    assert np.allclose(at, [(1, 0), (0, 1), (-1, 0), (0, -1)], atol=1e-12)


def test_build_reports_what_it_made_and_progress_never_falls(client, session):
    for name, pose in WALK.items():
        session.put_shape(name, image=figure(**pose))
    seen = []
    report = session.build(on_progress=lambda stage, fraction: seen.append((stage, fraction)))
    mesh = session.mesh()
    fractions = [fraction for _, fraction in seen]
    assert fractions == sorted(fractions) and fractions[-1] == 1.0
    assert {stage for stage, _ in seen} >= {"matching", "triangulation", "weights"}
    assert report.revision == mesh.revision == session.state().revision
    assert report.triangles == len(mesh.triangles)
    assert all(points.shape == (report.vertices, 2) for points in mesh.vertices.values())
    assert 0 < report.min_angle < math.pi / 3
    assert set(report.confidence) == set(WALK)
    assert session.state().build.state == "succeeded"


def test_building_the_same_again_gives_the_same_revision(client, walk):
    assert walk.build().revision == walk.state().revision
    twin = make_walk(client)
    assert twin.state().revision == walk.state().revision
    assert np.array_equal(twin.blend(at=(0.3, 0.3)).vertices, walk.blend(at=(0.3, 0.3)).vertices)
    twin.delete()


def test_a_finer_mesh_is_built_on_request(session):
    session.put_shape("star", polygon=star())
    coarse = session.build(target_edge_length=0.2)
    fine = session.build(target_edge_length=0.05)
    assert fine.triangles > 4 * coarse.triangles
    assert fine.revision != coarse.revision


def test_a_mesh_keeps_to_its_budget_of_vertices_or_is_refused(session):
    session.put_shape("star", polygon=star())
    free = session.build(target_edge_length=0.05)
    for budget in (free.vertices // 2, free.outline_vertices):
        assert session.build(target_edge_length=0.05, max_vertices=budget).vertices <= budget
    with pytest.raises(posespace.InvalidArgument, match="tolerance") as refusal:
        session.build(max_vertices=free.outline_vertices - 1)
    assert refusal.value.reason == "MESH_TOO_LARGE"


def test_the_report_says_what_each_level_of_the_triangulation_did(session):
    session.put_shape("one", polygon=[(0, 0), (40, 0), (40, 40), (30, 10)])
    report = session.build()
    assert report.levels == {"zero_steiner": 1}
    assert report.steiner_by_level == {"zero_steiner": 0}


def test_alignment_is_on_unless_switched_off_and_reports_its_gain(session):
    for name, pose in WALK.items():
        session.put_shape(name, image=figure(**pose))
    aligned = session.build()
    assert set(aligned.ghost_losses) == set(WALK)
    assert 0 <= aligned.ghost_loss.after <= aligned.ghost_loss.before < 1
    unaligned = session.build(align=False)
    assert unaligned.ghost_loss is None and unaligned.ghost_losses == {}
    assert unaligned.revision != aligned.revision
    assert session.build(align=True).revision == aligned.revision


def test_marked_places_become_vertices_of_the_mesh(session):
    marks = []
    for name, turn in (("a", 0.0), ("b", 0.25), ("c", -0.2)):
        session.put_shape(name, polygon=star(turn=turn))
    marks = [
        {n: star(turn=t)[row] for n, t in (("a", 0.0), ("b", 0.25), ("c", -0.2))} for row in (0, 4)
    ]
    state = session.set_correspondences(marks)
    assert len(state.correspondences) == 2
    session.build()
    mesh = session.mesh()
    for tuple_, vertex in zip(marks, mesh.landmarks, strict=True):
        for name, at in tuple_.items():
            assert np.allclose(mesh.vertices[name][vertex], at, atol=2.0)


def test_new_placements_keep_the_mesh_and_change_the_weights(client):
    session = make_walk(client)
    before = session.mesh()
    session.set_placements({"stand": (5, 5), "step": (6, 5), "wave": (5, 6)})
    after = session.mesh()
    assert after.revision != before.revision
    assert np.array_equal(after.triangles, before.triangles)
    assert np.allclose(session.weights([(6, 5)]), [[0, 1, 0]], atol=1e-6)
    assert session.blend(at=(6, 5)).revision == after.revision
    session.delete()


def test_frames_name_their_drawings(walk):
    frame = walk.blend(at=(0.2, 0.4))
    assert list(frame.weights) == walk.shape_ids
    assert sum(frame.weights.values()) == pytest.approx(1, abs=1e-9)
    assert sum(frame.texture_weights.values()) == pytest.approx(1, abs=1e-9)
    assert frame.vertices.dtype == np.float32
    assert frame.revision == walk.state().revision


def test_stretch_is_mixed_as_asked(walk):
    place = (0.3, 0.3)
    plain = walk.blend(at=place).vertices
    assert np.array_equal(walk.blend(at=place, stretch="linear").vertices, plain)
    for stretch in ("log", "metric"):
        other = walk.blend(at=place, stretch=stretch).vertices
        assert 0 < np.abs(other - plain).max() < 20
    with pytest.raises(posespace.InvalidArgument, match="stretch"):
        walk.blend(at=place, stretch="cubic")


def test_repair_mends_what_folds_and_says_so(walk):
    good = walk.blend(at=(0.3, 0.3))
    same = walk.blend(at=(0.3, 0.3), repair=True)
    assert good.folds == same.folds == same.mended == 0
    assert np.array_equal(good.vertices, same.vertices)
    far = {"stand": -9.0, "step": 5.0, "wave": 5.0}
    folded = walk.blend(weights=far)
    mended = walk.blend(weights=far, repair=True)
    assert folded.folds > 0 and folded.mended == 0
    assert mended.folds == 0 and mended.mended == folded.folds


def test_an_anchor_stays_at_the_mean_of_its_places(walk):
    mesh = walk.mesh()
    foot = mesh.vertices["stand"][np.argmax(mesh.vertices["stand"][:, 1])]
    inside = 0.98 * foot + 0.02 * mesh.vertices["stand"].mean(axis=0)
    anchor = mesh.point("stand", inside)
    corners, shares = mesh.triangles[anchor.triangle], (1 - anchor.b - anchor.c, anchor.b, anchor.c)

    def place(vertices):
        return shares @ vertices[corners].astype(float)

    assert np.allclose(place(mesh.vertices["stand"]), inside)
    free = walk.blend(at=(0.3, 0.4))
    wanted = sum(free.weights[name] * place(mesh.vertices[name]) for name in mesh.shape_ids)
    held = walk.blend(at=(0.3, 0.4), anchor=anchor)
    assert np.abs(place(held.vertices) - wanted).max() < 1e-3
    assert np.abs(place(free.vertices) - wanted).max() > 0.05
    assert np.ptp(held.vertices - free.vertices, axis=0).max() < 1e-3  # moved as a whole
    assert np.array_equal(walk.blend_many([(0.3, 0.4)], anchor=anchor)[0], held.vertices)
    with walk.play() as player:
        (played,) = player.frames([(0.3, 0.4)], anchor=anchor)
    assert np.array_equal(played.vertices, held.vertices)


def test_an_anchor_outside_the_mesh_is_refused(walk):
    mesh = walk.mesh()
    with pytest.raises(posespace.InvalidArgument, match=r"'stand' has nothing at \(-50"):
        mesh.point("stand", (-50.0, 10.0))
    with pytest.raises(posespace.NotFound, match="nobody"):
        mesh.point("nobody", (0.0, 0.0))
    last = len(mesh.triangles) - 1
    walk.blend(at=(0, 0), anchor=posespace.MeshPoint(last, 0.2, 0.2))
    with pytest.raises(posespace.InvalidArgument, match=f"has 0 to {last}"):
        walk.blend(at=(0, 0), anchor=posespace.MeshPoint(last + 1, 0.2, 0.2))
    with pytest.raises(posespace.InvalidArgument, match="anchor"):
        walk.blend(at=(0, 0), anchor=posespace.MeshPoint(0, 0.6, 0.5))


def test_blend_many_is_blend_many_times(walk):
    points = np.random.default_rng(5).uniform(-1, 2, (600, 2))  # more than one message holds
    many = walk.blend_many(points)
    assert many.dtype == np.float32 and len(many) == 600
    for k in (0, 255, 256, 511, 512, 599):
        assert np.array_equal(many[k], walk.blend(at=points[k]).vertices)
    assert np.array_equal(many[:5], walk.blend_many(points.tolist()[:5]))


def test_blend_many_of_nothing_is_empty(walk):
    assert walk.blend_many([]).shape == (0, walk.mesh().report.vertices, 2)
    assert walk.weights([]).shape == (0, 3)


def test_many_blends_stay_with_one_revision_while_placements_change(server, client):
    session, other = make_walk(client, "moving"), posespace.connect(server.address)
    points = np.tile([0.4, 0.3], (300, 1))
    session.blend_many(points)  # the session now knows a revision that is about to be outdated
    other.session("moving").set_placements({"stand": (0, 0), "step": (2, 0), "wave": (0, 2)})
    frames = session.blend_many(points)
    assert (frames == frames[0]).all()
    assert np.array_equal(frames[0], session.blend(at=(0.4, 0.3)).vertices)
    session.delete()
    other.close()


def test_weights_left_out_are_zero(walk):
    frame = walk.blend(weights={"step": 1.0})
    assert frame.weights == {"stand": 0, "step": 1, "wave": 0}
    assert np.allclose(frame.vertices, walk.mesh().vertices["step"], atol=1e-2)


def test_a_render_is_opaque_inside_clear_outside_and_straight_at_the_edge(walk):
    pixels = walk.render(at=(0.3, 0.3), size=(320, 240))
    assert pixels.shape == (240, 320, 4) and pixels.dtype == np.uint8
    alpha = pixels[..., 3]
    assert alpha[0].max() == alpha[-1].max() == alpha[:, 0].max() == 0
    assert (alpha == 255).sum() > 5000
    edge = (alpha > 40) & (alpha < 215)
    assert edge.any()
    assert pixels[..., :3][edge].max(axis=1).mean() > 100, "colours at the edge are darkened"


def test_crisp_edges_leave_fewer_faint_pixels_than_soft_ones(walk):
    at_pose = {"stand": 1.0}
    assert (walk.render(weights=at_pose) == walk.render(weights=at_pose, edges="soft")).all()

    def faint(edges):
        alpha = walk.render(at=(0.3, 0.3), edges=edges)[..., 3]
        return ((alpha > 5) & (alpha < 250)).sum()

    assert faint("crisp") < 0.9 * faint("soft")
    with pytest.raises(posespace.InvalidArgument, match="edges"):
        walk.render(at=(0.3, 0.3), edges="jagged")


def test_a_view_shows_its_part_of_the_drawing(walk):
    whole = walk.render(weights={"stand": 1}, size=(200, 260), view=(0, 0, 200, 260))
    head = walk.render(weights={"stand": 1}, size=(80, 80), view=(60, 10, 80, 80))
    assert np.abs(whole[10:90, 60:140].astype(int) - head).mean() < 2


def test_a_texture_has_the_drawings_pixels(walk):
    mesh = walk.mesh()
    place, pixels = mesh.textures["stand"], walk.texture("stand")
    assert pixels.shape == (place.height, place.width, 4)
    assert walk.texture_png("stand").startswith(b"\x89PNG")
    torso = ((100, 130) - np.array(place.origin)) * place.scale
    assert (pixels[int(torso[1]), int(torso[0])] == STAND[130, 100]).all()


def test_sessions_are_listed_by_id_and_carry_notes(client):
    made = client.create_session("zoe", display_name="Zoë", labels={"team": "art"})
    assert "zoe" in [session.id for session in client.sessions()]
    state = client.session("zoe").state()
    assert (state.display_name, state.labels) == ("Zoë", {"team": "art"})
    assert abs((state.update_time - state.create_time).total_seconds()) < 60
    made.delete()
    assert "zoe" not in [session.id for session in client.sessions()]


def test_more_sessions_than_a_page_are_all_listed(client):
    made = [client.create_session() for _ in range(120)]
    assert {s.id for s in made} <= {s.id for s in client.sessions()}
    for session in made:
        session.delete()


def test_two_clients_see_one_session(server, client, session):
    with posespace.connect(server.address) as other:
        mine, theirs = session, other.session(session.id)
        mine.put_shape("a", polygon=star(5))
        theirs.put_shape("b", polygon=star(5, 0.1))
        assert mine.shape_ids == theirs.shape_ids == ["a", "b"]
        theirs.build()
        assert np.array_equal(mine.blend(at=(0, 0)).vertices, theirs.blend(at=(0, 0)).vertices)


def test_an_etag_guards_against_overwriting_others(session):
    session.put_shape("a", polygon=star())
    seen = session.state().etag
    session.put_shape("b", polygon=star())
    with pytest.raises(posespace.Conflict) as refusal:
        session.set_placements({"a": (0, 0), "b": (1, 0)}, etag=seen)
    assert refusal.value.reason == "ETAG_MISMATCH"
    session.set_placements({"a": (0, 0), "b": (1, 0)}, etag=session.state().etag)


def test_one_drawing_alone_is_itself_everywhere(session):
    session.put_shape("only", polygon=star())
    session.build()
    points = session.mesh().vertices["only"]
    for at in ((0, 0), (17, -4)):
        assert np.allclose(session.blend(at=at).vertices, points, atol=1e-3)


def test_an_arrangement_of_placements_on_one_line_works(session):
    for k in range(3):
        session.put_shape(f"s{k}", polygon=star(turn=0.1 * k))
    session.set_placements({f"s{k}": (k, 2 * k) for k in range(3)})
    session.build()
    assert np.allclose(session.weights([(0, 0), (1, 2), (2, 4)]), np.eye(3), atol=1e-6)


def test_weights_keep_their_names_when_drawings_come_and_go(session):
    for k, name in enumerate("abc"):
        session.put_shape(name, polygon=star(turn=0.1 * k))
    session.build()
    session.blend(weights={"a": 1.0})
    session.delete_shape("a")
    session.put_shape("d", polygon=star(turn=0.3))
    old = session.blend(weights={"a": 1.0})  # the built pose space stays until the next build
    assert list(old.weights) == ["a", "b", "c"]
    session.build()
    frame = session.blend(weights={"c": 0.25, "d": 0.75})
    assert frame.weights == {"b": 0, "c": 0.25, "d": 0.75}
    assert session.weights([(5, 5)]).shape == (1, 3)
    with pytest.raises(posespace.NotFound):
        session.blend(weights={"a": 1.0})


def test_renders_at_weights_follow_a_rebuild_from_other_drawings(session):
    for name, paint in (("red", (255, 0, 0, 255)), ("green", (0, 255, 0, 255))):
        session.put_shape(name, image=np.full((60, 60, 4), paint, np.uint8))
    session.build()
    session.blend(weights={"red": 1.0})
    session.delete_shape("red")
    session.put_shape("blue", image=np.full((60, 60, 4), (0, 0, 255, 255), np.uint8))
    session.build()
    assert (session.render(weights={"green": 1.0})[256, 256] == (0, 255, 0, 255)).all()
    session.delete_shape("green")
    session.build()
    assert (session.render(weights={"blue": 1.0})[256, 256] == (0, 0, 255, 255)).all()
