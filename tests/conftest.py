# SPDX-License-Identifier: Apache-2.0
"""One real posespaced for all tests that leave it alive."""

from __future__ import annotations

import signal
from collections.abc import Iterator

import posespace
import pytest

# A shell starts what runs in its background deaf to Ctrl-C, and children inherit that; programs
# that tests interrupt must hear it.
signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session")
def server() -> Iterator[posespace.LocalServer]:
    with posespace.serve_locally() as running:
        yield running


@pytest.fixture(scope="session")
def client(server: posespace.LocalServer) -> Iterator[posespace.Client]:
    with posespace.connect(server.address, timeout=10.0) as connected:
        yield connected
