# SPDX-License-Identifier: Apache-2.0
"""The whole road once: drawings in, blended drawings out, pictures of everything on the way.

Starts posespaced, uploads each set of deploy/drawings, builds its pose space, plays a path through
it over the stream, and writes pictures.  Usage: demo.py --out DIR [SET...]
"""

from __future__ import annotations

import argparse
import io
import json
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import posespace
from demo_pictures import (
    mark_placements,
    mesh_over_drawing,
    on_paper,
    sheet,
    smooth_path,
    weight_field,
)
from PIL import Image

DRAWINGS = Path(__file__).resolve().parent / "drawings"
CELL = 220  # pixels of a contact sheet's cell
FRAMES_A_LEG = 18  # frames between two stops of the path
FPS = 30


def png_of(svg: Path) -> bytes:
    """An SVG drawing as a PNG with alpha."""
    done = subprocess.run(["rsvg-convert", str(svg)], check=True, capture_output=True)
    return done.stdout


def show_progress(stage: str, fraction: float) -> None:
    """One line that grows on a terminal; silent elsewhere."""
    if sys.stdout.isatty():
        bar = "#" * round(30 * fraction)
        print(f"\r  building [{bar:<30}] {fraction:4.0%} {stage:<16}", end="", flush=True)


def picture(pixels: np.ndarray) -> Image.Image:
    return Image.fromarray(pixels, "RGBA")


def show_set(client: posespace.Client, name: str, plan: dict[str, Any], out: Path) -> None:
    """Uploads, builds, plays and pictures one set of drawings."""
    pngs = {
        Path(file).stem.removeprefix(f"{name}-"): png_of(DRAWINGS / file)
        for file in plan["drawings"]
    }
    placements = {id: tuple(at) for id, at in plan["placements"].items()}

    session = client.create_session(display_name=plan.get("title", name))
    print(f"\n{name}: {len(pngs)} drawings")
    for shape_id, png in pngs.items():
        for warning in session.put_shape(shape_id, image=png).warnings:
            print(f"  {shape_id}: {warning}")
    marks = [
        {id: tuple(at) for id, at in places.items()} for places in plan.get("correspondences", [])
    ]
    if marks:
        session.set_correspondences(marks)
    session.set_placements(placements)
    report = session.build(on_progress=show_progress)
    if sys.stdout.isatty():
        print()
    print(
        f"  built in {sum(report.seconds.values()):.2f} s: {report.vertices} vertices, "
        f"{report.triangles} triangles, {report.steiner_vertices} Steiner vertices, "
        f"smallest angle {np.degrees(report.min_angle):.1f} degrees"
    )
    for warning in report.warnings:
        print(f"  {warning}")

    mesh = session.mesh()
    path = smooth_path(np.array(plan["path"], dtype=float), FRAMES_A_LEG)
    start = time.perf_counter()
    with session.play() as player:
        frames = list(player.frames(path))
    seconds = time.perf_counter() - start
    print(
        f"  played {len(frames)} frames over the stream in {seconds * 1e3:.0f} ms "
        f"({len(frames) / seconds:.0f} a second), {sum(f.folds for f in frames)} folded triangles"
    )

    folder = out / name
    folder.mkdir(parents=True, exist_ok=True)
    drawings = {id: Image.open(io.BytesIO(png)).convert("RGBA") for id, png in pngs.items()}

    def save(file: str, image: Image.Image, what: str, **options: Any) -> None:
        image.save(folder / file, **options)
        print(f"  {folder / file}  {what}")

    animation = [on_paper(picture(session.render(at=tuple(at), size=(320, 320)))) for at in path]
    save(
        "animation.png",
        animation[0],
        "the path, animated",
        save_all=True,
        append_images=animation[1:],
        duration=1000 // FPS,
        loop=0,
    )
    ids = list(mesh.vertices)
    between = {
        "halfway to the next": [
            picture(session.render(weights={a: 0.5, b: 0.5}, size=(CELL, CELL)))
            for a, b in zip(ids, ids[1:] + ids[:1], strict=True)
        ],
        "along the path": [
            picture(session.render(at=tuple(at), size=(CELL, CELL)))
            for at in path[FRAMES_A_LEG // 2 :: FRAMES_A_LEG]
        ],
    }
    save(
        "contact-sheet.png",
        sheet(
            [list(drawings.values()), *between.values()],
            ["as drawn: " + ", ".join(ids), *between],
            CELL,
        ),
        "the drawings and what lies between them",
    )
    meshes = [
        mesh_over_drawing(drawings[id], mesh.vertices[id], mesh.triangles, mesh.boundary)
        for id in ids
    ]
    save(
        "meshes.png",
        sheet([meshes], ["one triangle list, valid in every drawing"], 2 * CELL),
        "the meshes",
    )

    places = np.array(list(placements.values()))
    side = 2.0 * max(np.ptp(places, axis=0).max(), 1.0)
    left, top = places.mean(axis=0) - side / 2
    size = 180
    steps = (np.arange(size) + 0.5) / size * side
    grid = np.stack(np.meshgrid(left + steps, top + steps), axis=-1).reshape(-1, 2)
    field = weight_field(session.weights(grid), size)
    field = field.resize((3 * size, 3 * size), Image.Resampling.BILINEAR)
    mark_placements(field, placements, (left, top, side))
    save("weights.png", field, "the weight field over pose space")
    session.delete()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="folder for the pictures")
    parser.add_argument("sets", nargs="*", help="sets of drawings to show; all by default")
    arguments = parser.parse_args()
    plans = json.loads((DRAWINGS / "placements.json").read_text())
    unknown = set(arguments.sets) - set(plans)
    if unknown:
        parser.error(f"no such set: {', '.join(sorted(unknown))}; there are {', '.join(plans)}")
    with posespace.serve_locally(store="memory") as server:
        print(f"posespaced answers at {server.address}")
        with posespace.connect(server.address) as client:
            for name in arguments.sets or plans:
                show_set(client, name, plans[name], arguments.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
