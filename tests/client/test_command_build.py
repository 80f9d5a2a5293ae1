# SPDX-License-Identifier: Apache-2.0
"""posespace build: drawings in, mesh.json, report.json and a contact sheet out."""

from __future__ import annotations

import json
import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from command_line import answer, refusal, run, walk_files
from exact_mesh_checks import assert_valid_in_every_drawing
from PIL import Image
from synthetic_drawings import WALK, figure, png_of, star

ROOT = Path(__file__).resolve().parents[2]
MAPS = {
    "report.levels",
    "report.steiner_by_level",
    "report.seconds",
    "report.confidence",
    "report.ghost_loss",
    "report.ghost_losses",
    "labels",
}  # by names


@pytest.fixture(scope="module")
def built(server, client, tmp_path_factory):
    """What one build answered, and the folder it wrote."""
    folder = tmp_path_factory.mktemp("drawings")
    said = answer(
        "--server", server.address, "build", *walk_files(folder), "--session", "walk-by-command",
        "--place", "stand=0,0", "--place", "step=1,0.2", "--place", "wave=0.4,1",
        "--out", folder / "out",
    )  # fmt: skip
    yield SimpleNamespace(said=said, out=folder / "out", folder=folder)
    client.session("walk-by-command").delete()


@pytest.fixture(scope="module")
def mesh(built):
    return json.loads((built.out / "mesh.json").read_text())


def test_build_answers_its_report_and_where_its_files_are(built):
    said = built.said
    assert said["session"] == "walk-by-command" and said["rebuilt"]
    assert {shape["id"]: shape["placement"] for shape in said["shapes"]} == {
        "stand": [0, 0],
        "step": [1, 0.2],
        "wave": [0.4, 1],
    }
    assert said["files"] == {
        "mesh": str(built.out / "mesh.json"),
        "report": str(built.out / "report.json"),
        "contact_sheet": str(built.out / "contact-sheet.png"),
    }
    report = json.loads((built.out / "report.json").read_text())
    assert report["format"] == "posespace-report/1"
    assert report == {key: said[key] for key in report}
    assert sorted(path.name for path in built.out.iterdir()) == [
        "contact-sheet.png",
        "mesh.json",
        "report.json",
    ]


def fields_of(value, path=""):
    """Paths of a document's fields as docs/mesh.md writes them."""
    if isinstance(value, dict) and path not in MAPS:
        for name, inner in value.items():
            field = f"{path}.{name}" if path else name
            yield field
            yield from fields_of(inner, field)
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        yield from {field: None for item in value for field in fields_of(item, path + "[]")}


def described_in(page):
    """The first column of a page's table."""
    return re.findall(r"^\| `([^`]+)` \|", page, re.MULTILINE)


def test_mesh_json_has_the_fields_that_its_page_describes(mesh):
    page = (ROOT / "docs" / "mesh.md").read_text()
    assert list(fields_of(mesh)) == described_in(page)
    assert f'`"{mesh["format"]}"`' in page


def test_report_json_has_the_fields_that_its_page_describes(built):
    page = (ROOT / "docs" / "command.md").read_text().partition("## report.json")[2]
    report = json.loads((built.out / "report.json").read_text())
    fields = [field for field in fields_of(report) if not field.startswith("report.")]
    assert fields == described_in(page)


