# SPDX-License-Identifier: Apache-2.0
"""Compares our in-betweens of outlines with those of libraries that morph paths.

    build/venv/bin/python tests/bench/peers/compare.py [--out FILE]

Installs the libraries of package.json with npm in build/peers, where nothing else looks; needs node
and npm.  Prints the table that README.md explains.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import posespace
from numpy.typing import NDArray

ROOT = Path(__file__).resolve().parents[3]
for folder in ("support", "quality"):
    sys.path.append(str(ROOT / "tests" / folder))

from exact_mesh_checks import crossings  # noqa: E402
from families import family  # noqa: E402
from nasty_polygons import SIMPLE  # noqa: E402
from outlines import edge_lengths, signed_area, turns, turns_of  # noqa: E402
from real_groups import all_groups  # noqa: E402

Points = NDArray[np.float64]

OURS = "posespace"
NEARLY = 1e-6  # libraries answer the drawings themselves, with their own points, at 0 and 1
TIMES = [NEARLY, *(k / 10 for k in range(1, 10)), 1 - NEARLY]
MANY = 1000  # of our frames in a call that is timed
SAMPLES = 200  # moving points whose distances are measured
GENERATED = (
    "articulated", "glyph-S", "glyph-2", "glyph-G", "glyph-E", "bent-bars", "combs", "star-shaped",
    "random-simple", "spirals",
)  # fmt: skip
REAL = (
    "recursive-lc", "recursive-ls", "recursive-lw", "recursive-lz", "lottie-bacon-3", "lato-lk",
    "kenney-robot-walk", "kenney-malePerson-actions", "fluent-big-mammals", "fluent-hand-open",
    "openclipart-contour-birds",
)  # fmt: skip


@dataclass(frozen=True)
class Pair:
    """Two rings; `known`: their corners where row k of both is the same place."""

    name: str
    a: Points
    b: Points
    known: tuple[Points, Points] | None


@dataclass(frozen=True)
class Frames:
    """A pair's in-betweens at TIMES, and what one costs."""

    rings: list[Points]
    microseconds: float


@dataclass(frozen=True)
class Measures:
    """Of a pair's nine in-betweens.

    crossing     How many cross themselves.
    area         The least area over the mean of the drawings' areas weighted as the frame is.
    edge_rms     Log ratio of the lengths between moving points to the weighted mean of their
                 lengths in the drawings, root mean square, mean over frames.
    slip         How far known places are put from where they belong, mean, % of the perimeter.
    microseconds A frame, as often as it is asked for.
    """

    crossing: int
    area: float
    edge_rms: float
    slip: float | None
    microseconds: float


def pairs(client: posespace.Client) -> list[Pair]:
    found = []
    for name in GENERATED:
        drawn = family(name).group(2)
        a, b = drawn.rings.values()
        found.append(Pair(name, a, _as_if_of_other_origin(b), (a, b) if drawn.known else None))
    bat = SIMPLE["bat-and-star"]
    found.append(Pair("bat and star", bat["bat"], bat["star"], None))
    for group in all_groups():
        if group.name not in REAL:
            continue
        session = client.create_session()
        group.upload(session)
        shapes = session.shapes()
        first, last = shapes[0], shapes[-1]
        places = group.places
        known = (places[first.id], places[last.id]) if places is not None else None
        found.append(Pair(group.name, first.outline[0], last.outline[0], known))
        session.delete()
    return found


