# SPDX-License-Identifier: Apache-2.0
"""The face: a girl with two bunches, whose mood moves her brows, lids, mouth, jaw and hair."""

from __future__ import annotations

import math
from dataclasses import dataclass

from vector import INK, Drawing, Frame, Tube, closed, line, mix, outline, swept, taper

WIDTH, HEIGHT = 560, 560

SKIN, BLUSH, ROSE = "#f6c49a", "#ee8268", "#b9543f"
HAIR, RIBBON = "#c4532a", "#2f9c95"
BLOUSE, COLLAR = "#6a5aa8", "#fff3df"
IRIS, LIPS, MOUTH, TONGUE = "#3d7d4e", "#a8383f", "#70202f", "#f2777a"


@dataclass(frozen=True)
class Mood:
    """Pixels, y down, unless said otherwise."""

    title: str
    jaw: float = 0.0  # How far the chin drops.
    cheek: float = 0.0  # How far the cheeks widen.
    brow: tuple[float, float, float] = (-46.0, -56.0, -46.0)  # Heights: inner end, middle, outer.
    lid: float = 0.2  # Share of the eye its upper lid covers.
    under: float = 0.0  # Share of the eye its lower lid covers.
    gaze: float = 0.0  # How far the irises move down.
    pupil: float = 8.0  # Radius.
    corner: tuple[float, float] = (46.0, 82.0)  # The mouth's corner.
    lip: tuple[float, float] = (86.0, 88.0)  # Heights of upper and lower lip in the middle.
    roundness: float = 0.0  # Of the lips: 0 a bow, 1 half an oval.
    blush: float = 0.45
    bunch: tuple[float, float] = (-25.0, 95.0)  # Headings of the right bunch, root and end.


POSES = {
    "neutral": Mood("Calm"),
    "happy": Mood(
        "Happy",
        jaw=13,
        cheek=9,
        brow=(-56, -68, -54),
        lid=0.14,
        under=0.26,
        corner=(62, 68),
        lip=(80, 123),
        roundness=0.25,
        blush=0.8,
        bunch=(-42, 66),
    ),
    "surprised": Mood(
        "Surprised",
        jaw=28,
        cheek=-5,
        brow=(-80, -91, -70),
        lid=0.0,
        gaze=-1,
        pupil=6,
        corner=(27, 108),
        lip=(78, 142),
        roundness=1,
        blush=0.4,
        bunch=(-68, 26),
    ),
    "sad": Mood(
        "Sad",
        jaw=-3,
        cheek=2,
        brow=(-66, -58, -38),
        lid=0.36,
        gaze=5,
        corner=(38, 100),
        lip=(86, 90),
        blush=0.35,
        bunch=(-14, 104),
    ),
    "angry": Mood(
        "Angry",
        jaw=2,
        cheek=5,
        brow=(-28, -46, -60),
        lid=0.3,
        under=0.14,
        corner=(40, 99),
        lip=(83, 97),
        roundness=0.3,
        blush=0.95,
        bunch=(-54, 84),
    ),
}


def draw(name: str) -> Drawing:
    """The face in one of its moods."""
    mood = POSES[name]
    picture = Drawing(WIDTH, HEIGHT, f"Face: {mood.title}", "A girl with two bunches.")
    face = Frame(280 + 268j)
    picture.group("bunches")
    for side in (-1, 1):
        _bunch(picture, face.on(side), mood.bunch)
    picture.group("shoulders")
    _shoulders(picture, face, mood.jaw)
    picture.group("skull")
    _skull(picture, face, mood)
    picture.group("features")
    for side in (-1, 1):
        _eye(picture, face.on(side), mood, side)
        _brow(picture, face.on(side), mood.brow)
    _nose(picture, face)
    _mouth(picture, face, mood)
    picture.group("hair")
    _hair(picture, face)
    return picture


def _bunch(picture: Drawing, half: Frame, headings: tuple[float, float]) -> None:
    spine = swept(complex(120, -98), *headings, 150)
    centre = half.all([(p.real, p.imag) for p in spine])
    bunch = Tube(centre, taper((0, 17), (0.12, 20), (0.55, 34), (0.85, 19), (1, 4)))
    picture.solid(closed(bunch.ring(14)), HAIR)
    inner = half.hand
    picture.shade(outline(bunch.band(0.2, 0.98, 0.3 * inner, 0.97 * inner, 10)))
    for v in (-0.45, -0.05):
        picture.stroke(line(bunch.edge(v * inner, 0.25, 0.86, 8)), mix(HAIR, INK, 0.35), 3.5)
    knot = bunch.frame(0.14)
    picture.solid(closed(knot.oval(0, 0, 13, 24)), RIBBON)
    picture.mark(closed(knot.oval(-2, -9, 4, 7)), mix(RIBBON, "#ffffff", 0.45))


