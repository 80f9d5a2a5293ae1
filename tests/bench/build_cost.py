# SPDX-License-Identifier: Apache-2.0
"""What builds cost on one core, and how that grows with drawings and their points.

    build/venv/bin/python tests/bench/build_cost.py [--rounds R] [--cpu C] [--plot FILE]

Prints Markdown, and draws the growth if asked to, which needs matplotlib.  Every figure is the
least of R rounds, by what the build reports of its stages, in a service that may use one core only;
the spread says how far the other rounds were above it.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import posespace
from numpy.typing import NDArray

TESTS = Path(__file__).resolve().parents[1]
for folder in ("support", "quality", "client"):
    sys.path.append(str(TESTS / folder))

from families import family  # noqa: E402
from outlines import edge_lengths, turns  # noqa: E402
from PIL import Image  # noqa: E402
from synthetic_drawings import WALK, figure  # noqa: E402

Points = NDArray[np.float64]
Upload = Callable[[posespace.Session], None]

SIDE = 512  # pixels of a sprite
FIGURES = {**WALK, "jump": {"left_arm": -130, "right_arm": 130, "left_leg": -40, "right_leg": 35}}


def limbs(count: int, points: int) -> Upload:
    """So many articulated figures whose outlines are rough, of so many points each."""
    random = np.random.default_rng(1)
    rings = [
        _rough(ring, points, random) for ring in family("articulated").group(count).rings.values()
    ]

    def upload(session: posespace.Session) -> None:
        for k, ring in enumerate(rings):
            session.put_shape(str(k), polygon=ring)

    return upload


def sprites() -> Upload:
    """The FIGURES, their longer side of SIDE pixels."""

    def upload(session: posespace.Session) -> None:
        for name, pose in FIGURES.items():
            picture = Image.fromarray(figure(**pose))
            scale = SIDE / max(picture.size)
            size = (round(scale * picture.width), round(scale * picture.height))
            session.put_shape(name, image=np.asarray(picture.resize(size)))

    return upload


def cost(client: posespace.Client, upload: Upload, rounds: int) -> tuple[dict[str, float], float]:
    """Seconds by stage of the fastest round, and the slowest round's share above it."""
    found = []
    for _ in range(rounds):
        session = client.create_session()
        upload(session)
        found.append(session.build().seconds)
        session.delete()
    totals = [sum(seconds.values()) for seconds in found]
    return found[int(np.argmin(totals))], max(totals) / min(totals) - 1


def _rough(ring: Points, count: int, random: np.random.Generator) -> Points:
    """The ring at even places, each moved a little."""
    closed, at = np.vstack([ring, ring[:1]]), np.append(turns(ring), 1.0)
    even = np.arange(count) / count
    places = np.stack([np.interp(even, at, closed[:, k]) for k in range(2)], axis=1)
    return places + 0.1 * edge_lengths(ring).sum() / count * random.uniform(-1, 1, places.shape)


STAGES = ("matching", "simplification", "triangulation", "improvement", "alignment", "weights")
PLOTTED = tuple(stage for stage in STAGES if stage != "triangulation")  # under a millisecond


def line(name: str, seconds: dict[str, float], spread: float, target: str = "") -> str:
    cells = " | ".join(f"{seconds.get(stage, 0.0):.3f}" for stage in STAGES)
    return f"| {name} | {cells} | {sum(seconds.values()):.2f} | {spread:.0%} | {target} |"


def exponents(sizes: list[int], costs: list[dict[str, float]]) -> str:
    """Of the powers of the size that fit best, the total's and each stage's that matters."""

    def power(values: list[float]) -> float:
        return float(np.polyfit(np.log(sizes), np.log(np.maximum(values, 1e-5)), 1)[0])

    total = power([sum(c.values()) for c in costs])
    largest = costs[-1]
    parts = [
        f"{stage} {power([c.get(stage, 0.0) for c in costs]):.1f}"
        for stage in sorted(STAGES, key=lambda s: -largest.get(s, 0.0))
        if largest.get(stage, 0.0) >= 0.05 * sum(largest.values())
    ]
    return f"total {total:.1f} ({', '.join(parts)})"


def plot(file: Path, panels: dict[str, tuple[list[int], list[dict[str, float]]]]) -> None:
    """Seconds by size, both logarithmic: the total and each stage, a panel for each size."""
    import matplotlib.pyplot as plt

    plt.rcParams["svg.fonttype"] = "none"
    figure, axes = plt.subplots(1, len(panels), figsize=(9, 3.6), sharey=True)
    for axis, (name, (sizes, costs)) in zip(axes, panels.items(), strict=True):
        axis.plot(sizes, [sum(c.values()) for c in costs], "k-o", label="total")
        for stage in PLOTTED:
            axis.plot(sizes, [c.get(stage, 0.0) for c in costs], "-", marker=".", label=stage)
        axis.set(xscale="log", yscale="log", ylim=(1e-3, None), xlabel=name)
        axis.set_xticks(sizes, [f"{size:,}" for size in sizes])
        axis.minorticks_off()
        axis.grid(alpha=0.3)
    axes[0].set_ylabel("seconds")
    axes[-1].legend(fontsize=8, loc="center left", bbox_to_anchor=(1.0, 0.5))
    figure.tight_layout()
    figure.savefig(file, format="svg", metadata={"Date": None, "Creator": None})
    head, rest = file.read_text().split("\n", 1)
    file.write_text(f"{head}\n<!-- SPDX-License-Identifier: Apache-2.0 -->\n{rest}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--cpu", type=int, default=max(os.sched_getaffinity(0)))
    parser.add_argument("--plot", type=Path, metavar="FILE", help="an SVG")
    arguments = parser.parse_args()
    os.sched_setaffinity(0, {arguments.cpu})  # what the service inherits
    with (
        posespace.serve_locally() as server,
        posespace.connect(server.address, timeout=120) as client,
    ):

        def measured(upload: Upload) -> tuple[dict[str, float], float]:
            return cost(client, upload, arguments.rounds)

        print("| seconds | " + " | ".join(STAGES) + " | total | spread | target |")
        print("|---" * (len(STAGES) + 4) + "|")
        print(line("4 polygons of 1,000 points", *measured(limbs(4, 1000)), "< 1"))
        print(line("8 polygons of 1,000 points", *measured(limbs(8, 1000)), "< 3"))
        print(line(f"{len(FIGURES)} sprites of {SIDE} px, aligned", *measured(sprites()), "< 2"))
        counts, points = [2, 3, 4, 5, 6, 7, 8], [100, 300, 1000, 3000]
        by_count = [measured(limbs(count, 1000)) for count in counts]
        by_points = [measured(limbs(4, n)) for n in points]
        for count, found in zip(counts, by_count, strict=True):
            print(line(f"N = {count}, n = 1,000", *found))
        for n, found in zip(points, by_points, strict=True):
            print(line(f"N = 4, n = {n:,}", *found))
    if arguments.plot:
        only = [found for found, _ in by_count], [found for found, _ in by_points]
        plot(
            arguments.plot,
            {
                "drawings of 1,000 points": (counts, only[0]),
                "points of each of 4 drawings": (points, only[1]),
            },
        )
    print(f"\nPower of N: {exponents(counts, [found for found, _ in by_count])}.")
    print(f"Power of n: {exponents(points, [found for found, _ in by_points])}.")


if __name__ == "__main__":
    main()
