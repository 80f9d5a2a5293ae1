# SPDX-License-Identifier: Apache-2.0
"""The figure: a child in winter clothes, posed by the angles of its bones.

Limbs stay clear of the body and of each other in every pose, so the outline meets the same limbs in
the same order and can be matched; sleeves, mittens, trousers and boots differ in colour for that,
too.
"""

from __future__ import annotations

from dataclasses import dataclass

from vector import (
    INK,
    Drawing,
    Frame,
    Tube,
    bent,
    closed,
    line,
    mix,
    outline,
    swept,
    taper,
    turn,
)

WIDTH, HEIGHT = 480, 640

SKIN, BLUSH, HAIR = "#ffd3ae", "#f79d84", "#7d4a2b"
CAP, WOOL = "#e5533d", "#fff3df"
SLEEVE, GILET, TROUSERS = "#f4b63f", "#2f9c95", "#4a5899"
BOOT, SOLE = "#a9572f", "#5b2f28"

UPPER_ARM, FOREARM = 70.0, 62.0
THIGH, SHIN = 80.0, 76.0


@dataclass(frozen=True)
class Limb:
    """Degrees away from hanging straight down, positive outwards: near bone, far bone, its end."""

    near: float
    far: float
    end: float = 0.0


@dataclass(frozen=True)
class Pose:
    """Where the bones point.  Left and right are the viewer's."""

    title: str
    pelvis: complex
    left_arm: Limb
    right_arm: Limb
    left_leg: Limb
    right_leg: Limb
    lean: float = 0.0  # Of the trunk, degrees clockwise.
    nod: float = 0.0  # Of the head, degrees clockwise.
    tip: tuple[float, float] = (-40.0, 32.0)  # Headings of the cap's tip, halfway and at its end.
    smile: float = 0.0  # 0 closed, 1 laughing.


POSES = {
    "stand": Pose(
        "Standing",
        pelvis=240 + 428j,
        left_arm=Limb(42, 20),
        right_arm=Limb(42, 20),
        left_leg=Limb(11, 5, 4),
        right_leg=Limb(11, 5, 4),
    ),
    "wave": Pose(
        "Waving",
        pelvis=244 + 429j,
        left_arm=Limb(98, 152, 6),
        right_arm=Limb(50, 12),
        left_leg=Limb(19, 10, 6),
        right_leg=Limb(8, 4, 4),
        lean=4,
        nod=-8,
        tip=(-34, 30),
        smile=0.7,
    ),
    "walk-a": Pose(
        "Stepping, right knee up",
        pelvis=232 + 414j,
        left_arm=Limb(64, 112, 8),
        right_arm=Limb(60, 34),
        left_leg=Limb(3, 0, -4),
        right_leg=Limb(70, -8, 12),
        lean=5,
        nod=-5,
        tip=(-74, 0),
        smile=0.25,
    ),
    "walk-b": Pose(
        "Stepping, left knee up",
        pelvis=248 + 414j,
        left_arm=Limb(60, 34),
        right_arm=Limb(64, 112, 8),
        left_leg=Limb(70, -8, 12),
        right_leg=Limb(3, 0, -4),
        lean=-5,
        nod=5,
        tip=(-28, 28),
        smile=0.25,
    ),
    "jump": Pose(
        "Jumping for joy",
        pelvis=242 + 410j,
        left_arm=Limb(104, 142, -6),
        right_arm=Limb(104, 142, -6),
        left_leg=Limb(62, -14, 30),
        right_leg=Limb(46, 66, 36),
        lean=-3,
        nod=-4,
        tip=(-104, -28),
        smile=1.0,
    ),
    "reach": Pose(
        "Reaching for the stars",
        pelvis=206 + 424j,
        left_arm=Limb(62, 84),
        right_arm=Limb(106, 142, -6),
        left_leg=Limb(40, 58, 30),
        right_leg=Limb(0, 3, 4),
        lean=13,
        nod=-12,
        tip=(-104, -62),
        smile=0.45,
    ),
}


