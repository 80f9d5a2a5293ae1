# SPDX-License-Identifier: Apache-2.0
"""A line that shows how far a command is, on terminals only."""

from __future__ import annotations

import shutil
import sys
from types import TracebackType

_CELLS = 30
_CLEAR = "\r\x1b[K"


class Progress:
    """One line on standard error that is gone when its `with` ends; silent where that is no
    terminal.

        with Progress() as progress:
            session.build(on_progress=progress.show)
    """

    def __init__(self) -> None:
        self._on = sys.stderr.isatty()

    def show(self, what: str, fraction: float | None = None) -> None:
        """Says what is being done, with a bar when it is known how much of it is."""
        if not self._on:
            return
        line = f"  {what}"
        if fraction is not None:
            bar = "#" * round(_CELLS * fraction)
            line = f"  [{bar:<{_CELLS}}] {fraction:4.0%} {what}"
        width = shutil.get_terminal_size().columns - 1
        print(_CLEAR + line[:width], end="", file=sys.stderr, flush=True)

    def __enter__(self) -> Progress:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        if self._on:
            print(_CLEAR, end="", file=sys.stderr, flush=True)
