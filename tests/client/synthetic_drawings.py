# SPDX-License-Identifier: Apache-2.0
"""Drawings that tests make for themselves."""

from __future__ import annotations

import io

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

# Angles of limbs from straight down, degrees, positive towards the right.
WALK = {
    "stand": {"left_arm": -50, "right_arm": 50, "left_leg": -18, "right_leg": 18},
    "step": {"left_arm": -75, "right_arm": 35, "left_leg": -32, "right_leg": 30},
    "wave": {"left_arm": -40, "right_arm": 120, "left_leg": -15, "right_leg": 20},
}


def figure(
    left_arm: float,
    right_arm: float,
    left_leg: float,
    right_leg: float,
    size: tuple[int, int] = (200, 260),
) -> NDArray[np.uint8]:
    """A person with limbs at these angles: (H, W, 4) uint8, antialiased."""
    fine = 4
    width, height = size
    image = Image.new("RGBA", (width * fine, height * fine))
    draw = ImageDraw.Draw(image)

    def limb(x: float, y: float, angle: float, length: float, colour: str) -> None:
        direction = np.array([np.sin(np.radians(angle)), np.cos(np.radians(angle))])
        end = np.array([x, y]) + length * direction
        draw.line([x * fine, y * fine, *(end * fine)], fill=colour, width=22 * fine)
        for cx, cy in ((x, y), end):
            draw.ellipse(
                [(cx - 11) * fine, (cy - 11) * fine, (cx + 11) * fine, (cy + 11) * fine], colour
            )

    middle = width / 2
    limb(middle - 14, 160, left_leg, 75, "#2b4a8b")
    limb(middle + 14, 160, right_leg, 75, "#2b4a8b")
    limb(middle - 18, 88, left_arm, 62, "#c0392b")
    limb(middle + 18, 88, right_arm, 62, "#c0392b")
    draw.rounded_rectangle(
        [(middle - 30) * fine, 76 * fine, (middle + 30) * fine, 172 * fine], 14 * fine, "#d35440"
    )
    draw.ellipse([(middle - 28) * fine, 18 * fine, (middle + 28) * fine, 82 * fine], "#f2c9a0")
    draw.ellipse([(middle + 6) * fine, 40 * fine, (middle + 14) * fine, 50 * fine], "#222222")
    return np.asarray(image.resize(size, Image.Resampling.LANCZOS))


def png_of(pixels: NDArray[np.uint8]) -> bytes:
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, format="PNG")
    return file.getvalue()


def star(points: int = 5, turn: float = 0.0, centre: float = 100.0) -> NDArray[np.float64]:
    """A star as a ring (K, 2), 180 across."""
    angle = turn + np.arange(2 * points) * np.pi / points
    radius = np.where(np.arange(2 * points) % 2 == 0, 90.0, 45.0)
    return centre + np.stack([radius * np.sin(angle), -radius * np.cos(angle)], axis=1)


def wavy_blob(bumps: int, depth: float, rows: int = 240) -> NDArray[np.float64]:
    """A round outline with many small features, which takes a while to build."""
    angle = np.arange(rows) * 2 * np.pi / rows
    radius = 90 * (1 + depth * np.sin(bumps * angle)) * (1 + 0.1 * np.sin(angle))
    return 120 + np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
