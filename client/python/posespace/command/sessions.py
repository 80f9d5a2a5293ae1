# SPDX-License-Identifier: Apache-2.0
"""posespace sessions: which there are, how each stands, and removing them."""

from __future__ import annotations

import argparse

from posespace.client import Client
from posespace.command import output
from posespace.command.documents import Document
from posespace.command.parsers import Commands
from posespace.results import SessionState

_MORE = """\
examples:
  posespace sessions ls
  posespace sessions show tux
  posespace sessions rm tux
"""


def add(commands: Commands) -> None:
    group = commands.add_group("sessions", "list, show and remove sessions", _MORE)
    group.add("ls", "list all sessions", "example:\n  posespace sessions ls", run_ls)
    show = group.add(
        "show", "say how a session stands", "example:\n  posespace sessions show tux", run_show
    )
    show.add_argument("session", metavar="SESSION")
    rm = group.add(
        "rm",
        "forget sessions, their drawings and what was built",
        "example:\n  posespace sessions rm tux",
        run_rm,
    )
    rm.add_argument("sessions", metavar="SESSION", nargs="+")


def _document(state: SessionState) -> Document:
    return {
        "session": state.id,
        "display_name": state.display_name,
        "labels": state.labels,
        "shapes": state.shape_ids,
        "created": state.create_time,
        "changed": state.update_time,
        "etag": state.etag,
        "revision": state.revision,
        "build": state.build.state if state.build else None,
    }


def run_ls(client: Client, arguments: argparse.Namespace) -> None:
    states = client.session_states()
    if arguments.json:
        output.print_json({"sessions": [_document(state) for state in states]})
    elif not states:
        print("no sessions")
    else:
        rows = [
            [
                state.id,
                str(len(state.shape_ids)),
                _standing(state),
                f"{state.update_time:%Y-%m-%d %H:%M}",
                state.display_name,
            ]
            for state in states
        ]
        print(output.table(["session", "drawings", "build", "changed (UTC)", "name"], rows))


def _standing(state: SessionState) -> str:
    if state.build is None:
        return "built" if state.revision else "not built"
    return "built" if state.build.state == "succeeded" else state.build.state


def run_show(client: Client, arguments: argparse.Namespace) -> None:
    state = client.session(arguments.session).state()
    if arguments.json:
        output.print_json(_document(state))
        return
    rows = [
        ["name", state.display_name or "-"],
        ["drawings", ", ".join(state.shape_ids) or "none"],
        ["marked places", str(len(state.correspondences))],
        ["created", f"{state.create_time:%Y-%m-%d %H:%M:%S} UTC"],
        ["changed", f"{state.update_time:%Y-%m-%d %H:%M:%S} UTC"],
        ["build", _standing(state)],
        ["revision", state.revision or "-"],
        *([f"label {key}", value] for key, value in sorted(state.labels.items())),
    ]
    print(output.table(["session", state.id], rows))


def run_rm(client: Client, arguments: argparse.Namespace) -> None:
    removed = []
    for session_id in arguments.sessions:
        client.session(session_id).delete()
        removed.append(session_id)
        if not arguments.json:
            print(f"removed {session_id}")
    if arguments.json:
        output.print_json({"removed": removed})