def _as_if_of_other_origin(ring: Points) -> Points:
    """The same outline, begun at another row and with more rows: row numbers tell nothing."""
    middles = (ring + np.roll(ring, -1, axis=0)) / 2
    long = edge_lengths(ring) > np.median(edge_lengths(ring))
    rows = [row for k in range(len(ring)) for row in (ring[k], middles[k])[: 1 + long[k]]]
    return np.roll(np.array(rows), len(rows) // 3, axis=0)


def our_frames(client: posespace.Client, pair: Pair) -> Frames:
    """The mesh's outline in every in-between; it encloses the drawings' within the tolerance.  The
    time is that of whole meshes, asked for over gRPC by this client, many in a call."""
    session = client.create_session()
    session.put_shape("a", polygon=pair.a)
    session.put_shape("b", polygon=pair.b)
    session.build()
    rim = session.mesh().boundary[0]
    frames = [session.blend(weights={"a": 1 - t, "b": t}).vertices[rim] for t in TIMES]
    session.set_placements({"a": (0.0, 0.0), "b": (1.0, 0.0)})
    walk = np.stack([np.linspace(0, 1, MANY), np.zeros(MANY)], axis=1)
    took = []
    for _ in range(9):
        start = time.perf_counter()
        session.blend_many(walk)
        took.append((time.perf_counter() - start) / MANY)
    session.delete()
    return Frames([frame.astype(float) for frame in frames], 1e6 * float(np.median(took)))


def their_frames(found: list[Pair]) -> dict[str, list[Frames | None]]:
    folder = ROOT / "build/peers"
    folder.mkdir(parents=True, exist_ok=True)
    for name in ("package.json", "frames.mjs"):
        shutil.copy(Path(__file__).with_name(name), folder)
    npm = ["npm", "install", "--silent", "--no-audit", "--no-fund"]
    subprocess.run(npm, cwd=folder, check=True)
    asked = {"pairs": [{"a": p.a.tolist(), "b": p.b.tolist()} for p in found], "times": TIMES}
    answered = subprocess.run(
        ["node", "frames.mjs"],
        cwd=folder,
        input=json.dumps(asked),
        capture_output=True,
        text=True,
        check=True,
    )
    frames: dict[str, list[Frames | None]] = {}
    for library, answers in json.loads(answered.stdout).items():
        frames[library] = []
        for pair, answer in zip(found, answers, strict=True):
            if "error" in answer:
                print(f"{library}, {pair.name}: {answer['error']}", file=sys.stderr)
                frames[library].append(None)
                continue
            rings = [np.array(ring, dtype=float) for ring in answer["rings"]]
            frames[library].append(Frames(rings, answer["microseconds"]))
    return frames


def measure(pair: Pair, frames: Frames) -> Measures:
    first, *between, last = frames.rings
    # Moving points are even along the first drawing; each stays at its place between two vertices.
    shares = np.interp(
        np.arange(SAMPLES) / SAMPLES, np.append(turns(first), 1.0), np.arange(len(first) + 1)
    )

    def moved(ring: Points) -> Points:
        closed = np.vstack([ring, ring[:1]])
        index = np.arange(len(closed))
        return np.stack([np.interp(shares, index, closed[:, k]) for k in range(2)], axis=1)

    def lengths(ring: Points) -> Points:
        points = moved(ring)
        return np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)

    ratios, areas = [], []
    for t, ring in zip(TIMES[1:-1], between, strict=True):
        wanted = (1 - t) * lengths(first) + t * lengths(last)
        usable = wanted > 1e-6 * wanted.max()
        least = 1e-3 * wanted[usable]
        ratio = np.log(np.maximum(lengths(ring)[usable], least) / wanted[usable])
        ratios.append(np.sqrt(np.mean(ratio**2)))
        area = (1 - t) * abs(signed_area(first)) + t * abs(signed_area(last))
        areas.append(abs(signed_area(ring)) / area)
    return Measures(
        crossing=sum(bool(crossings(_without_repeats(ring))) for ring in between),
        area=min(areas),
        edge_rms=float(np.mean(ratios)),
        slip=None if pair.known is None else slip(pair.known, first, last),
        microseconds=frames.microseconds,
    )


def slip(known: tuple[Points, Points], first: Points, last: Points) -> float:
    """Mean distance along the second drawing, % of its perimeter."""
    a, b = known
    on_first = np.append(turns(first), 1.0)
    index = np.interp(turns_of(a, first), on_first, np.arange(len(first) + 1))
    closed = np.vstack([last, last[:1]])
    carried = np.stack(
        [np.interp(index, np.arange(len(closed)), closed[:, k]) for k in range(2)], axis=1
    )
    apart = turns_of(carried, b) - turns(b)
    return 100 * float(np.mean(np.abs(apart - np.round(apart))))


def _without_repeats(ring: Points) -> Points:
    """Without rows that lie on the row before, which libraries insert."""
    apart = np.linalg.norm(ring - np.roll(ring, 1, axis=0), axis=1)
    return ring[apart > 1e-9 * np.ptp(ring)]


def table(found: list[Pair], measured: dict[str, list[Measures | None]]) -> str:
    libraries = list(measured)
    lines = [
        "| pair | " + " | ".join(libraries) + " |",
        "|---" * (len(libraries) + 1) + "|",
    ]
    for k, pair in enumerate(found):
        lines.append(
            f"| {pair.name} | " + " | ".join(_cell(measured[x][k]) for x in libraries) + " |"
        )
    over = []
    for library in libraries:
        rows = [row for row in measured[library] if row is not None]
        slips = [row.slip for row in rows if row.slip is not None]
        over.append(
            f"{sum(row.crossing for row in rows)} of {9 * len(rows)} · "
            f"{np.median([row.area for row in rows]):.2f} · "
            f"{np.median([row.edge_rms for row in rows]):.2f} · {np.median(slips):.1f}"
        )
    lines.append("| **crossing in all; medians** | " + " | ".join(over) + " |")
    lines.append("| **microseconds a frame** | " + " | ".join(_times(measured)) + " |")
    return "\n".join(lines) + "\n"


def _times(measured: dict[str, list[Measures | None]]) -> list[str]:
    """Median and extremes over pairs."""
    cells = []
    for rows in measured.values():
        times = [row.microseconds for row in rows if row is not None]
        cells.append(f"{np.median(times):.0f} ({min(times):.0f}-{max(times):.0f})")
    return cells


def _cell(row: Measures | None) -> str:
    if row is None:
        return "failed"
    slipped = "" if row.slip is None else f" · {row.slip:.1f}"
    return f"{row.crossing} · {row.area:.2f} · {row.edge_rms:.2f}{slipped}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, help="write the table here, too")
    arguments = parser.parse_args()
    with (
        posespace.serve_locally() as server,
        posespace.connect(server.address, timeout=120) as client,
    ):
        found = pairs(client)
        frames: dict[str, list[Frames | None]] = {
            OURS: [our_frames(client, pair) for pair in found],
            **their_frames(found),
        }
    measured = {
        library: [
            None if row is None else measure(pair, row)
            for pair, row in zip(found, rows, strict=True)
        ]
        for library, rows in frames.items()
    }
    text = table(found, measured)
    print(text)
    if arguments.out:
        arguments.out.write_text(text)


if __name__ == "__main__":
    main()