def draw(name: str) -> Drawing:
    """The figure in one of its POSES."""
    pose = POSES[name]
    picture = Drawing(WIDTH, HEIGHT, f"Figure: {pose.title}", "A child in winter clothes.")
    trunk = Frame(pose.pelvis, pose.lean)
    neck = trunk.at(0, -128)
    head = Frame(neck + 58 * turn(pose.lean + pose.nod - 90), pose.lean + pose.nod)
    for side, limb, label in ((-1, pose.left_leg, "left-leg"), (1, pose.right_leg, "right-leg")):
        picture.group(label)
        _leg(picture, trunk.at(side * 26, 0), side, limb)
    for side, limb, label in ((-1, pose.left_arm, "left-arm"), (1, pose.right_arm, "right-arm")):
        picture.group(label)
        _arm(picture, trunk.at(side * 42, -106), side, limb)
    picture.group("trunk")
    _trunk(picture, trunk)
    picture.group("head")
    _head(picture, head, pose.smile)
    picture.group("cap")
    _cap(picture, head, pose.tip)
    return picture


def _bone(side: float, degrees: float) -> complex:
    """The unit vector of a bone on one side of the body."""
    return turn(90 - side * degrees)


def _leg(picture: Drawing, hip: complex, side: float, limb: Limb) -> None:
    knee = hip + THIGH * _bone(side, limb.near)
    ankle = knee + SHIN * _bone(side, limb.far)
    leg = Tube(bent([hip, knee, ankle]), taper((0, 23), (0.5, 19.5), (1, 17)))
    picture.solid(closed(leg.ring(8)), TROUSERS)
    patch = Tube(leg.edge(0, 0.43, 0.57, 4), taper((0, 19), (1, 19)))
    if side < 0:
        picture.mark(outline(patch.band(0, 1, -0.62, 0.42)), GILET)
        for v in (-0.62, 0.42):
            picture.stroke(line(patch.edge(v, 0, 1, 2)), mix(GILET, INK, 0.4), 2.5)
    picture.shade(outline(leg.band(0.02, 0.9, 0.3 * side, 0.98 * side, 8)))

    shaft = Tube(leg.edge(0, 0.74, 1.0, 8), taper((0, 20.5), (1, 19)))
    foot = Frame(ankle, 90 - side * (90 + limb.end), side)
    sole = [(-20.0, 12.0), (-19.0, 20.0), (0.0, 22.0), (30.0, 22.0), (46.0, 18.0), (49.0, 10.0)]
    upper = [(38.0, -5.0), (20.0, -14.0), (0.0, -22.0), (-18.0, -12.0)]
    picture.solid(outline(shaft.band(0, 1.1, steps=6)), BOOT)
    picture.solid(closed(foot.all([*sole, *upper])), BOOT)
    picture.mark(outline(shaft.band(0, 1.2, -0.94, 0.94, 6)), BOOT)
    picture.shade(outline(shaft.band(0.1, 1.3, 0.3 * side, 0.94 * side, 4)))
    welt = [(49.0, 10.0), (30.0, 13.0), (0.0, 13.0), (-20.0, 12.0)]
    picture.mark(outline([foot.all(sole), foot.all(welt)]), SOLE)
    toe = foot.all([(36, -5), (41, -1), (43, 5)])
    picture.stroke(line(toe), mix(BOOT, "#ffffff", 0.4), 3.5)
    cuff = Tube(leg.edge(0, 0.69, 0.8, 4), taper((0, 22.5), (1, 22.5)))
    picture.solid(outline(cuff.band(0, 1)), WOOL)
    picture.shade(outline(cuff.band(0, 1, 0.3 * side, side)), 0.12)


