# SPDX-License-Identifier: Apache-2.0
"""What deploy/drawings promises."""

import io
import json
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image, ImageDraw, ImageFilter

DRAWINGS = Path(__file__).resolve().parents[2] / "deploy" / "drawings"
FILES = sorted(DRAWINGS.glob("*.svg"))
OUTSIDE, INSIDE, DONE = 0, 255, 128
PINCHED = 8  # pixels that the tip of a wedge, an armpit say, may lose when its sides grow


def silhouette(svg: Path, grown: int = 0) -> Image.Image:
    """INSIDE where the drawing, at half its size and grown, is opaque; a clear margin all round."""
    command = ["rsvg-convert", "--zoom", "0.5", str(svg)]
    png = subprocess.run(command, check=True, capture_output=True).stdout
    alpha = Image.open(io.BytesIO(png)).convert("RGBA").getchannel("A")
    padded = Image.new("L", (alpha.width + 16, alpha.height + 16), OUTSIDE)
    padded.paste(alpha.point(lambda a: INSIDE if a >= 128 else OUTSIDE), (8, 8))
    return padded.filter(ImageFilter.MaxFilter(2 * grown + 1)) if grown else padded


def left_after_filling(image: Image.Image, seed: tuple[int, int]) -> int:
    """How many pixels of the seed's value do not hang together with it."""
    value = image.getpixel(seed)
    image = image.copy()
    ImageDraw.floodfill(image, seed, DONE)
    return image.histogram()[value]


def test_drawing_again_changes_nothing(tmp_path: Path) -> None:
    subprocess.run([sys.executable, str(DRAWINGS / "draw.py"), str(tmp_path)], check=True)
    drawn = {path.name: path.read_text() for path in tmp_path.iterdir()}
    assert drawn == {path.name: path.read_text() for path in FILES}


def test_every_drawing_has_one_place_and_is_visited() -> None:
    plans = json.loads((DRAWINGS / "placements.json").read_text())
    names = [file for plan in plans.values() for file in plan["drawings"]]
    assert sorted(names) == [path.name for path in FILES]
    for name, plan in plans.items():
        assert [f"{name}-{id}.svg" for id in plan["placements"]] == plan["drawings"]
        assert all(place in plan["path"] for place in plan["placements"].values())


@pytest.mark.parametrize("svg", FILES, ids=lambda path: path.stem)
def test_a_drawing_is_one_piece(svg: Path) -> None:
    shape = silhouette(svg)
    first = shape.tobytes().index(INSIDE)
    assert left_after_filling(shape, (first % shape.width, first // shape.width)) == 0


@pytest.mark.parametrize("grown", [0, 2])
@pytest.mark.parametrize("svg", FILES, ids=lambda path: path.stem)
def test_limbs_and_windings_keep_apart(svg: Path, grown: int) -> None:
    enclosed = left_after_filling(silhouette(svg, grown), (0, 0))
    assert enclosed <= PINCHED, f"parts nearer than {4 * grown} pixels enclose a hole"


@pytest.mark.parametrize("svg", FILES, ids=lambda path: path.stem)
def test_a_drawing_needs_nothing_from_outside(svg: Path) -> None:
    text = svg.read_text()
    assert "<title>" in text
    assert not any(word in text for word in ("<script", "<image", "<style", "url(", 'href="http'))