def _shoulders(picture: Drawing, face: Frame, jaw: float) -> None:
    half = [
        (0, 270),
        (104, 270),
        (142, 262),
        (146, 238),
        (122, 208),
        (78, 190),
        (40, 180),
        (0, 176),
    ]
    picture.solid(closed(face.mirrored(half)), BLOUSE)
    neck = [(0, 208), (26, 202), (44, 184), (42, 160), (44, 120), (0, 110)]
    picture.solid(closed(face.mirrored(neck)), SKIN)
    low = 166 + 0.9 * jaw
    under_chin = [(-41, low - 14), (-24, low - 3), (0, low), (24, low - 3), (41, low - 14)]
    above = face.all([(40, 122), (-40, 122)])
    picture.mark(outline([face.all(under_chin), above]), mix(SKIN, ROSE, 0.45))
    for side in (-1, 1):
        leaf = [
            (0, 212),
            (20, 205),
            (38, 190),
            (45, 172),
            (62, 178),
            (78, 200),
            (56, 222),
            (28, 238),
        ]
        picture.solid(closed(face.on(side).all(leaf)), COLLAR)
        fold = [(100, 218), (112, 238), (116, 264)]
        picture.stroke(line(face.on(side).all(fold)), mix(BLOUSE, INK, 0.4), 4)
    picture.mark(closed(face.oval(0, 246, 7, 7)), COLLAR)


def _skull(picture: Drawing, face: Frame, mood: Mood) -> None:
    jaw, cheek = mood.jaw, mood.cheek
    back = [
        (0, -178),
        (62, -170),
        (112, -134),
        (134, -78),
        (134, -26),
        (122, 22),
        (60, 20),
        (0, 20),
    ]
    picture.solid(closed(face.mirrored(back)), HAIR)
    for side in (-1, 1):
        ear = [(116, -28), (132, -40), (150, -34), (154, -8), (144, 20), (128, 30), (114, 22)]
        picture.solid(closed(face.on(side).all(ear)), SKIN)
        fold = [(130, -22), (141, -20), (140, -2), (131, 6), (134, 14)]
        picture.stroke(line(face.on(side).all(fold)), mix(SKIN, ROSE, 0.7), 4)
        picture.solid(closed(face.on(side).oval(138, 38, 8, 8)), "#f4b63f")
    half = [
        (0, 148 + jaw),
        (36, 143 + jaw),
        (74, 121 + 0.85 * jaw),
        (105 + cheek, 82 + 0.5 * jaw),
        (119 + cheek, 36),
        (122, -30),
        (104, -104),
        (56, -148),
        (0, -158),
    ]
    picture.solid(closed(face.mirrored(half)), SKIN)
    rim = [
        (34, 142 + jaw),
        (73, 119 + 0.85 * jaw),
        (103 + cheek, 81 + 0.5 * jaw),
        (117 + cheek, 36),
        (119, -10),
    ]
    inside = [(109, 34), (89 + cheek, 78 + 0.5 * jaw), (62, 111 + 0.85 * jaw), (34, 142 + jaw)]
    picture.shade(outline([face.all(rim), face.all(inside)]), 0.12)
    for side in (-1, 1):
        cheekbone = face.on(side)
        rise = 6 * mood.under / 0.26
        picture.mark(closed(cheekbone.oval(78, 50 - rise, 25, 17)), mix(SKIN, BLUSH, mood.blush))
        for x, y in ((66, 44), (80, 40), (90, 51), (74, 56)):
            picture.mark(closed(cheekbone.oval(x, y - rise, 2.6, 2.6)), mix(SKIN, ROSE, 0.75))


