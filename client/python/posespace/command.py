# SPDX-License-Identifier: Apache-2.0
"""The command `posespace`.  Exit status: 0 done, 1 refused, 2 usage, 3 service unreachable."""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Sequence
from importlib.metadata import version

import posespace

_DEFAULT_SERVER = "127.0.0.1:7433"  # where posespaced listens unless told otherwise


def _ping(client: posespace.Client, arguments: argparse.Namespace) -> None:
    start = time.perf_counter()
    client.ping()
    milliseconds = (time.perf_counter() - start) * 1e3
    if arguments.json:
        print(json.dumps({"server": arguments.server, "milliseconds": round(milliseconds, 3)}))
    else:
        print(f"the service at {arguments.server} answers in {milliseconds:.1f} ms")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="posespace", description="Client of posespaced.")
    parser.add_argument("--version", action="version", version=f"posespace {version('posespace')}")
    parser.add_argument("--server", metavar="ADDR", default=_DEFAULT_SERVER, help="HOST:PORT")
    parser.add_argument("--json", action="store_true", help="answer in JSON")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)

    ping = commands.add_parser("ping", help="say whether the service answers")
    ping.add_argument("--server", metavar="ADDR", default=argparse.SUPPRESS, help="HOST:PORT")
    ping.add_argument("--json", action="store_true", default=argparse.SUPPRESS)
    ping.set_defaults(run=_ping)
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Runs the command line; answers its exit status."""
    arguments = _parser().parse_args(argv)
    try:
        with posespace.connect(arguments.server) as client:
            arguments.run(client, arguments)
    except (posespace.Unavailable, posespace.DeadlineExceeded) as error:
        print(f"posespace: {error}", file=sys.stderr)
        return 3
    except posespace.Error as error:
        print(f"posespace: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
