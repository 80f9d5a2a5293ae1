# SPDX-License-Identifier: Apache-2.0
"""posespace inspect: what a session is made of and how its build went."""

from __future__ import annotations

import argparse
import math

from posespace.client import Client
from posespace.command import output
from posespace.command.documents import Document, session_document
from posespace.command.parsers import Commands

_MORE = """\
Drawings with the size of their outlines, how clear their matching was and what
was done to them; their places in pose space; marked places; the mesh; how the
latest build went.

examples:
  posespace inspect tux
  posespace inspect tux --json
"""


def add(commands: Commands) -> None:
    parser = commands.add("inspect", "say what a session is made of", _MORE, run)
    parser.add_argument("session", metavar="SESSION", help="a session")


def run(client: Client, arguments: argparse.Namespace) -> None:
    document = session_document(client.session(arguments.session))
    if arguments.json:
        output.print_json(document)
    else:
        print("\n".join(_lines(document)))


def _lines(document: Document) -> list[str]:
    name = f" ({document['display_name']})" if document["display_name"] else ""
    lines = [f"session {document['session']}{name}", ""]
    lines += _drawings(document) + _marks(document["correspondences"])
    if document["report"] is not None:
        lines += _mesh(document["revision"], document["report"])
    return [*lines, _build(document["build"])]


def _drawings(document: Document) -> list[str]:
    if not document["shapes"]:
        return ["no drawings"]
    rows = []
    for shape in document["shapes"]:
        width, height = shape["size"]
        at, confidence = shape["placement"], shape["confidence"]
        rows.append(
            [
                shape["id"],
                f"{width:g} x {height:g}",
                " + ".join(map(str, shape["outline_points"])),
                str(shape["holes_filled"]),
                "-" if confidence is None else f"{confidence:.2f}",
                "nowhere yet" if at is None else output.place(at),
            ]
        )
    header = ["drawing", "size", "outline points", "holes filled", "confidence", "place"]
    lines = [output.table(header, rows)]
    if document["placements_are_default"]:
        lines.append("places are the default: the unit circle in the order of upload")
    for shape in document["shapes"]:
        lines += [f"{shape['id']}: {warning}" for warning in shape["warnings"]]
    return lines


def _marks(correspondences: list[dict[str, tuple[float, float]]]) -> list[str]:
    if not correspondences:
        return []
    rows = [
        [str(k), ", ".join(f"{name} {output.place(at)}" for name, at in sorted(places.items()))]
        for k, places in enumerate(correspondences)
    ]
    return ["", output.table(["mark", "where"], rows)]


def _mesh(revision: str, report: Document) -> list[str]:
    levels = ", ".join(f"{count} {level}" for level, count in report["levels"].items())
    seconds = ", ".join(f"{stage} {spent:.2f}" for stage, spent in report["seconds"].items())
    rows = [
        ["revision", revision],
        ["vertices", f"{report['vertices']:,}"],
        ["triangles", f"{report['triangles']:,}"],
        ["outline vertices", f"{report['outline_vertices']:,} before refinement"],
        ["Steiner vertices", f"{report['steiner_vertices']:,} before refinement"],
        ["smallest angle", f"{math.degrees(report['min_angle']):.1f} degrees"],
        ["levels", levels],
        ["seconds", seconds],
    ]
    return ["", output.table(["mesh", ""], rows), *report["warnings"]]


def _build(build: Document | None) -> str:
    if build is None:
        return "\nnot built yet"
    line = f"\nthe latest build: {build['state']}"
    if build["state"] in ("queued", "running"):
        line += f", {build['fraction']:.0%} {build['stage']}"
    return f"{line}: {build['error']}" if build["error"] else line