def _eye(picture: Drawing, half: Frame, mood: Mood, side: float) -> None:
    wide, high, x0 = 29.0, 31.0, 52.0
    top = -high * (1 - 2 * mood.lid)
    bottom = high * (1 - 2 * mood.under)
    lower = [(x0 + wide, 0), (x0 + 20, 0.74 * bottom), (x0, bottom), (x0 - 20, 0.74 * bottom)]
    upper = [
        (x0 - wide, 0),
        (x0 - 20, 0.74 * top),
        (x0, top),
        (x0 + 20, 0.74 * top),
        (x0 + wide, 0),
    ]
    picture.mark(outline([half.all(upper), half.all([*lower, (x0 - wide, 0)])]), "#ffffff")
    middle = (top + bottom) / 2 * 0.6 + mood.gaze
    reach = min(17.0, (bottom - top) / 2 - 1)
    picture.mark(closed(half.oval(x0 - 2, middle, 17, reach)), IRIS)
    picture.mark(closed(half.oval(x0 - 2, middle, mood.pupil, min(mood.pupil + 1, reach - 2))), INK)
    glint = Frame(half.at(x0 - 2, middle))
    picture.mark(closed(glint.oval(5, -6, 4.5, 4.5)), "#ffffff")
    picture.stroke(line(half.all([*lower, (x0 - wide, 0)])), mix(SKIN, ROSE, 0.75), 3)
    picture.stroke(line(half.all([*upper, (x0 + wide + 7, -5)])), INK, 6)


def _brow(picture: Drawing, half: Frame, heights: tuple[float, float, float]) -> None:
    inner, middle, outer = heights
    arch = half.all([(24, inner), (54, middle), (84, outer)])
    brow = Tube(_rounded(arch), taper((0, 7.5), (0.5, 6.5), (1, 3)))
    picture.mark(closed(brow.ring(6)), mix(HAIR, INK, 0.35))


def _rounded(arch: list[complex]) -> list[complex]:
    """The parabola through three points."""
    a, b, c = arch
    steps = [i / 10 for i in range(11)]
    return [a * (1 - t) * (1 - 2 * t) + b * 4 * t * (1 - t) + c * t * (2 * t - 1) for t in steps]


def _nose(picture: Drawing, face: Frame) -> None:
    tip = face.all([(-13, 40), (-15, 49), (-6, 53), (0, 56), (6, 53), (15, 49), (13, 40)])
    picture.stroke(line(tip), mix(SKIN, ROSE, 0.8), 4.5)
    picture.mark(closed(face.oval(2, 34, 4, 7)), mix(SKIN, "#ffffff", 0.5))


def _mouth(picture: Drawing, face: Frame, mood: Mood) -> None:
    wide, ends = mood.corner
    top, bottom = mood.lip

    def lip(middle: float, share: float = 1.0) -> list[tuple[float, float]]:
        """A curve from corner to corner, or its middle part."""
        curve = []
        for i in range(11):
            t = share * math.sin(math.pi / 2 * (i / 5 - 1))
            bow, oval = t * t, 1 - math.sqrt(max(1 - t * t, 0.0))
            rise = bow + (oval - bow) * mood.roundness
            curve.append((wide * t, middle + (ends - middle) * rise))
        return curve

    upper, lower = lip(top), lip(bottom)
    opening = outline([face.all(upper), face.all(lower[::-1])])
    picture.mark(opening, MOUTH)
    gap = bottom - top
    below_teeth = [(x, y + 0.3 * gap * (1 - (x / wide) ** 2)) for x, y in lip(top, 0.86)]
    picture.mark(outline([face.all(lip(top, 0.86)), face.all(below_teeth[::-1])]), "#ffffff")
    on_tongue = [(x, y - 0.4 * gap * (1 - (x / wide / 0.7) ** 2)) for x, y in lip(bottom, 0.7)]
    picture.mark(outline([face.all(on_tongue), face.all(lip(bottom, 0.7)[::-1])]), TONGUE)
    picture.stroke(opening, LIPS, 5.5)


def _hair(picture: Drawing, face: Frame) -> None:
    half = [(60, -171), (112, -136), (136, -78), (123, -22)]
    crown = [*[(-x, y) for x, y in reversed(half)], (0, -179), *half]
    fringe = [(112, -62), (84, -98), (40, -112), (-14, -98), (-34, -124), (-64, -100), (-104, -62)]
    picture.mark(outline([face.all(crown), face.all(fringe)]), HAIR)
    picture.stroke(line(face.all([(123, -22), *fringe, (-123, -22)])), mix(HAIR, INK, 0.6), 3.5)
    parting = [(-32, -124), (-26, -150), (-12, -176)]
    picture.stroke(line(face.all(parting)), mix(HAIR, INK, 0.5), 4)
    for strand in (
        [(-8, -112), (40, -132), (92, -104)],
        [(6, -132), (48, -150), (98, -122)],
        [(-50, -122), (-76, -118), (-104, -88)],
        [(-46, -144), (-80, -138), (-112, -104)],
    ):
        picture.stroke(line(face.all(strand)), mix(HAIR, INK, 0.3), 3.5)
    shine = [(24, -158), (54, -152), (82, -134)]
    picture.stroke(line(face.all(shine)), mix(HAIR, "#ffe0b0", 0.55), 7)
