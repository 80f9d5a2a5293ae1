# SPDX-License-Identifier: Apache-2.0
"""The command line.  Exit status: 0 done, 1 refused, 2 usage, 3 service unreachable, 130 Ctrl-C."""

from __future__ import annotations

import argparse
import io
import os
import re
import signal
import sys
import traceback
from collections.abc import Sequence
from importlib.metadata import version
from typing import NoReturn

from posespace.command import animate, build, inspect, output, ping, pose, sessions, suggest
from posespace.command.parsers import Commands, add_common
from posespace.command.service import service
from posespace.errors import DeadlineExceeded, Error, Unavailable
from posespace.local import ProgramNotFound

_REFUSED, _UNREACHABLE = 1, 3
_INTERRUPTED = 128 + signal.SIGINT
_READER_GONE = 128 + signal.SIGPIPE

_MORE = """\
Without --server a command runs a service of its own, which keeps sessions
between calls.

examples:
  posespace build stand.png jump.png wave.png --session tux --out tux
  posespace animate tux --path "1,0 -0.5,0.87 -0.5,-0.87" --loop -o tux.gif

Exit status: 0 done, 1 refused (the message says why), 2 usage, 3 service
unreachable.
"""


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="posespace",
        description="Turns drawings of one character into a plane of drawings.",
        epilog=_MORE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"posespace {version('posespace')}")
    add_common(parser, None)
    commands = Commands(parser.add_subparsers(metavar="COMMAND", required=True))
    for group in (build, suggest, pose, animate, inspect, sessions, ping):
        group.add(commands)
    return parser


def _with_negative_numbers(argv: Sequence[str]) -> list[str]:
    """--at -1,0 as --at=-1,0, which argparse does not take for an option."""
    joined: list[str] = []
    for word in argv:
        if joined and joined[-1] in ("--at", "--path") and re.match(r"-[\d.]", word):
            joined[-1] += "=" + word
        else:
            joined.append(word)
    return joined


def main(argv: Sequence[str] | None = None) -> int:
    """Runs the command line; answers its exit status."""
    parser = _parser()
    arguments = parser.parse_args(_with_negative_numbers(sys.argv[1:] if argv is None else argv))
    if arguments.server is not None and arguments.store is not None:
        parser.error("give either --server or --store: a running service has a store of its own")
    signal.signal(signal.SIGTERM, _end)
    if isinstance(sys.stdout, io.TextIOWrapper):  # names of files and people in any encoding
        sys.stdout.reconfigure(errors="backslashreplace")
    try:
        with service(arguments.server, arguments.store) as client:
            arguments.run(client, arguments)
            print(end="", flush=True)
        return 0
    except BrokenPipeError:
        _say_no_more()
        return _READER_GONE
    except KeyboardInterrupt:
        print("posespace: interrupted", file=sys.stderr)
        return _INTERRUPTED
    except Exception as error:
        return _refuse(error, arguments.json)


def _say_no_more() -> None:
    """Leaves nothing for the interpreter to write, and fail at, when it ends."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _end(number: int, frame: object) -> NoReturn:
    """Ends in order, so that a service of one's own and unfinished files go too."""
    sys.exit(128 + number)


def _refuse(error: Exception, in_json: bool) -> int:
    """Says why, and answers the exit status."""
    message, reason, fields, status = str(error), "", {}, _REFUSED
    if isinstance(error, Error):
        reason, fields = error.reason, error.fields
        out_of_reach = isinstance(error, Unavailable) or (
            isinstance(error, DeadlineExceeded) and not reason
        )
        status = _UNREACHABLE if out_of_reach else _REFUSED
    elif isinstance(error, ProgramNotFound):
        status = _UNREACHABLE
    elif isinstance(error, OSError):
        said = error.strerror or message
        message = f"{error.filename}: {said}" if error.filename else said
    else:
        where = traceback.extract_tb(error.__traceback__)[-1]
        message = (
            f"this is a fault of the command: {type(error).__name__}: {error} "
            f"({os.path.basename(where.filename)}:{where.lineno})"
        )
    print(f"posespace: {message}", file=sys.stderr)
    try:
        if in_json:
            output.print_json({"error": {"message": message, "reason": reason, "fields": fields}})
        print(end="", flush=True)
    except OSError:  # the answer's own place is at fault
        _say_no_more()
    return status
