# SPDX-License-Identifier: Apache-2.0
"""Where the command `posespace` begins: outside the package, so that Ctrl-C while that is being
loaded ends it without a word."""

from __future__ import annotations

import signal


def main() -> int:
    """Runs the command line; answers its exit status."""
    handler = signal.signal(signal.SIGINT, signal.SIG_DFL)
    from posespace.command.main import main as run

    signal.signal(signal.SIGINT, handler)
    return run()
