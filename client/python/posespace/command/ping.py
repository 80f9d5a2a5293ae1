# SPDX-License-Identifier: Apache-2.0
"""posespace ping: does the service answer."""

from __future__ import annotations

import argparse
import time

from posespace.client import Client
from posespace.command import output
from posespace.command.parsers import Commands

_MORE = """\
Without --server it says whether a service can be run here.

example:
  posespace ping --server 127.0.0.1:7433
"""


def add(commands: Commands) -> None:
    commands.add("ping", "say whether the service answers", _MORE, run)


def run(client: Client, arguments: argparse.Namespace) -> None:
    start = time.perf_counter()
    client.ping()
    milliseconds = (time.perf_counter() - start) * 1e3
    if arguments.json:
        output.print_json({"server": arguments.server, "milliseconds": round(milliseconds, 3)})
    else:
        where = f" at {arguments.server}" if arguments.server else ", run for this command,"
        print(f"the service{where} answers in {milliseconds:.1f} ms")
