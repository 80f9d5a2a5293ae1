# SPDX-License-Identifier: Apache-2.0
"""Parsers of the commands: what all of them take, and how each is added."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import TYPE_CHECKING

from posespace.client import Client
from posespace.command.values import address

if TYPE_CHECKING:
    Subparsers = argparse._SubParsersAction[argparse.ArgumentParser]

Run = Callable[[Client, argparse.Namespace], None]


def add_common(parser: argparse.ArgumentParser, default: object) -> None:
    """--server, --store and --json, which may stand before or after a command."""
    parser.add_argument(
        "--server",
        metavar="ADDR",
        type=address,
        default=default,
        help="a running service, HOST:PORT or unix:PATH; by default one is run meanwhile",
    )
    parser.add_argument(
        "--store",
        metavar="PATH",
        default=default,
        help="where that one keeps sessions: PATH, sqlite:PATH or memory; by default "
        "posespace/posespaced.sqlite in XDG_DATA_HOME or ~/.local/share",
    )
    parser.add_argument(
        "--json",
        action="store_true",
        default=default if default is argparse.SUPPRESS else False,
        help="answer in JSON",
    )


class Commands:
    """Where commands are added to."""

    def __init__(self, subparsers: Subparsers) -> None:
        self._subparsers = subparsers

    def add(self, name: str, does: str, more: str, run: Run | None) -> argparse.ArgumentParser:
        """The parser of a new command; `more`, as it is written, stands under its options."""
        parser: argparse.ArgumentParser = self._subparsers.add_parser(
            name,
            help=does,
            description=f"{does[0].upper()}{does[1:]}.",
            epilog=more,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        add_common(parser, argparse.SUPPRESS)
        if run is not None:
            parser.set_defaults(run=run)
        return parser

    def add_group(self, name: str, does: str, more: str) -> Commands:
        """A command that has commands of its own."""
        parser = self.add(name, does, more, None)
        return Commands(parser.add_subparsers(metavar="COMMAND", required=True))
