# SPDX-License-Identifier: Apache-2.0
"""posespace build: every kind of drawing that people have."""

from __future__ import annotations

import gzip

import numpy as np
import pytest
from command_line import answer, refusal
from PIL import Image
from synthetic_drawings import WALK, figure

SVG = """<svg xmlns="http://www.w3.org/2000/svg" width="120" height="160" viewBox="0 0 120 160">
<path fill="{colour}" d="M60 10 L100 60 L90 150 L30 150 L20 60 Z"/></svg>"""


def on_paper(pixels, paper):
    """A drawing laid on a colour."""
    alpha = pixels[..., 3:] / 255
    return (pixels[..., :3] * alpha + np.array(paper) * (1 - alpha)).round().astype(np.uint8)


def build(server, folder, *arguments):
    """The drawings that a build answers."""
    said = answer("--server", server.address, "build", *arguments, "--out", folder / "out")
    answer("--server", server.address, "sessions", "rm", said["session"])
    return said["shapes"]


def test_pictures_vectors_and_rings_go_together(server, tmp_path):
    stand, step, wave = (figure(**pose) for pose in WALK.values())
    Image.fromarray(stand).save(tmp_path / "stand.png")
    Image.fromarray(on_paper(step, (255, 255, 255))).save(tmp_path / "step.jpg", quality=92)
    Image.fromarray(wave).save(tmp_path / "wave.webp", lossless=True)
    names = ["stand.png", "step.jpg", "wave.webp"]
    shapes = build(server, tmp_path, *(tmp_path / name for name in names))
    assert [shape["id"] for shape in shapes] == ["stand", "step", "wave"]
    assert all(shape["size"] == [200, 260] for shape in shapes)
    assert [bool(shape["warnings"]) for shape in shapes] == [False, True, False]


@pytest.mark.parametrize("suffix", ["svg", "SVG", "svgz"])
def test_an_svg_document_is_a_drawing(server, tmp_path, suffix):
    document = SVG.format(colour="#336699").encode()
    packed = gzip.compress(document) if suffix == "svgz" else document
    (tmp_path / f"drop.{suffix}").write_bytes(packed)
    (shape,) = build(server, tmp_path, tmp_path / f"drop.{suffix}")
    assert (shape["id"], shape["size"]) == ("drop", [120, 160])


@pytest.mark.parametrize(
    ("foreground", "paper", "colour"),
    [("dark", (250, 250, 250), (20, 20, 30)), ("light", (10, 10, 20), (240, 240, 230))],
)
def test_dark_and_light_drawings_on_plain_paper(server, tmp_path, foreground, paper, colour):
    pixels = np.zeros((160, 120, 4), np.uint8)
    pixels[30:130, 40:80] = (*colour, 255)
    Image.fromarray(on_paper(pixels, paper)).save(tmp_path / "bar.png")
    said = answer(
        "--server", server.address, "build", tmp_path / "bar.png",
        "--foreground", foreground, "--threshold", "60", "--out", tmp_path / "out",
    )  # fmt: skip
    answer("--server", server.address, "sessions", "rm", said["session"])
    with Image.open(tmp_path / "out" / "contact-sheet.png") as sheet:
        assert sheet.width > 240
    assert said["shapes"][0]["size"] == [120, 160]


def test_a_broken_svg_is_refused_by_the_name_of_its_file(server, tmp_path):
    for name, document in (("cut.svg", "<svg"), ("text.svg", "no drawing"), ("empty.svg", "")):
        (tmp_path / name).write_text(document)
        arguments = ["build", tmp_path / name, "--out", tmp_path / "out"]
        assert name in refusal(1, "--server", server.address, *arguments)
