# SPDX-License-Identifier: Apache-2.0
"""posespace blend and render: one drawing of a pose space, as numbers or as a picture."""

from __future__ import annotations

import argparse
from pathlib import Path

from posespace.client import Client
from posespace.command import output
from posespace.command.parsers import Commands
from posespace.command.values import point, size, weights
from posespace.errors import InvalidArgument
from posespace.files import whole_file
from posespace.pictures import encode_png

_BLEND = """\
The answer is JSON: "vertices" [[x, y], ...] in drawing pixels and the order of
mesh.json, "weights" and "texture_weights" by drawing, "folds" (0 in a good
frame), "revision".

examples:
  posespace blend tux --at 0,0.5
  posespace blend tux --weights stand=0.5,jump=0.5
"""

_RENDER = """\
The picture has the drawing's transparency.  All pictures of a built session
show the same part of the plane, so that they fit over each other.

example:
  posespace render tux --at 0,0.5 --size 640x480 -o tux.png
"""


def add(commands: Commands) -> None:
    blend = commands.add("blend", "answer one frame as JSON", _BLEND, run_blend)
    _add_position(blend)
    render = commands.add("render", "draw one picture", _RENDER, run_render)
    _add_position(render)
    render.add_argument(
        "--size", metavar="WxH", type=size, default=(512, 512), help="pixels; default 512x512"
    )
    render.add_argument(
        "-o", "--out", metavar="FILE.png", type=Path, required=True, help="the file"
    )


def _add_position(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("session", metavar="SESSION", help="a built session")
    position = parser.add_mutually_exclusive_group(required=True)
    position.add_argument("--at", metavar="X,Y", type=point, help="a point of pose space")
    position.add_argument(
        "--weights",
        metavar="ID=W,...",
        type=weights,
        help="how much of each drawing; they sum to 1, and those left out weigh 0",
    )


def run_blend(client: Client, arguments: argparse.Namespace) -> None:
    session = client.session(arguments.session)
    frame = session.blend(at=arguments.at, weights=arguments.weights)
    vertices = [[float(f"{number:.9g}") for number in place] for place in frame.vertices.tolist()]
    output.print_json(
        {
            "session": session.id,
            "revision": frame.revision,
            "weights": frame.weights,
            "texture_weights": frame.texture_weights,
            "folds": frame.folds,
            "vertices": vertices,
        }
    )


def run_render(client: Client, arguments: argparse.Namespace) -> None:
    out: Path = arguments.out
    if out.suffix.lower() != ".png":
        raise InvalidArgument(f"{out}: a picture is written as .png")
    session = client.session(arguments.session)
    pixels = session.render(at=arguments.at, weights=arguments.weights, size=arguments.size)
    with whole_file(out) as file:
        file.write(encode_png(pixels, compress_level=6))
    if arguments.json:
        output.print_json({"session": session.id, "file": str(out), "size": arguments.size})
    else:
        print(f"wrote {out}")
