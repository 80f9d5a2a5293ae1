# SPDX-License-Identifier: Apache-2.0
"""posespace animate: a path through pose space as an animation."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Iterator
from pathlib import Path

from posespace.animation_files import Pixels, check_animation_file, save_animation
from posespace.client import Client
from posespace.command import output
from posespace.command.parsers import Commands
from posespace.command.progress import Progress
from posespace.command.values import path, path_file, size

_MORE = """\
The way through the points is a smooth curve.  Points X,Y,SECONDS say when it is
where, all of them or none; without times it goes at even speed, one second from
point to point unless --duration says otherwise.

A path file has a line "x y" or "x y seconds" for each point, '#' for notes, or
is a JSON list [[x, y], [x, y, seconds], ...].

The ending of FILE decides: .png (animated PNG) and .webp keep soft edges; .gif
has 255 colours, pixels that are there or not, and at most 50 frames a second;
DIR/%04d.png is one picture a frame.

examples:
  posespace animate tux --path "0,0 0.5,1 0,1" --loop -o tux.gif
  posespace animate tux --path-file walk.txt --fps 60 -o walk/%04d.png
"""


def add(commands: Commands) -> None:
    parser = commands.add("animate", "draw a path through pose space", _MORE, run)
    parser.add_argument("session", metavar="SESSION", help="a built session")
    way = parser.add_mutually_exclusive_group(required=True)
    way.add_argument("--path", metavar='"X,Y X,Y ..."', type=path, help="points of pose space")
    way.add_argument("--path-file", metavar="FILE", type=Path, help="a file of them")
    parser.add_argument(
        "--fps", metavar="N", type=float, default=30.0, help="frames a second; default 30"
    )
    parser.add_argument(
        "--loop", action="store_true", help="go back to the first point, and play again and again"
    )
    parser.add_argument(
        "--duration", metavar="S", type=float, help="seconds for a path without times"
    )
    parser.add_argument(
        "--easing",
        choices=["uniform", "in-out"],
        default="uniform",
        help="in-out: the path as a whole starts and ends at rest",
    )
    parser.add_argument(
        "--size", metavar="WxH", type=size, default=(512, 512), help="pixels; default 512x512"
    )
    parser.add_argument(
        "-o",
        "--out",
        metavar="FILE",
        type=Path,
        required=True,
        help="FILE.png, FILE.gif, FILE.webp or DIR/%%04d.png",
    )


def run(client: Client, arguments: argparse.Namespace) -> None:
    check_animation_file(arguments.out, arguments.fps)
    waypoints = arguments.path or path_file(arguments.path_file)
    session = client.session(arguments.session)
    frames = session.render_animation(
        waypoints,
        fps=arguments.fps,
        easing=arguments.easing,
        loop=arguments.loop,
        duration=arguments.duration,
        size=arguments.size,
    )
    with Progress() as progress:
        count = save_animation(
            _counted(frames, progress), arguments.out, fps=arguments.fps, loop=arguments.loop
        )
    seconds = count / arguments.fps
    if arguments.json:
        output.print_json(
            {
                "session": session.id,
                "file": str(arguments.out),
                "frames": count,
                "fps": arguments.fps,
                "seconds": seconds,
                "loop": arguments.loop,
                "size": arguments.size,
            }
        )
    else:
        print(f"wrote {arguments.out}: {output.counted(count, 'frame')}, {seconds:.2f} s")


def _counted(frames: Iterable[Pixels], progress: Progress) -> Iterator[Pixels]:
    for count, frame in enumerate(frames, start=1):
        progress.show(f"drawing frame {count}")
        yield frame