def _arm(picture: Drawing, shoulder: complex, side: float, limb: Limb) -> None:
    elbow = shoulder + UPPER_ARM * _bone(side, limb.near)
    wrist = elbow + FOREARM * _bone(side, limb.far)
    arm = Tube(bent([shoulder, elbow, wrist]), taper((0, 19), (0.5, 16.5), (1, 16)))
    picture.solid(closed(arm.ring(8)), SLEEVE)
    for start in (0.4, 0.56, 0.72):
        picture.mark(outline(arm.band(start, start + 0.06, -0.97, 0.97)), WOOL)
    picture.shade(outline(arm.band(0.1, 0.9, 0.3 * side, 0.97 * side, 8)))

    hand = Frame(wrist, 90 - side * (limb.far + limb.end), side)
    mitten = hand.all([(-6, -14), (14, -18), (31, -15), (40, 0), (32, 14), (14, 17), (-6, 14)])
    thumb = hand.all([(2, -8), (5, -20), (12, -31), (21, -33), (24, -25), (21, -10)])
    picture.solid(closed(thumb), CAP)
    picture.solid(closed(mitten), CAP)
    below = [(4, 16), (14, 16), (30, 13), (37, 2)], [(29, 4), (14, 7), (4, 7)]
    picture.shade(outline([hand.all(points) for points in below]))
    cuff = Tube(arm.edge(0, 0.88, 1.02, 4), taper((0, 18.5), (1, 18.5)))
    picture.solid(outline(cuff.band(0, 1)), WOOL)
    picture.shade(outline(cuff.band(0, 1, 0.3 * side, side)), 0.12)


def _trunk(picture: Drawing, trunk: Frame) -> None:
    hips = [(0, 24), (24, 25), (44, 14), (49, -8), (48, -24), (0, -26)]
    picture.solid(closed(trunk.mirrored(hips)), TROUSERS)
    picture.stroke(line(trunk.all([(0, 4), (1, 14), (0, 24)])), mix(TROUSERS, INK, 0.5), 3)

    half = [(0, 9), (30, 9), (53, 4), (55, -24), (53, -64), (53, -98), (44, -122), (20, -132)]
    picture.solid(closed(trunk.mirrored([*half, (0, -134)])), GILET)
    for y in (-78, -46, -14):
        seam = trunk.all([(-51, y - 2), (-26, y + 4), (0, y + 5), (26, y + 4), (51, y - 2)])
        picture.stroke(line(seam), mix(GILET, INK, 0.35), 3)
    edge = [(52, 2), (54, -24), (52, -64), (52, -98), (44, -119)]
    inner = [(34, -118), (37, -98), (36, -64), (38, -24), (34, 7)]
    picture.shade(outline([trunk.all(edge), trunk.all(inner)]))
    picture.stroke(line(trunk.all([(0, -112), (0, -50), (0, 7)])), WOOL, 4)
    for side in (-1, 1):
        pocket = trunk.on(side).all([(18, -24), (30, -27), (43, -30)])
        picture.stroke(line(pocket), WOOL, 4)
    _scarf(picture, trunk)


def _scarf(picture: Drawing, trunk: Frame) -> None:
    tail = [(-27, -112), (-9, -110), (-7, -82), (-10, -58), (-28, -60), (-30, -86)]
    picture.solid(closed(trunk.all(tail)), CAP)
    picture.mark(closed(trunk.all([(-29, -76), (-8, -75), (-9, -66), (-28, -68)])), WOOL)
    wrap = [(0, -98), (30, -104), (47, -118), (44, -134), (0, -140)]
    picture.solid(closed(trunk.mirrored(wrap)), CAP)
    for side in (-1, 1):
        half = trunk.on(side)
        stripe = half.all([(22, -102), (32, -106)]), half.all([(36, -134), (24, -134)])
        picture.mark(outline(stripe), WOOL)
    under_chin = [(-42, -128), (-26, -116), (0, -112), (26, -116), (42, -128)]
    picture.shade(outline([trunk.all(under_chin), trunk.all([(30, -138), (0, -139), (-30, -138)])]))


