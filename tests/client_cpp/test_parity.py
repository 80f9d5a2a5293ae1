# SPDX-License-Identifier: Apache-2.0
"""The same session through the C++ client and through the Python client: the same bits."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import posespace
import pytest
from PIL import Image, ImageDraw
from posespace import errors

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "build/bin/client_parity"


def draw(path: Path, arm: int) -> None:
    """A creature with one arm that ends at height `arm`."""
    image = Image.new("RGBA", (200, 240))
    pen = ImageDraw.Draw(image)
    pen.ellipse((60, 18, 140, 98), "#d8b08c")
    pen.rectangle((70, 80, 130, 220), "#446688")
    pen.line((110, 120, 185, arm), "#446688", 24)
    image.save(path)


@pytest.fixture(scope="module")
def server() -> Iterator[posespace.LocalServer]:
    with posespace.serve_locally() as running:
        yield running


def test_both_clients_get_the_same_bits(server, tmp_path):
    for name, arm in (("a", 120), ("b", 160), ("c", 85)):
        draw(tmp_path / f"{name}.png", arm)
    printed = subprocess.run(
        [PROGRAM, server.address, tmp_path], check=True, capture_output=True, text=True
    ).stdout
    revision, revision_of_one = printed.split()

    with posespace.connect(server.address, timeout=30.0) as client:
        session = client.create_session()
        for name in "abc":
            session.put_shape(name, image=tmp_path / f"{name}.png")
        session.set_correspondences([dict.fromkeys("abc", (100.0, 18.0))])
        session.set_placements({"a": (0, 0), "b": (1, 0.2), "c": (0.4, 1)})
        session.build(tolerance=0.02, target_edge_length=0.1)
        assert session.state().revision == revision

        points = [(-0.5 + k / 150.0, 1.5 - k / 100.0) for k in range(300)]
        blended = session.blend_many(points)
        frames = [
            blended,
            session.blend(weights={"a": 1.5, "c": -0.5}).vertices,
            session.blend(at=(0.3, 0.3), method="paper", shear_limit="off").vertices,
        ]
        only = client.create_session()
        only.put_shape("a", image=tmp_path / "a.png")
        only.build()
        assert only.state().revision == revision_of_one
        frames.append(only.blend(at=(2, 3)).vertices)

        assert (tmp_path / "frames").read_bytes() == b"".join(frame.tobytes() for frame in frames)
        assert (tmp_path / "played").read_bytes() == blended.tobytes()
        assert (tmp_path / "weights").read_bytes() == session.weights(points).tobytes()
        assert np.isfinite(blended).all()


def test_both_clients_take_a_reason_for_the_same_kind_of_error():
    source = (ROOT / "client/cpp/transport_error.cpp").read_text()
    in_cpp = dict(re.findall(r'\{"(\w+)", ErrorCode::k(\w+)\}', source))
    in_python = {
        reason: kind.__name__.removesuffix("Error") for reason, kind in errors._BY_REASON.items()
    }
    assert in_cpp == in_python
