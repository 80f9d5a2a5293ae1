# SPDX-License-Identifier: Apache-2.0
"""The demo does what the README says: pictures of every set, named as they are written."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

ROOT = Path(__file__).resolve().parents[2]
PICTURES = ("animation.png", "contact-sheet.png", "meshes.png", "weights.png")


def run_demo(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, ROOT / "deploy/demo.py", *arguments],
        cwd=ROOT,
        env={**os.environ, "POSESPACED": str(ROOT / "build/bin/posespaced")},
        capture_output=True,
        text=True,
        timeout=120,
    )


@pytest.mark.parametrize("name", ["figure", "snake", "face"])
def test_demo_leaves_the_pictures_that_it_names_and_asks_for_no_check(name, tmp_path):
    done = run_demo("--out", str(tmp_path), name)
    assert done.returncode == 0, done.stderr
    assert "0 folded triangles" in done.stdout
    assert "please check" not in done.stdout
    for file in PICTURES:
        assert str(tmp_path / name / file) in done.stdout
        with Image.open(tmp_path / name / file) as picture:
            colours = picture.convert("RGB").getcolors(maxcolors=1 << 24)
            assert len(colours) > 100, f"{file} is nearly blank"
    with Image.open(tmp_path / name / "animation.png") as animation:
        assert animation.n_frames > 60


def test_demo_refuses_a_set_that_is_not_there(tmp_path):
    done = run_demo("--out", str(tmp_path), "dragon")
    assert done.returncode == 2
    assert "dragon" in done.stderr