def _head(picture: Drawing, head: Frame, smile: float) -> None:
    for side in (-1, 1):
        half = head.on(side)
        picture.solid(closed(half.oval(72, 10, 13, 15)), SKIN)
        picture.mark(closed(half.oval(74, 11, 6, 8)), mix(SKIN, BLUSH, 0.6))
        lock = [(56, -34), (72, -34), (80, -14), (77, 2), (70, 16), (63, 6), (54, 0)]
        picture.solid(closed(half.all(lock)), HAIR)
    face = [(0, 62), (28, 58), (54, 42), (69, 14), (69, -16), (52, -48), (0, -58)]
    picture.solid(closed(head.mirrored(face)), SKIN)
    chin = [(-48, 47), (-28, 57), (0, 61), (28, 57), (48, 47)]
    above = [(27, 52), (0, 55), (-27, 52)]
    picture.mark(outline([head.all(chin), head.all(above)]), mix(SKIN, BLUSH, 0.45))
    picture.shade(
        outline([head.all([(-68, -3), (0, -9), (68, -3)]), head.all([(66, -34), (-66, -34)])]), 0.1
    )
    left = [(-68, -34), (-71, -8), (-61, 4), (-54, -12), (-42, -10), (-32, -20), (-12, -12)]
    right = [(2, -22), (20, -12), (33, -21), (52, -12), (61, 4), (71, -8), (68, -34)]
    picture.mark(closed(head.all([*left, *right, (0, -50)])), HAIR)

    for side in (-1, 1):
        half = head.on(side)
        picture.mark(closed(half.oval(44, 28, 12, 8)), mix(SKIN, BLUSH, 0.75))
        picture.mark(closed(half.oval(25, 12, 8, 11)), INK)
        picture.mark(closed(head.oval(side * 25 + 2.5, 7.5, 3, 3.6)), "#ffffff")
        brow = half.all([(15, -7), (25, -9.5), (35, -4)])
        picture.stroke(line(brow), mix(HAIR, INK, 0.5), 4)
    picture.stroke(line(head.all([(-4, 24), (0, 27), (5, 24)])), mix(SKIN, "#b04a3c", 0.7), 4)
    _mouth(picture, head, smile)


def _mouth(picture: Drawing, head: Frame, smile: float) -> None:
    wide, deep = 17 + 3 * smile, 1.5 + 14 * smile
    upper = [(-wide, 36), (-9, 39), (0, 40), (9, 39), (wide, 36)]
    lower = [
        (wide, 36),
        (10, 39 + 0.85 * deep),
        (0, 40 + deep),
        (-10, 39 + 0.85 * deep),
        (-wide, 36),
    ]
    lips = outline([head.all(upper), head.all(lower)])
    picture.mark(lips, "#8c2f39")
    tongue = [(-9, 38 + 0.8 * deep), (0, 40 + 0.5 * deep), (9, 38 + 0.8 * deep)]
    picture.mark(outline([head.all(tongue), head.all(lower[1:4])]), "#f2777a")
    picture.stroke(lips, "#5b1f33", 3)


def _cap(picture: Drawing, head: Frame, tip: tuple[float, float]) -> None:
    middle, end = tip
    spine = swept(head.at(0, -54), head.degrees - 90, head.degrees + middle, 44)
    spine += swept(spine[-1], head.degrees + middle, head.degrees + end, 92)[1:]
    tail = Tube(spine, taper((0, 53), (0.5, 26), (1, 11)))
    picture.solid(outline(tail.band(0, 1, steps=14)), CAP)
    dome = [(0, -92), (34, -88), (60, -66), (73, -34), (40, -24), (0, -22)]
    picture.solid(closed(head.mirrored(dome)), CAP)
    picture.mark(outline(tail.band(0.02, 1, -0.96, 0.96, 14)), CAP)
    picture.shade(outline(tail.band(0.36, 1, 0.25, 0.95, 8)))
    picture.shade(
        outline([head.all([(74, -44), (66, -66), (48, -78)]), head.all([(50, -60), (52, -44)])])
    )
    pompom = tail.frame(1.0)
    picture.solid(closed(pompom.oval(9, 0, 20, 20)), WOOL)
    for x, y in ((1, -7), (13, -5), (6, 7), (19, 5)):
        curl = [pompom.at(x - 4, y), pompom.at(x, y + 3), pompom.at(x + 4, y)]
        picture.stroke(line(curl), mix(WOOL, "#c9a98b", 0.8), 2.5)
    band = [(0, -20), (40, -23), (76, -30), (81, -42), (73, -53), (40, -45), (0, -42)]
    picture.solid(closed(head.mirrored(band)), WOOL)
    for x in range(-60, 61, 15):
        y = -43 - 7 * (x / 60) ** 2
        rib = head.all([(x, y + 5), (x * 1.03, y + 17)])
        picture.stroke(line(rib), mix(WOOL, "#c9a98b", 0.6), 2.5)
