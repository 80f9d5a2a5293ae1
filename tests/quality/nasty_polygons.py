# SPDX-License-Identifier: Apache-2.0
"""Polygons that have upset triangulators and matchers, to be morphed into each other."""

from __future__ import annotations

import numpy as np
from families import family
from numpy.typing import NDArray

Points = NDArray[np.float64]


def _ring(*corners: tuple[float, float]) -> Points:
    return np.array(corners, dtype=float)


def _polar(radius: Points | float, angle: Points) -> Points:
    return 200.0 + np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


def _star(tips: int, inner: float) -> Points:
    angle = np.pi * np.arange(2 * tips) / tips - np.pi / 2
    return _polar(np.where(np.arange(2 * tips) % 2 == 0, 200.0, inner), angle)


def _bat() -> Points:
    """Ears, scalloped wings, a tail: tips where a star has bays."""
    half = [
        (0, 60), (12, 40), (25, 20), (32, 55), (70, 62), (110, 40), (150, 15), (200, 0), (185, 60),
        (190, 110), (160, 88), (135, 95), (128, 135), (100, 105), (70, 110), (62, 150), (38, 120),
        (15, 135), (0, 190),
    ]  # fmt: skip
    right = np.array(half, dtype=float)
    left = (right * (-1.0, 1.0))[-2:0:-1]
    return np.array([200.0, 0.0]) + np.concatenate([right, left])


def _zigzag(teeth: int) -> Points:
    """A wall of so many needles."""
    x = np.linspace(0, 400, 2 * teeth + 1)
    top = np.stack([x, np.where(np.arange(len(x)) % 2 == 0, 20.0, 300.0)], axis=1)
    return np.concatenate([[(400.0, 0.0), (0.0, 0.0)], top])[::-1]


def _staircase(steps: int) -> Points:
    along = np.repeat(np.arange(steps + 1), 2) * 400.0 / steps
    return np.concatenate([np.stack([along[1:], along[:-1]], axis=1), [(0.0, 400.0)]])


def _snowflake(depth: int) -> Points:
    ring = _polar(180.0, np.radians([-90.0, 30.0, 150.0]))
    for _ in range(depth):
        step = (np.roll(ring, -1, axis=0) - ring) / 3
        bump = ring + 1.5 * step + (3**0.5 / 2) * np.stack([step[:, 1], -step[:, 0]], axis=1)
        ring = np.stack([ring, ring + step, bump, ring + 2 * step], axis=1).reshape(-1, 2)
    return ring


def _collinear(per_side: int) -> Points:
    """A square with rows along its sides."""
    t = np.arange(per_side) * 400.0 / per_side
    zero, full = np.zeros(per_side), np.full(per_side, 400.0)
    sides = [(t, zero), (full, t), (400 - t, full), (zero, 400 - t)]
    return np.concatenate([np.stack(side, axis=1) for side in sides])


def _letter_c(gap: float) -> Points:
    """A frame whose ends come as near to each other as the gap."""
    return _ring(
        (0, 0), (400, 0), (400, 200 - gap / 2), (300, 200 - gap / 2), (300, 100), (100, 100),
        (100, 300), (300, 300), (300, 200 + gap / 2), (400, 200 + gap / 2), (400, 400), (0, 400),
    )  # fmt: skip


def _spiked(width: float, length: float) -> Points:
    """A square with a spike outwards and a slit inwards."""
    return _ring(
        (0, 0), (200 - width, 0), (200, -length), (200 + width, 0), (400, 0), (400, 400),
        (200 + width, 400), (200, 400 - length), (200 - width, 400), (0, 400),
    )  # fmt: skip


SIMPLE: dict[str, dict[str, Points]] = {
    "bat-and-star": {"bat": _bat(), "star": _star(5, 80.0)},
    "star-and-bat-and-needles": {"star": _star(5, 80.0), "bat": _bat(), "sun": _star(24, 30.0)},
    "comb-and-spiral": {
        "comb": family("combs").group(2).rings["a"],
        "spiral": family("spirals").group(2).rings["b"],
    },
    "spiral-and-its-mirror-image": {
        "left": family("spirals").group(4).rings["d"],
        "right": (family("spirals").group(4).rings["d"] * (-1.0, 1.0))[::-1],
    },
    "zigzags": {"few": _zigzag(5), "many": _zigzag(60)},
    "collinear-runs": {"square": _collinear(40), "turned": _polar(200.0, np.arange(4) * np.pi / 2)},
    "spike-and-slit": {"sharp": _spiked(0.01, 300.0), "blunt": _spiked(20.0, 100.0)},
    "nearly-closed-frame": {"open": _letter_c(60.0), "closed": _letter_c(1e-6)},
    "staircase-and-triangle": {"stairs": _staircase(40), "flat": _staircase(1)},
    "snowflake-and-triangle": {"flake": _snowflake(4), "plain": _snowflake(0)},
    "sliver-and-square": {"sliver": _ring((0, 0), (400, 0), (400, 1e-3)), "square": _collinear(1)},
    "far-from-the-origin": {"near": _star(7, 90.0), "far": _star(7, 60.0) + 999_000.0},
    "unlike-sizes": {"huge": 2000 * _star(6, 90.0), "tiny": 1e-4 * _star(6, 60.0)},
    "eight-things": {
        "bat": _bat(), "star": _star(5, 80.0), "zigzag": _zigzag(9), "frame": _letter_c(30.0),
        "stairs": _staircase(6), "flake": _snowflake(2), "spiked": _spiked(4.0, 200.0),
        "comb": family("combs").group(2).rings["b"],
    },
}  # fmt: skip

# Rings that are not simple, each to be morphed into a square.
TANGLED: dict[str, Points] = {
    "bow-tie": _ring((0, 0), (400, 400), (400, 0), (0, 400)),
    "pentagram": _star(5, 80.0)[::2][[0, 2, 4, 1, 3]],
    "touching-itself": _ring((0, 0), (400, 0), (400, 400), (200, 0), (0, 400)),
    "there-and-back": _ring((0, 0), (200, 0), (200, 200), (400, 200), (200, 200), (0, 200)),
    "there-and-back-only": _ring((0, 0), (200, 0), (400, 0), (200, 0)),
    "one-place": np.full((5, 2), 17.0),
    "no-number": _ring((0, 0), (400, 0), (np.nan, 400)),
    "beyond-bounds": _ring((0, 0), (2e6, 0), (0, 400)),
    "two-corners": _ring((0, 0), (400, 400)),
}
