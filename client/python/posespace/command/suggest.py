# SPDX-License-Identifier: Apache-2.0
"""posespace suggest: how automatic matching understands a session's drawings."""

from __future__ import annotations

import argparse
from pathlib import Path

from posespace.client import Client
from posespace.command import output
from posespace.command.arc_sheet import arc_sheet
from posespace.command.parsers import Commands
from posespace.command.progress import Progress
from posespace.files import whole_file
from posespace.results import Suggestion

_DOUBTFUL = 0.5  # confidence below which a person should look

_MORE = """\
Says how clear the matching of each drawing is, and which drawings seem to face
the other way.  Nothing is changed: look at the picture, where one colour is the
same place of every outline, then mark places (build --landmarks) or accept a
flip (build --flip).

example:
  posespace suggest tux -o tux-matching.png
"""


def add(commands: Commands) -> None:
    parser = commands.add("suggest", "say how drawings would be matched", _MORE, run)
    parser.add_argument("session", metavar="SESSION", help="a session, built or not")
    parser.add_argument(
        "-o", "--out", metavar="FILE.png", type=Path, help="draw the matched outlines"
    )
    parser.add_argument(
        "--rotation",
        choices=["upright", "any"],
        default="upright",
        help="whether drawings stand upright (the default) or may be turned at will",
    )


def run(client: Client, arguments: argparse.Namespace) -> None:
    session = client.session(arguments.session)
    with Progress() as progress:
        progress.show("matching")
        found = session.suggest(samples=256, rotation=arguments.rotation)
        if arguments.out is not None:
            outlines = {shape.id: shape.outline[0] for shape in session.shapes()}
            with whole_file(arguments.out) as file:
                arc_sheet(found, outlines).save(file, format="PNG")
    if arguments.json:
        output.print_json(
            {
                "session": session.id,
                "confidence": found.confidence,
                "flips": found.flips,
                "flip_gain": found.flip_gain,
                "starts": found.starts,
                "arcs": found.arcs,
                "etag": found.etag,
                "file": arguments.out,
            }
        )
    else:
        print("\n".join(_lines(session.id, found, arguments.out)))


def _lines(session_id: str, found: Suggestion, out: Path | None) -> list[str]:
    rows = [
        [name, f"{sure:.2f}", "please look at it" if sure < _DOUBTFUL else ""]
        for name, sure in found.confidence.items()
    ]
    lines = [output.table(["drawing", "confidence", ""], rows)]
    if found.flips:
        names = " ".join(f"--flip {name}" for name in found.flips)
        lines += [
            f"seem to face the other way: {', '.join(found.flips)} "
            f"(matching is {found.flip_gain:.2f} times as cheap with them flipped)",
            f"if they do: posespace build FILES --session {session_id} {names} --out DIR",
        ]
    return lines if out is None else [*lines, f"wrote {out}"]
