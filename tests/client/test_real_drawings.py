# SPDX-License-Identifier: Apache-2.0
"""Drawings that people made, from upload to picture."""

from __future__ import annotations

import io
import json
import os
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from exact_mesh_checks import assert_valid_in_every_drawing
from numpy.typing import NDArray
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
SHAPES = Path(os.environ.get("POSESPACE_SHAPES", ROOT.parent / "shared" / "shapes"))

GROUPS = {
    "kenney-femaleAdventurer-walk": "picture",
    "kenney-femalePerson-walk": "picture",
    "kenney-maleAdventurer-walk": "picture",
    "kenney-malePerson-walk": "picture",
    "kenney-robot-walk": "picture",
    "kenney-zombie-walk": "picture",
    "fluent-hand-open": "picture",
    "fluent-people": "picture",
    "lottie-bacon-2": "picture",
    "ebgaramond-uG": "polygon",
}

pytestmark = pytest.mark.skipif(
    not (SHAPES / "index.json").is_file(),
    reason=f"no drawings in {SHAPES}; name their folder by POSESPACE_SHAPES",
)


def picture_of(path: Path) -> NDArray[np.uint8]:
    """(H, W, 4) uint8; SVG at most 512 pixels across and down."""
    if path.suffix == ".svg":
        png = subprocess.run(
            ["rsvg-convert", "--keep-aspect-ratio", "-w", "512", "-h", "512", str(path)],
            check=True,
            capture_output=True,
        ).stdout
        return np.asarray(Image.open(io.BytesIO(png)).convert("RGBA"))
    return np.asarray(Image.open(path).convert("RGBA"))


def group(name: str) -> dict:
    groups = json.loads((SHAPES / "index.json").read_text())["groups"]
    return next(entry for entry in groups if entry["name"] == name)


def premultiplied(pixels: NDArray[np.uint8]) -> NDArray[np.float64]:
    """(H, W, 4) in [0, 1]."""
    values = pixels / 255.0
    values[..., :3] *= values[..., 3:]
    return values


@dataclass
class Drawing:
    """Pixels, and the box x, y, width, height of drawing coordinates that they cover."""

    pixels: NDArray[np.uint8]
    view: tuple[float, float, float, float]


def inside(ring: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which points lie inside the ring, by counting crossings to their right."""
    odd = np.zeros(len(points), dtype=bool)
    x, y = points.T
    for (ax, ay), (bx, by) in zip(ring, np.roll(ring, -1, axis=0), strict=True):
        spans = (ay > y) != (by > y)
        with np.errstate(divide="ignore", invalid="ignore"):
            odd ^= spans & (x < ax + (y - ay) / (by - ay) * (bx - ax))
    return odd


def painted_rings(rings: dict) -> Drawing:
    """Black where a pixel's centre is inside, 512 pixels across, a little wider than the ring."""
    assert not rings["holes"], "this group has no holes"
    outer = np.array(rings["outer"], dtype=float)
    left, top = (outer.min(axis=0) - 2).tolist()
    scale = 512 / (float(np.ptp(outer[:, 0])) + 4)
    rows = int(np.ceil((float(np.ptp(outer[:, 1])) + 4) * scale))
    y, x = np.mgrid[:rows, :512] + 0.5
    centres = np.stack([x.ravel(), y.ravel()], axis=1) / scale + (left, top)
    pixels = np.zeros((rows, 512, 4), np.uint8)
    pixels[..., 3] = 255 * inside(outer, centres).reshape(rows, 512)
    return Drawing(pixels, (left, top, 512 / scale, rows / scale))


@pytest.fixture(scope="module", params=GROUPS)
def built(request, client):
    """(session, drawings by id, the group's alpha threshold), built."""
    entry = group(request.param)
    session = client.create_session(display_name=request.param)
    threshold = entry.get("alpha_threshold", 128)
    drawings = {}
    if GROUPS[request.param] == "picture":
        for member in entry["members"]:
            name, pixels = Path(member).stem, picture_of(SHAPES / member)
            session.put_shape(name, image=pixels, threshold=threshold)
            drawings[name] = Drawing(pixels, (0, 0, pixels.shape[1], pixels.shape[0]))
    else:
        for member in entry["polygons"]:
            name, rings = Path(member).stem, json.loads((SHAPES / member).read_text())
            session.put_shape(name, polygon=rings["outer"], holes=rings["holes"])
            drawings[name] = painted_rings(rings)
    session.build()
    yield session, drawings, threshold
    session.delete()


def test_mesh_is_valid_in_every_drawing(built):
    session, _, _ = built
    assert_valid_in_every_drawing(session.mesh())


def test_mesh_covers_every_painted_pixel(built):
    session, drawings, threshold = built
    mesh = session.mesh()
    for name, drawing in drawings.items():
        x, y, width, _ = drawing.view
        rows, columns = np.nonzero(drawing.pixels[..., 3] >= threshold)
        scale = width / drawing.pixels.shape[1]
        centres = np.stack([columns + 0.5, rows + 0.5], axis=1) * scale + (x, y)
        outside = centres[~inside(mesh.vertices[name][mesh.boundary[0]], centres)]
        assert len(outside) == 0, f"shape '{name}': {len(outside)} outside, {outside[:3]} first"


def test_every_pose_is_reproduced_at_its_own_weights(built):
    session, _, _ = built
    mesh, placements = session.mesh(), session.state().placements
    for name, points in mesh.vertices.items():
        size = np.ptp(points, axis=0).max()
        for frame in (session.blend(weights={name: 1.0}), session.blend(at=placements[name])):
            assert np.abs(frame.vertices - points).max() <= 1e-4 * size, name
            assert frame.folds == 0


def test_a_render_at_a_pose_resembles_its_picture(built):
    session, drawings, threshold = built
    has_colours = GROUPS[session.state().display_name] == "picture"
    placements = session.state().placements
    for name, drawing in drawings.items():
        pixels = drawing.pixels
        height, width = pixels.shape[:2]
        rendered = session.render(at=placements[name], size=(width, height), view=drawing.view)
        assert rendered.shape == pixels.shape
        painted = pixels[..., 3] >= threshold
        shown = rendered[..., 3] >= threshold
        overlap = (painted & shown).sum() / (painted | shown).sum()
        assert overlap >= 0.98, f"shape '{name}': the silhouettes share {overlap:.3f}"
        if not has_colours:
            continue
        difference = np.abs(premultiplied(rendered) - premultiplied(pixels))[painted].mean()
        assert difference <= 0.02, f"shape '{name}': pixels differ by {difference:.3f} of 1"


def test_in_betweens_have_few_folds(built):
    session, _, _ = built
    ids = session.shape_ids
    rng = np.random.default_rng(1)
    frames = [
        session.blend(weights=dict(zip(ids, w, strict=True)))
        for w in rng.dirichlet(np.ones(len(ids)), 10)
    ]
    triangles = len(session.mesh().triangles)
    assert sum(frame.folds for frame in frames) <= 0.01 * len(frames) * triangles
