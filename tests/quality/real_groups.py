# SPDX-License-Identifier: Apache-2.0
"""The groups of real drawings beside the project, and their upload.

Their folder is `../shared/shapes`, or what POSESPACE_SHAPES names; `index.json` lists them.
"""

from __future__ import annotations

import io
import json
import os
import subprocess
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import posespace
from numpy.typing import NDArray
from PIL import Image, ImageDraw

ROOT = Path(__file__).resolve().parents[2]
SHAPES = Path(os.environ.get("POSESPACE_SHAPES", ROOT.parent / "shared" / "shapes"))
ABSENT = f"no drawings in {SHAPES}; name their folder by POSESPACE_SHAPES"

_SIDE = 1024  # pixels of a vector drawing's longer side: as many as the service gives it at most


@dataclass(frozen=True)
class Group:
    """N drawings to morph among: files by drawing id, and how to read them."""

    name: str
    members: dict[str, Path]
    foreground: str
    threshold: int | None
    expect: str | None
    kind: str
    rings: dict[str, Path]  # files of outlines whose row k is the same place in all; or none

    def upload(self, session: posespace.Session) -> None:
        for shape_id, path in self.members.items():
            source = {"svg" if path.suffix == ".svg" else "image": path}
            session.put_shape(
                shape_id, **source, foreground=self.foreground, threshold=self.threshold
            )

    @property
    def places(self) -> dict[str, NDArray[np.float64]] | None:
        """Drawing -> ring (K, 2), where row k of every ring is known to be the same place."""
        return {
            name: np.array(json.loads(path.read_text())["outer"], dtype=float)
            for name, path in self.rings.items()
        } or None


def all_groups() -> list[Group]:
    """In the order of the index; none where the drawings are absent."""
    index = SHAPES / "index.json"
    if not index.is_file():
        return []
    return [
        Group(
            name=entry["name"],
            members={Path(member).stem: SHAPES / member for member in entry["members"]},
            foreground=entry["foreground"],
            threshold=entry.get("alpha_threshold"),
            expect=entry.get("expect"),
            kind=entry["kind"],
            rings={
                Path(member).stem: SHAPES / ring
                for member, ring in zip(entry["members"], entry["polygons"], strict=True)
            }
            if "correspondence" in entry
            else {},
        )
        for entry in json.loads(index.read_text())["groups"]
    ]


def picture_of(path: Path) -> NDArray[np.uint8]:
    """(H, W, 4) uint8, straight alpha, of a file of any kind."""
    source: io.BytesIO | Path = path
    if path.suffix == ".svg":
        drawn = subprocess.run(
            ["rsvg-convert", "--keep-aspect-ratio", "-w", str(_SIDE), "-h", str(_SIDE), str(path)],
            check=True,
            capture_output=True,
        )
        source = io.BytesIO(drawn.stdout)
    with Image.open(source) as picture:
        return np.array(picture.convert("RGBA"))


def canvas_of(path: Path, shape: posespace.Shape) -> tuple[float, float, float, float]:
    """The box x, y, width, height of drawing coordinates that a file's picture covers."""
    left, top = 0.0, 0.0
    if path.suffix == ".svg":
        box = ElementTree.parse(path).getroot().get("viewBox", "0 0")
        left, top = map(float, box.replace(",", " ").split()[:2])
    return (left, top, *shape.size)


def painted(pixels: NDArray[np.uint8], group: Group) -> NDArray[np.bool_]:
    """(H, W): the pixels that are the drawing, found here by simple means."""
    if group.foreground == "dark":
        return pixels[..., :3].mean(axis=-1) < 128
    opaque = pixels[..., 3] >= (group.threshold or 128)
    if opaque.mean() < 0.98:
        return opaque
    page = Image.fromarray(pixels).convert("RGB")  # opaque paper: what a flood from a corner finds
    ImageDraw.floodfill(page, (0, 0), (255, 0, 255), thresh=60)
    return ~(np.asarray(page) == (255, 0, 255)).all(axis=-1)
