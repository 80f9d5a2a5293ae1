# SPDX-License-Identifier: Apache-2.0
"""What each rotation refit of a rigid blend buys on real drawings, and what it costs.

    build/venv/bin/python tests/bench/refits.py [--blends B]

Prints Markdown: of B random in-betweens of each real group (50 unless told) how many fold; how far
edge lengths are from their mean in the drawings; and microseconds a pose of 341 vertices and 6
drawings, measured by blend_bench (CPU time).
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import posespace

TESTS = Path(__file__).resolve().parents[1]
for folder in ("support", "quality"):
    sys.path.append(str(TESTS / folder))

from measures import blending  # noqa: E402
from real_groups import ROOT, all_groups  # noqa: E402

REFITS = (0, 1, 2, 3)
MICROSECONDS = 1e6


def quality(blends: int) -> dict[int, tuple[int, float, float]]:
    """Of each number of refits: frames that fold, edge errors' median and mean over groups."""
    folded = dict.fromkeys(REFITS, 0)
    errors: dict[int, list[float]] = {refits: [] for refits in REFITS}
    with posespace.serve_locally() as server, posespace.connect(server.address) as client:
        for group in all_groups():
            session = client.create_session()
            group.upload(session)
            session.build()
            mesh = session.mesh()
            for refits in REFITS:
                found = blending(session, mesh, "rigid", blends=blends, refits=refits)
                folded[refits] += found.folded
                errors[refits].append(found.edge_rms)
            session.delete()
    return {
        refits: (folded[refits], float(np.median(found)), float(np.mean(found)))
        for refits, found in errors.items()
    }


def seconds(kind: str) -> dict[int, float]:
    """A pose, by number of refits."""
    with tempfile.NamedTemporaryFile(suffix=".json") as out:
        subprocess.run(
            [
                ROOT / "build/bin/blend_bench",
                f"--benchmark_filter={kind}/vertices:341/poses:6/",
                f"--benchmark_out={out.name}",
                "--benchmark_out_format=json",
                "--benchmark_min_time=0.5",
            ],
            check=True,
            stdout=subprocess.DEVNULL,
        )
        found = json.load(out)["benchmarks"]
    return {int(row["name"].rsplit(":", 1)[1]): row["seconds_per_pose"] for row in found}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--blends", type=int, default=50)
    blends = parser.parse_args().blends
    batch, single = seconds("batch"), seconds("single")
    print("| refits | in-betweens that fold | edge rms, median | mean | batch, us | single, us |")
    print("|---|---|---|---|---|---|")
    for refits, (folded, median, mean) in quality(blends).items():
        print(
            f"| {refits} | {folded} of {blends * len(all_groups()):,} | {median:.4f} | {mean:.4f} "
            f"| {MICROSECONDS * batch[refits]:.1f} | {MICROSECONDS * single[refits]:.1f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
