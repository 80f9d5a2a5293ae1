# SPDX-License-Identifier: Apache-2.0
"""Families of generated drawings: polygons of some 400 pixels, the same in every run.

A family draws N rings (n, 2) from a generator of random numbers.  In the families that know their
correspondence row k of every ring is the same place, so that a matching has a right answer.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from zlib import crc32

import numpy as np
import posespace
from exact_mesh_checks import crossings
from numpy.random import Generator
from numpy.typing import NDArray
from outlines import is_simple, signed_area

Points = NDArray[np.float64]

_SIZE = 400.0  # pixels


@dataclass(frozen=True)
class GeneratedGroup:
    """N rings to morph among, by drawing id; `known`: row k of every ring is the same place."""

    name: str
    rings: dict[str, Points] = field(repr=False)
    known: bool
    kind: str = "generated"

    def upload(self, session: posespace.Session) -> None:
        for shape_id, ring in self.rings.items():
            session.put_shape(shape_id, polygon=ring)

    @property
    def places(self) -> dict[str, Points] | None:
        return self.rings if self.known else None


@dataclass(frozen=True)
class Family:
    """draw(random, count) answers simple rings."""

    name: str
    draw: Callable[[Generator, int], list[Points]]
    known: bool
    counts: tuple[int, ...]  # N of the groups that are always measured
    more: tuple[int, ...] = ()  # and of those measured when there is time

    def groups(self, thorough: bool = False) -> Iterator[GeneratedGroup]:
        for count in self.counts + (self.more if thorough else ()):
            yield self.group(count)

    def group(self, count: int, seed: int = 0) -> GeneratedGroup:
        name = f"{self.name}-{count}" + (f"-{seed}" if seed else "")
        random = np.random.default_rng(crc32(name.encode()))
        rings = {chr(97 + k): _in_pixels(r) for k, r in enumerate(self.draw(random, count))}
        assert all(is_simple(ring) for ring in rings.values())
        kind = "glyph masters" if self.name.startswith("glyph") else "generated"
        return GeneratedGroup(name, rings, self.known, kind)


def star_shaped(random: Generator, count: int, n: int = 24) -> list[Points]:
    """Around one point, with nothing else in common."""
    rings = []
    for _ in range(count):
        angle = 2 * np.pi * (np.arange(n) + 0.8 * random.random(n)) / n
        rings.append(_polar(0.3 + 0.7 * random.random(n), angle))
    return rings


def random_simple(random: Generator, count: int, n: int = 14) -> list[Points]:
    """Random points, uncrossed by reversing runs: the worst case, with nothing in common."""
    return [_uncrossed(random.random((n, 2))) for _ in range(count)]


def articulated(random: Generator, count: int, limbs: int = 5) -> list[Points]:
    """One body with limbs of different length and width; each drawing swings, bends and stretches
    them in its own way."""
    root = 2 * np.pi * (np.arange(limbs) + 0.25 * random.uniform(-1, 1, limbs)) / limbs
    length, width = random.uniform(0.9, 1.9, limbs), random.uniform(0.28, 0.5, limbs)
    rings: list[Points] = []
    while len(rings) < count:
        parts = []
        for k in range(limbs):
            reach = length[k] * random.uniform(0.85, 1.15)
            swing, bend = random.uniform(-0.3, 0.3), random.uniform(-1.1, 1.1)
            parts += [
                _limb(root[k], reach, width[k], swing, bend),
                _body(root[k], root[(k + 1) % limbs], width[k], width[(k + 1) % limbs]),
            ]
        if is_simple(ring := np.concatenate(parts)):  # limbs may have crossed
            rings.append(ring)
    return rings


def spirals(random: Generator, count: int) -> list[Points]:
    """A band wound a half to two and a half times."""
    turns = np.linspace(0.5, 2.5, count) if count > 1 else np.array([1.5])
    along = np.linspace(0, 1, 60)
    return [
        _stroke(_polar(1 + along * t, 2 * np.pi * t * along), random.uniform(0.3, 0.5))
        for t in turns
    ]


def combs(random: Generator, count: int, teeth: int = 7) -> list[Points]:
    """Teeth of random heights on a bar."""
    rings = []
    for _ in range(count):
        height, left = random.uniform(1.5, 4.0, teeth), 2.0 * np.arange(teeth)
        top = [
            (x, y)
            for x, h in zip(left[::-1], height[::-1], strict=True)
            for x, y in ((x + 1, 1), (x + 1, 1 + h / 2), (x + 1, 1 + h), (x, 1 + h), (x, 1 + h / 2),
                         (x, 1))
        ]  # fmt: skip
        bottom = [(x, 0.0) for x in np.linspace(0, 2.0 * teeth - 1, 2 * teeth)]
        rings.append(np.array(bottom + top))
    return rings


def bent_bars(random: Generator, count: int) -> list[Points]:
    """A bar bent by 0 to 300 degrees."""
    along = np.linspace(-0.5, 0.5, 31)
    rings = []
    for angle in np.radians(np.linspace(0, 300, count)):
        heading = angle * (along[1:] + along[:-1]) / 2
        steps = np.stack([np.cos(heading), np.sin(heading)], axis=1) / 30
        middle = np.concatenate([[(0.0, 0.0)], np.cumsum(steps, axis=0)])
        rings.append(_stroke(middle, 0.1 * random.uniform(0.9, 1.1)))
    return rings


def glyphs(letter: str) -> Callable[[Generator, int], list[Points]]:
    """Masters of one letter: weights from light to black, widths and slants."""

    def draw(random: Generator, count: int) -> list[Points]:
        rings = []
        for weight in np.linspace(0.05, 0.2, count):
            ring = _LETTERS[letter](float(weight))
            ring = ring * (random.uniform(0.85, 1.15), -1.0)  # letters are drawn upwards
            ring[:, 0] -= random.uniform(0.0, 0.25) * ring[:, 1]
            rings.append(ring)
        return rings

    return draw


def _letter_s(weight: float) -> Points:
    t = np.linspace(0, 1, 37)
    upper = _polar(1.0, np.radians(20 + 250 * t)) * (0.32, 0.26) + (0, 0.76)
    lower = _polar(1.0, np.radians(90 - 250 * t)) * (0.36, 0.25) + (0, 0.25)
    return _stroke(np.concatenate([upper, lower[1:]]), weight * (1 + 0.3 * _bump(73)))


def _letter_two(weight: float) -> Points:
    arc = _polar(1.0, np.radians(np.linspace(170, -25, 25))) * 0.3 + (0, 0.7)
    corner, end = np.array([-0.3, 0.0]), np.array([0.4, 0.0])
    neck = _line(arc[-1], corner, (0.2, 0.4, 1.0))
    return _stroke(np.concatenate([arc, neck, _line(corner, end, (0.6, 0.8, 1.0))]), weight)


def _letter_g(weight: float) -> Points:
    arc = _polar(1.0, np.radians(np.linspace(45, 325, 41))) * (0.45, 0.5) + (0, 0.5)
    corner = np.array([arc[-1][0], 0.55])
    bar = _line(corner, np.array([0.0, 0.55]), (0.7, 1.0))
    return _stroke(np.concatenate([arc, [corner], bar]), 0.75 * weight)


def _letter_e(weight: float) -> Points:
    stem, arm, middle = 1.2 * weight, 0.8 * weight, 0.5 + 0.3 * weight
    corners = [
        (0, 0), (0.6, 0), (0.6, arm), (stem, arm), (stem, middle - arm), (0.5, middle - arm),
        (0.5, middle), (stem, middle), (stem, 1 - arm), (0.58, 1 - arm), (0.58, 1), (0, 1),
    ]  # fmt: skip
    return _with_rows_on_edges(np.array(corners, dtype=float), 6)


_LETTERS: dict[str, Callable[[float], Points]] = {
    "S": _letter_s,
    "2": _letter_two,
    "G": _letter_g,
    "E": _letter_e,
}

FAMILIES = [
    Family("star-shaped", star_shaped, False, (2, 4, 8), (3, 5, 6, 7)),
    Family("random-simple", random_simple, False, (2, 3, 5), (4, 6, 7, 8)),
    Family("articulated", articulated, True, (2, 4, 8), (3, 5, 6, 7)),
    Family("spirals", spirals, True, (2, 4), (3, 8)),
    Family("combs", combs, True, (2, 6), (3, 4, 8)),
    Family("bent-bars", bent_bars, True, (2, 3, 8), (4, 5, 6, 7)),
    *(
        Family(f"glyph-{letter}", glyphs(letter), True, (5,), (2, 3, 4, 6, 7, 8))
        for letter in _LETTERS
    ),
]


def family(name: str) -> Family:
    return next(f for f in FAMILIES if f.name == name)


def generated_groups(thorough: bool = False) -> list[GeneratedGroup]:
    return [group for f in FAMILIES for group in f.groups(thorough)]


def _polar(radius: Points | float, angle: Points) -> Points:
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


def _line(start: Points, end: Points, shares: tuple[float, ...]) -> Points:
    return start + np.array(shares)[:, None] * (end - start)


def _bump(n: int) -> Points:
    return np.sin(np.linspace(0, np.pi, n)) ** 2


def _stroke(middle: Points, width: Points | float) -> Points:
    """What a pen of that width draws along a line: one side there, the other side back, mitred at
    corners and cut straight at the ends."""
    steps = np.diff(middle, axis=0)
    normals = np.stack([steps[:, 1], -steps[:, 0]], axis=1) / np.linalg.norm(steps, axis=1)[:, None]
    first, second = np.vstack([normals[:1], normals]), np.vstack([normals, normals[-1:]])
    mitre = (first + second) / (1 + (first * second).sum(axis=1))[:, None]
    half = mitre * np.broadcast_to(np.asarray(width) / 2, len(middle))[:, None]
    return np.concatenate([middle + half, (middle - half)[::-1]])


def _limb(root: float, reach: float, width: float, swing: float, bend: float) -> Points:
    """From the body's rim outwards and back, bent in the middle, with a round tip."""
    along = np.linspace(0, 1, 13)
    heading = root + swing * along[:-1] + bend * along[:-1] ** 2
    steps = reach / 12 * np.stack([np.cos(heading), np.sin(heading)], axis=1)
    start = 0.95 * np.array([np.cos(root), np.sin(root)])
    middle = start + np.concatenate([[(0.0, 0.0)], np.cumsum(steps, axis=0)])
    sides = _stroke(middle, width * (1 - 0.35 * along))
    tip = middle[-1] + 0.65 * width / 2 * _polar(1.0, heading[-1] + np.pi / 2 * _TIP)
    return np.concatenate([sides[:12], tip, sides[14:]])


_TIP = np.array([-0.8, -0.4, 0.0, 0.4, 0.8])


def _body(before: float, after: float, width_before: float, width_after: float) -> Points:
    """The body's rim between two limbs."""
    span = (after - before) % (2 * np.pi)
    angles = before + np.linspace(0.6 * width_before, span - 0.6 * width_after, 6)
    return _polar(0.9, angles)


def _uncrossed(ring: Points) -> Points:
    while found := crossings(ring):
        i, j = found[0]
        ring[i + 1 : j + 1] = ring[i + 1 : j + 1][::-1].copy()
    return ring


def _with_rows_on_edges(ring: Points, count: int) -> Points:
    share = np.arange(count)[:, None] / count
    return np.concatenate(
        [a + share * (b - a) for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True)]
    )


def _in_pixels(ring: Points) -> Points:
    """Positive, in a box of _SIZE from the origin, on 1/64 pixels."""
    if signed_area(ring) < 0:
        ring = ring[::-1]
    low = ring.min(axis=0)
    return np.round(64 * (ring - low) * _SIZE / np.ptp(ring, axis=0).max()) / 64
