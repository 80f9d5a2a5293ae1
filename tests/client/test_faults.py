# SPDX-License-Identifier: Apache-2.0
"""Services that die, hang or end, connections that break, builds that are stopped."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import posespace
import pytest
from synthetic_drawings import star, wavy_blob
from walk_session import make_walk

TIMEOUT = 3.0  # of the clients here; what hangs is given up after it
SLACK = 20.0  # that a busy machine may add to it


@pytest.fixture
def own_server() -> Iterator[posespace.LocalServer]:
    """A service that the test may break."""
    with posespace.serve_locally(flags=["--drain-grace", "500"]) as server:
        yield server


@pytest.fixture
def own_client(own_server) -> Iterator[posespace.Client]:
    with posespace.connect(own_server.address, timeout=TIMEOUT) as client:
        yield client


def freeze(pid: int) -> None:
    """Stops every thread of a process; the signal alone is only on its way."""
    os.kill(pid, signal.SIGSTOP)
    threads = Path(f"/proc/{pid}/task")
    give_up = time.monotonic() + 30
    while any(
        (thread / "stat").read_text().rpartition(")")[2].split()[0] != "T"
        for thread in threads.iterdir()
    ):
        assert time.monotonic() < give_up, "it does not stop"


@contextlib.contextmanager
def within(seconds: float) -> Iterator[None]:
    start = time.monotonic()
    yield
    assert time.monotonic() - start <= seconds


def slow_session(client: posespace.Client) -> posespace.Session:
    """A session whose build takes some seconds."""
    session = client.create_session()
    for k in range(6):
        session.put_shape(f"blob{k}", polygon=wavy_blob(9 + k, 0.12, rows=900))
    return session


SLOW = {"tolerance": 0.001, "target_edge_length": 0.02}


class Relay:
    """A TCP relay whose connections the test can break."""

    def __init__(self, address: str) -> None:
        host, port = address.rsplit(":", 1)
        self._target = host, int(port)
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.address = f"127.0.0.1:{self._listener.getsockname()[1]}"
        self._pairs: list[tuple[socket.socket, socket.socket]] = []
        self.accepted = 0
        threading.Thread(target=self._accept, daemon=True).start()

    def _accept(self) -> None:
        with contextlib.suppress(OSError):
            while True:
                near, _ = self._listener.accept()
                far = socket.create_connection(self._target)
                self._pairs.append((near, far))
                self.accepted += 1
                for a, b in ((near, far), (far, near)):
                    threading.Thread(target=self._copy, args=(a, b), daemon=True).start()

    @staticmethod
    def _copy(source: socket.socket, sink: socket.socket) -> None:
        with contextlib.suppress(OSError):
            while data := source.recv(65536):
                sink.sendall(data)
            sink.shutdown(socket.SHUT_WR)

    def break_connections(self) -> None:
        while self._pairs:
            for end in self._pairs.pop():
                with contextlib.suppress(OSError):
                    end.shutdown(socket.SHUT_RDWR)
                end.close()

    def close(self) -> None:
        self._listener.close()
        self.break_connections()


@pytest.fixture
def relay(own_server) -> Iterator[Relay]:
    made = Relay(own_server.address)
    yield made
    made.close()


# Death.


def test_a_service_killed_between_frames_is_said(own_server, own_client):
    session = make_walk(own_client)
    with session.play() as player, within(TIMEOUT + SLACK):
        frames = player.frames((t, 0.0) for t in np.linspace(0, 1, 100_000))
        for _ in range(20):
            next(frames)
        os.kill(own_server.pid, signal.SIGKILL)
        with pytest.raises(posespace.Unavailable, match=own_server.address):
            for _ in frames:
                pass
        with pytest.raises(posespace.Unavailable):
            player.tick([player.avatar.item(at=(0, 0))])


def test_a_service_killed_while_a_frame_is_awaited_is_said(own_server, own_client):
    session = make_walk(own_client)
    with session.play() as player, within(TIMEOUT + SLACK):
        freeze(own_server.pid)
        threading.Timer(0.5, os.kill, (own_server.pid, signal.SIGKILL)).start()
        with pytest.raises(posespace.Unavailable, match=own_server.address):
            list(player.frames([(0, 0)]))


def test_a_service_killed_before_a_call_is_said(own_server, own_client):
    session = make_walk(own_client)
    os.kill(own_server.pid, signal.SIGKILL)
    for call in (session.state, lambda: session.blend(at=(0, 0)), session.play, own_client.ping):
        with within(TIMEOUT + SLACK), pytest.raises(posespace.Unavailable, match="is not there"):
            call()


def test_a_service_killed_during_a_build_is_said(own_server, own_client):
    session = slow_session(own_client)

    def kill(stage: str, fraction: float) -> None:
        with contextlib.suppress(ProcessLookupError):
            os.kill(own_server.pid, signal.SIGKILL)

    with within(2 * TIMEOUT + SLACK), pytest.raises(posespace.Unavailable):
        session.build(on_progress=kill, **SLOW)


def test_a_hanging_service_is_given_up_after_the_timeout(own_server, own_client):
    session = make_walk(own_client)
    with session.play() as player:
        freeze(own_server.pid)
        calls = [
            lambda: session.blend(at=(0, 0)),
            lambda: list(player.frames([(0, 0)])),
            lambda: player.tick([player.avatar.item(at=(0, 0))]),
            lambda: session.render(at=(0, 0)),
        ]
        for call in calls:
            start = time.monotonic()
            with pytest.raises(posespace.DeadlineExceeded, match="within 3 s"):
                call()
            assert 0.9 * TIMEOUT <= time.monotonic() - start <= TIMEOUT + SLACK
        os.kill(own_server.pid, signal.SIGCONT)
        assert len(list(player.frames([(0, 0)]))) == 1, "the stream is still good"


def test_nobody_at_the_address_is_said():
    with socket.create_server(("127.0.0.1", 0)) as listener:
        address = f"127.0.0.1:{listener.getsockname()[1]}"
    with (
        posespace.connect(address, timeout=TIMEOUT) as client,
        within(TIMEOUT + SLACK),
        pytest.raises(posespace.Unavailable, match=address),
    ):
        client.ping()


def test_a_service_that_ends_in_order_tells_its_streams(own_server, own_client):
    session = make_walk(own_client)
    with session.play() as player, within(SLACK):
        os.kill(own_server.pid, signal.SIGTERM)
        with pytest.raises(posespace.Unavailable):
            for _ in player.frames((0.0, 0.0) for _ in iter(int, 1)):
                time.sleep(0.005)


@pytest.fixture
def long_grace() -> Iterator[posespace.LocalServer]:
    """A service whose streams may take a minute to end."""
    with posespace.serve_locally(
        flags=["--drain-grace", "60000"], stop_timeout=60.0 + SLACK
    ) as server:
        yield server


def test_an_idle_player_does_not_hold_a_service_that_ends(long_grace):
    with posespace.connect(long_grace.address) as client:
        session = make_walk(client)
        with session.play() as player:
            list(player.frames([(0, 0)]))
            with within(SLACK):
                long_grace.stop()
            with pytest.raises(posespace.Unavailable) as refusal:
                list(player.frames([(0, 0)]))
            assert refusal.value.reason == "DRAINING"


def test_a_player_at_work_is_answered_what_was_under_way_when_the_service_ends(long_grace):
    with posespace.connect(long_grace.address) as client:
        session = make_walk(client)
        with session.play() as player:
            os.kill(long_grace.pid, signal.SIGTERM)
            with pytest.raises(posespace.Unavailable) as refusal:
                while True:
                    answers = player.tick([player.avatar.item(at=(0, 0))] * 8)
                    assert all(isinstance(answer, posespace.Frame) for answer in answers)
            assert refusal.value.reason == "DRAINING"


# Full queues.


def test_many_callers_at_once_are_all_served(server):
    failed: list[posespace.Error] = []
    client = posespace.connect(server.address, timeout=60.0)

    def work() -> None:
        try:
            session = client.create_session()
            session.put_shape("sharp", polygon=star())
            session.put_shape("turned", polygon=star(turn=0.3))
            session.build(target_edge_length=0.3)
            session.blend(at=(0.5, 0))
            session.render(at=(0.5, 0), size=(64, 64))
            session.delete()
        except posespace.Error as error:
            failed.append(error)

    threads = [threading.Thread(target=work) for _ in range(100)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    client.close()
    assert not failed


def test_a_full_build_queue_is_waited_for_until_the_timeout():
    with (
        posespace.serve_locally(flags=["--concurrent-builds", "1", "--build-queue", "1"]) as server,
        posespace.connect(server.address, timeout=TIMEOUT) as client,
    ):
        running, queued, third = (slow_session(client) for _ in range(3))
        running.start_build(**SLOW)
        while running.state().build.state == "queued":
            time.sleep(0.02)
        queued.start_build(**SLOW)
        with pytest.raises(posespace.ResourceExhausted) as refusal:
            third.build(timeout=0.5, **SLOW)
        assert refusal.value.reason == "BUILD_QUEUE_FULL"
        threading.Timer(1.0, queued.cancel_build).start()
        assert third.build(tolerance=0.1, target_edge_length=0.3).revision


# Broken connections.


def test_a_build_survives_broken_connections(relay):
    with posespace.connect(relay.address, timeout=10.0) as client:
        session = slow_session(client)
        seen: list[float] = []

        def disturb(stage: str, fraction: float) -> None:
            seen.append(fraction)
            if relay.accepted < 4:
                relay.break_connections()

        report = session.build(on_progress=disturb, **SLOW)
        assert relay.accepted >= 2, "the connection was broken"
        assert seen == sorted(seen) and seen[-1] == 1.0
        assert report.revision == session.state().revision


def test_a_broken_stream_is_said_and_a_new_one_works(relay):
    with posespace.connect(relay.address, timeout=TIMEOUT) as client:
        session = make_walk(client)
        with session.play() as player:
            list(player.frames([(0, 0)]))
            relay.break_connections()
            with pytest.raises(posespace.Unavailable):
                list(player.frames([(0, 0)] * 10))
        deadline = time.monotonic() + SLACK
        while True:
            with contextlib.suppress(posespace.Unavailable):
                with session.play() as player:
                    assert len(list(player.frames([(0, 0)]))) == 1
                break
            assert time.monotonic() < deadline
            time.sleep(0.1)


# Builds that are stopped.


def ended(session: posespace.Session) -> posespace.Build:
    deadline = time.monotonic() + SLACK
    while (build := session.state().build).state in ("queued", "running"):
        assert time.monotonic() < deadline
        time.sleep(0.02)
    return build


def test_a_build_can_be_cancelled_from_elsewhere(client):
    session = slow_session(client)

    def cancel(stage: str, fraction: float) -> None:
        if stage == "matching":
            session.cancel_build()

    with within(SLACK), pytest.raises(posespace.Cancelled) as refusal:
        session.build(on_progress=cancel, **SLOW)
    assert refusal.value.reason == "CANCELLED"
    assert ended(session).state == "cancelled"
    session.delete()


def test_ctrl_c_cancels_the_build(client):
    session = slow_session(client)

    def interrupt(stage: str, fraction: float) -> None:
        if stage == "matching":
            os.kill(os.getpid(), signal.SIGINT)

    with within(SLACK), pytest.raises(KeyboardInterrupt):
        session.build(on_progress=interrupt, **SLOW)
    assert ended(session).state == "cancelled"
    session.delete()


def test_an_exception_in_on_progress_cancels_the_build(client):
    session = slow_session(client)

    def fail(stage: str, fraction: float) -> None:
        raise RuntimeError("no more")

    with pytest.raises(RuntimeError, match="no more"):
        session.build(on_progress=fail, **SLOW)
    assert ended(session).state == "cancelled"
    session.delete()


def test_a_build_that_takes_too_long_is_cancelled(client):
    session = slow_session(client)
    with within(SLACK), pytest.raises(posespace.DeadlineExceeded, match=r"0\.05 s"):
        session.build(timeout=0.05, **SLOW)
    assert ended(session).state == "cancelled"
    session.delete()


def test_another_build_replaces_a_running_one(client):
    session = slow_session(client)
    session.start_build(**SLOW)

    def replace(stage: str, fraction: float) -> None:
        session.start_build(tolerance=0.1)

    with pytest.raises(posespace.Cancelled):
        session.build(on_progress=replace, **SLOW)
    assert ended(session).state == "succeeded"
    session.delete()


def test_a_cancelled_build_leaves_the_built_pose_space(client):
    session = slow_session(client)
    revision = session.build(tolerance=0.1, target_edge_length=0.3).revision
    session.start_build(**SLOW)
    session.cancel_build()
    assert ended(session).state == "cancelled"
    assert session.state().revision == revision
    assert session.blend(at=(0.2, 0.2)).revision == revision
    session.delete()


def test_the_timeout_of_one_caller_leaves_the_build_of_another(client):
    session = slow_session(client)
    started = session.start_build(**SLOW)
    with pytest.raises(posespace.DeadlineExceeded, match="another caller's build goes on"):
        session.build(timeout=0.1, **SLOW)
    assert session.state().build.id == started.id
    assert ended(session).state == "succeeded"
    session.delete()


def test_ctrl_c_of_one_caller_leaves_the_build_of_another(client):
    session = slow_session(client)
    started = session.start_build(**SLOW)

    def interrupt(stage: str, fraction: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        session.build(on_progress=interrupt, **SLOW)
    assert session.state().build.id == started.id
    assert ended(session).state == "succeeded"
    session.delete()


def test_a_caller_that_gives_up_leaves_the_build_that_replaced_its_own(client):
    session = slow_session(client)
    replacing = []

    def replace(stage: str, fraction: float) -> None:
        replacing.append(session.start_build(tolerance=0.001, target_edge_length=0.025))
        raise RuntimeError("no more")

    with pytest.raises(RuntimeError, match="no more"):
        session.build(on_progress=replace, **SLOW)
    assert session.state().build.id == replacing[0].id
    assert ended(session).state == "succeeded"
    session.delete()


def test_cancelling_without_a_build_has_no_effect(session):
    session.cancel_build()
    session.put_shape("star", polygon=star())
    session.build()
    session.cancel_build()
    assert session.state().build.state == "succeeded"


def test_a_started_build_goes_on_by_itself_and_build_attaches_to_it(client):
    session = make_walk(client)
    started = session.start_build(target_edge_length=0.05)
    report = session.build(target_edge_length=0.05)
    assert session.state().build.id == started.id
    assert session.state().revision == report.revision
    session.delete()