def test_the_code_on_the_page_of_mesh_json_runs(built, mesh, monkeypatch):
    page = (ROOT / "docs" / "mesh.md").read_text()
    (code,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    (built.folder / "tux").symlink_to(built.out)
    monkeypatch.chdir(built.folder)
    names = {}
    exec(code, names)
    assert names["triangles"].shape == (mesh["report"]["triangles"], 3)
    assert names["vertices"]["stand"].shape == (mesh["report"]["vertices"], 2)


def test_mesh_json_is_valid_in_every_drawing(mesh):
    assert_valid_in_every_drawing(
        SimpleNamespace(
            triangles=np.array(mesh["triangles"]),
            boundary=[np.array(loop) for loop in mesh["boundary"]],
            shape_ids=[shape["id"] for shape in mesh["shapes"]],
            vertices={shape["id"]: np.array(shape["vertices"]) for shape in mesh["shapes"]},
        )
    )


def test_mesh_json_is_the_mesh_of_the_service(mesh, client):
    served = client.session("walk-by-command").mesh()
    assert mesh["revision"] == served.revision
    assert [shape["id"] for shape in mesh["shapes"]] == served.shape_ids == list(WALK)
    assert np.array_equal(mesh["triangles"], served.triangles)
    for shape in mesh["shapes"]:
        assert shape["size"] == [200, 260]
        assert np.array_equal(shape["vertices"], served.vertices[shape["id"]])
        assert shape["turns"] == served.turns[shape["id"]]
        for ring, other in zip(shape["outlines"], served.outlines[shape["id"]], strict=True):
            assert np.array_equal(ring, other)


def test_the_contact_sheet_shows_every_drawing_and_what_lies_between(built):
    with Image.open(built.out / "contact-sheet.png") as sheet:
        assert sheet.mode == "RGB"
        pixels = np.asarray(sheet).astype(int)
    red = (pixels[..., 0] > 150) & (pixels[..., 1] < 100) & (pixels[..., 2] < 100)
    cell = 252
    above = pixels[: pixels.shape[0] // 2], red[: pixels.shape[0] // 2]
    for column in range(3):  # rims of the meshes
        assert above[1][:, column * cell : (column + 1) * cell].sum() > 300
    below = pixels[pixels.shape[0] // 2 :]
    for column in range(4):  # in-betweens, and the middle of all
        painted = (
            np.abs(below[:, column * cell : (column + 1) * cell] - 248).max(axis=2) > 20
        ).sum()
        assert painted > 5_000


def test_the_same_again_builds_nothing_and_a_changed_drawing_is_replaced(server, client, tmp_path):
    stand, step, wave = walk_files(tmp_path)
    arguments = ["--server", server.address, "build", "--session", "again", "--out", tmp_path / "o"]
    first = answer(*arguments, stand, step)
    again = answer(*arguments, stand, step)
    assert (first["rebuilt"], again["rebuilt"]) == (True, False)
    assert again["revision"] == first["revision"] and again["etag"] == first["etag"]

    step.write_bytes(wave.read_bytes())
    changed = answer(*arguments, stand, step)
    assert changed["rebuilt"] and [shape["id"] for shape in changed["shapes"]] == ["stand", "step"]
    client.session("again").delete()


def test_drawings_are_added_and_removed_and_others_stay(server, client, tmp_path):
    stand, step, wave = walk_files(tmp_path)
    arguments = ["--server", server.address, "build", "--session", "more", "--out", tmp_path / "o"]
    answer(*arguments, stand, step)
    done = run(*arguments, wave)
    assert done.returncode == 0 and "kept from before: stand, step" in done.stdout
    said = answer(*arguments, wave, "--remove", "step")
    assert [shape["id"] for shape in said["shapes"]] == ["stand", "wave"]
    client.session("more").delete()


def test_places_are_kept_and_one_of_them_can_be_changed(server, client, tmp_path):
    files = walk_files(tmp_path)[:2]
    arguments = ["--server", server.address, "build", *files, "--session", "placed"]
    arguments += ["--out", tmp_path / "o"]
    answer(*arguments, "--place", "stand=0,0", "--place", "step=1,0")
    said = answer(*arguments, "--place", "step=-2,0.5")
    assert [shape["placement"] for shape in said["shapes"]] == [[0, 0], [-2, 0.5]]
    assert [shape["placement"] for shape in answer(*arguments)["shapes"]] == [[0, 0], [-2, 0.5]]
    client.session("placed").delete()


def test_a_drawing_without_a_place_beside_placed_ones_is_named(server, client, tmp_path):
    files = walk_files(tmp_path)[:2]
    arguments = ["--server", server.address, "build", *files, "--session", "unplaced"]
    said = refusal(1, *arguments, "--place", "stand=0,0", "--out", tmp_path / "o")
    assert "'step' has no place" in said
    client.session("unplaced").delete()


def test_landmarks_are_met_and_replaced(server, client, tmp_path):
    for name, turn in (("a", 0.0), ("b", 0.2)):
        ring = star(turn=turn)
        (tmp_path / f"{name}.json").write_text(json.dumps({"outer": ring.tolist()}))
    tips = [star()[0].tolist(), star(turn=0.2)[2].tolist()]
    (tmp_path / "marks.json").write_text(json.dumps([{"a": tips[0], "b": tips[1]}]))
    (tmp_path / "none.json").write_text("[]")
    arguments = ["--server", server.address, "build", tmp_path / "a.json", tmp_path / "b.json"]
    arguments += ["--session", "marked", "--out", tmp_path / "out", "--landmarks"]
    said = answer(*arguments, tmp_path / "marks.json")
    assert said["correspondences"] == [{"a": tips[0], "b": tips[1]}]
    mesh = json.loads((tmp_path / "out" / "mesh.json").read_text())
    (mark,) = mesh["landmarks"]
    for shape, tip in zip(mesh["shapes"], tips, strict=True):
        assert np.hypot(*(np.array(shape["vertices"][mark]) - tip)) < 8
    assert answer(*arguments, tmp_path / "none.json")["correspondences"] == []
    client.session("marked").delete()


def test_one_drawing_and_two_drawings_build(server, client, tmp_path):
    stand, step, _ = walk_files(tmp_path)
    for name, files in (("one", [stand]), ("two", [stand, step])):
        out = tmp_path / name
        arguments = ["build", *files, "--session", name, "--out", out]
        said = answer("--server", server.address, *arguments)
        assert len(said["shapes"]) == len(files)
        with Image.open(out / "contact-sheet.png") as sheet:
            assert sheet.width > 240
        client.session(name).delete()


def test_rings_in_json_with_holes_and_a_texture(server, client, tmp_path):
    hole = (100 + np.array([[-8, -8], [8, -8], [8, 8], [-8, 8]])).tolist()
    paint = np.full((200, 200, 4), (200, 30, 30, 255), np.uint8)
    (tmp_path / "paint.png").write_bytes(png_of(paint))
    document = {"units": "px", "outer": star().tolist(), "holes": [hole], "texture": "paint.png"}
    (tmp_path / "star.json").write_text(json.dumps(document))
    arguments = ["build", tmp_path / "star.json", "--session", "rings", "--out", tmp_path / "out"]
    (shape,) = answer("--server", server.address, *arguments)["shapes"]
    assert shape["holes_filled"] == 1
    session = client.session("rings")
    middle = session.render(weights={"star": 1}, size=(200, 200), view=(0, 0, 200, 200))[70, 100]
    assert middle.tolist() == [200, 30, 30, 255]
    session.delete()


@pytest.mark.parametrize(
    ("file", "content", "says"),
    [
        ("missing.png", None, "No such file"),
        ("text.png", b"this is no picture", "text"),
        ("cut.png", png_of(figure(**WALK["stand"]))[:800], "cut"),
        ("empty.png", b"", "empty"),
        ("clear.png", png_of(np.zeros((50, 50, 4), np.uint8)), "clear"),
        ("my drawing.png", png_of(figure(**WALK["stand"])), "rename the file"),
        ("broken.json", b"{", "not JSON"),
        ("deep.json", b"[" * 100_000, "not JSON"),
        ("binary.json", b"\xff\xfe\x00", "UTF-8"),
        ("list.json", b"[]", '{"outer"'),
        ("words.json", b'{"outer": [["a", "b"]]}', "outer is not a list of points"),
        ("hole.json", b'{"outer": [[0, 0]], "holes": [[1, 2]]}', "holes[0] is not"),
        ("short.json", b'{"outer": [[0, 0], [9, 9]]}', "short"),
        ("nan.json", b'{"outer": [[0, 0], [NaN, 9], [9, 9]]}', "nan"),
        ("bare.json", b'{"outer": [[0, 0], [9, 0], [9, 9]], "texture": "gone.png"}', "gone.png"),
    ],
)
def test_garbage_is_refused_by_the_name_of_its_file(server, client, tmp_path, file, content, says):
    if content is not None:
        (tmp_path / file).write_bytes(content)
    sessions = len(client.sessions())
    out = tmp_path / "out"
    said = refusal(1, "--server", server.address, "build", tmp_path / file, "--out", out)
    assert file in said and says in said, said
    assert len(client.sessions()) == sessions, "a nameless session was left behind"


def test_two_files_of_one_drawing_are_both_named(server, tmp_path):
    (tmp_path / "other").mkdir()
    files = [walk_files(tmp_path)[0], walk_files(tmp_path / "other")[0]]
    said = refusal(1, "--server", server.address, "build", *files, "--out", tmp_path / "out")
    assert all(str(file) in said for file in files) and "'stand'" in said


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("{}", "landmarks are a list"),
        ('[{"stand": [1]}]', "landmark 0"),
        ('[{"stand": [100, 20]}, 7]', "landmark 1"),
        ('[{"nobody": [1, 2]}]', "nobody"),
    ],
)
def test_bad_landmarks_are_refused(server, client, tmp_path, content, says):
    (tmp_path / "marks.json").write_text(content)
    arguments = ["build", walk_files(tmp_path)[0], "--landmarks", tmp_path / "marks.json"]
    said = refusal(1, "--server", server.address, *arguments, "--out", tmp_path / "out")
    assert says in said


def test_options_are_checked_by_the_service(server, tmp_path):
    arguments = ["--server", server.address, "build", walk_files(tmp_path)[0]]
    arguments += ["--out", tmp_path / "out"]
    assert "threshold" in refusal(1, *arguments, "--threshold", "300")
    assert "tolerance" in refusal(1, *arguments, "--tolerance", "7")
    assert "nobody" in refusal(1, *arguments, "--remove", "nobody")
    assert "nobody" in refusal(1, *arguments, "--place", "nobody=0,0")
    assert "twice" in refusal(1, *arguments, "--place", "stand=0,0", "--place", "stand=1,0")


def test_a_refused_rebuild_leaves_files_and_pose_space_as_they_were(server, client, tmp_path):
    stand, step, _ = walk_files(tmp_path)
    out = tmp_path / "out"
    arguments = ["--server", server.address, "build", "--session", "safe", "--out", out]
    first = answer(*arguments, stand, step)
    before = {path.name: path.read_bytes() for path in out.iterdir()}
    step.write_bytes(b"spoilt")
    refusal(1, *arguments, stand, step)
    assert {path.name: path.read_bytes() for path in out.iterdir()} == before
    session = client.session("safe")
    assert session.state().revision == first["revision"]
    assert session.blend(at=(1, 0)).revision == first["revision"]
    session.delete()


def test_an_out_folder_that_is_a_file_is_refused_before_anything_is_made(server, client, tmp_path):
    (tmp_path / "out").write_text("mine")
    sessions = len(client.sessions())
    files = walk_files(tmp_path)
    said = refusal(1, "--server", server.address, "build", *files, "--out", tmp_path / "out")
    assert str(tmp_path / "out") in said
    assert len(client.sessions()) == sessions and (tmp_path / "out").read_text() == "mine"


def test_the_command_and_the_client_build_the_same(server, client, built):
    session = client.create_session()
    for name, pose in WALK.items():
        session.put_shape(name, image=png_of(figure(**pose)))
    session.set_placements({"stand": (0, 0), "step": (1, 0.2), "wave": (0.4, 1)})
    assert session.build().revision == built.said["revision"]
    session.delete()
