# SPDX-License-Identifier: Apache-2.0
"""What a service on a SQLite store still has when it was killed between two calls."""

from __future__ import annotations

import os
import signal
import sqlite3
import subprocess
from collections.abc import Iterator
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import posespace
import pytest
from synthetic_drawings import WALK, figure

POINTS = [(0.0, 0.0), (0.3, 0.4), (-2.0, 5.0), (0.9, 0.1)]


class Service:
    """posespaced on one store file, killed and started again at will."""

    def __init__(self, folder: Path) -> None:
        self.path = folder / "store.sqlite"
        self.start()

    def start(self) -> None:
        self.server = posespace.serve_locally(store=f"sqlite:{self.path}")
        self.client = posespace.connect(self.server.address, timeout=20.0)

    def kill(self) -> None:
        os.kill(self.server.pid, signal.SIGKILL)
        self.client.close()
        self.server.stop()

    def restart(self) -> None:
        self.kill()
        self.start()


@pytest.fixture
def service(tmp_path: Path) -> Iterator[Service]:
    running = Service(tmp_path)
    yield running
    running.client.close()
    running.server.stop()


def seen(client: posespace.Client) -> dict[str, Any]:
    """Everything that a caller can see of all sessions, as values that compare."""
    everything: dict[str, Any] = {}
    for session in client.sessions():
        state = session.state()
        # A build that ended is told without the stages that led to it.
        shown: dict[str, Any] = {"state": asdict(replace(state, build=None))}
        for shape_id in session.shape_ids:
            shape = session.shape(shape_id)
            shown[shape_id] = [ring.tobytes() for ring in shape.outline], shape.warnings
        if state.revision:
            mesh = session.mesh()
            shown["mesh"] = mesh.revision, mesh.triangles.tobytes(), asdict(mesh.report)
            shown["frames"] = session.blend_many(POINTS).tobytes()
            shown["weights"] = session.weights(POINTS).tobytes()
            shown["picture"] = session.render(at=POINTS[1], size=(64, 64)).tobytes()
        everything[session.id] = shown
    return everything


def test_every_acknowledged_call_survives_sigkill(service: Service) -> None:
    def step(name: str, call: Any) -> None:
        call(service.client.session("tux"))
        before = seen(service.client)
        service.restart()
        assert seen(service.client) == before, f"after {name}"

    service.client.create_session("tux", display_name="Tux", labels={"owner": "me"})
    for name, pose in WALK.items():
        step("put_shape", lambda s, n=name, p=pose: s.put_shape(n, image=figure(**p)))
    step("put_shape again", lambda s: s.put_shape("stand", image=figure(**WALK["stand"])))
    head = (100.0, 20.0)
    step("set_correspondences", lambda s: s.set_correspondences([{"stand": head, "wave": head}]))
    places = {"stand": (0, 0), "step": (1, 0.2), "wave": (0.4, 1)}
    step("set_placements", lambda s: s.set_placements(places))
    step("build", lambda s: s.build())
    step("set_placements of a built one", lambda s: s.set_placements({**places, "wave": (0.3, 2)}))
    step("delete_shape", lambda s: s.delete_shape("wave"))
    step("build of fewer", lambda s: s.build())
    step("create_session", lambda _: service.client.create_session("anna"))
    step("delete", lambda _: service.client.session("anna").delete())
    assert [session.id for session in service.client.sessions()] == ["tux"]


def test_the_same_build_is_found_finished_after_a_restart(service: Service) -> None:
    session = service.client.create_session("tux")
    for name in ("stand", "step"):
        session.put_shape(name, image=figure(**WALK[name]))
    before = session.build()
    service.restart()
    report = service.client.session("tux").build()
    assert asdict(report) == asdict(before), "seconds included: it was not built again"


def test_a_build_that_was_running_is_forgotten_and_can_be_started_again(service: Service) -> None:
    session = service.client.create_session("tux")
    for name, pose in WALK.items():
        session.put_shape(name, image=figure(**pose, size=(400, 520)))
    started: list[float] = []

    def kill_when_under_way(*_: object) -> None:
        if not started:
            started.append(1.0)
            os.kill(service.server.pid, signal.SIGKILL)

    with pytest.raises(posespace.Error):
        session.build(target_edge_length=0.02, on_progress=kill_when_under_way)
    service.restart()
    session = service.client.session("tux")
    assert session.state().revision in ("", None)
    with pytest.raises(posespace.NotBuilt):
        session.blend(at=(0, 0))
    assert session.build().revision


def test_a_stream_plays_a_session_that_only_the_store_has(service: Service) -> None:
    session = service.client.create_session("tux")
    for name in ("stand", "step"):
        session.put_shape(name, image=figure(**WALK[name]))
    session.build()
    expected = session.blend(at=(0.5, 0.0)).vertices
    service.restart()
    (session,) = service.client.sessions()  # lists ids; loads nothing
    with session.play() as player:
        (frame,) = player.frames([(0.5, 0.0)])
    assert np.array_equal(frame.vertices, expected)


def test_a_second_service_on_the_same_file_is_refused(service: Service) -> None:
    with pytest.raises(posespace.Unavailable, match="another process"):
        posespace.serve_locally(store=f"sqlite:{service.path}")
    service.client.create_session("still-here")


def test_damaged_pose_spaces_are_said_and_mended_by_a_build(service: Service) -> None:
    session = service.client.create_session("tux")
    for name in ("stand", "step"):
        session.put_shape(name, image=figure(**WALK[name]))
    session.build()
    expected = session.blend(at=(0.5, 0.0)).vertices
    service.kill()
    with sqlite3.connect(service.path) as database:
        database.execute(
            "UPDATE blobs SET bytes = CAST(substr(bytes, 1, length(bytes) - 1) || x'55' AS BLOB)"
            " WHERE key LIKE 'pose-space/%'"
        )
    database.close()
    service.start()
    session = service.client.session("tux")
    with pytest.raises(posespace.InternalError) as refusal:
        session.blend(at=(0.5, 0.0))
    assert refusal.value.reason == "SNAPSHOT_CORRUPT"
    session.build()
    assert np.array_equal(session.blend(at=(0.5, 0.0)).vertices, expected)


def test_ten_thousand_sessions_are_there_at_once(service: Service, tmp_path: Path) -> None:
    service.client.create_session("tux")
    service.kill()
    with sqlite3.connect(service.path) as database:
        database.execute(
            "WITH RECURSIVE k(n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM k WHERE n < 9999) "
            "INSERT INTO sessions SELECT printf('s%05d', n), '', zeroblob(2000) FROM k"
        )
    database.close()
    service.start()
    assert service.client.session("tux").state().id == "tux"
    assert len(service.client.sessions()) == 10_000


def test_the_store_of_somebody_who_names_none_is_in_the_users_data(tmp_path: Path) -> None:
    program = Path(__file__).resolve().parents[2] / "build/bin/posespaced"
    environment = {**os.environ, "XDG_DATA_HOME": str(tmp_path)}
    environment.pop("POSESPACED_STORE", None)
    with subprocess.Popen(
        [program, "--listen", "127.0.0.1:0"],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline().startswith("posespace ready")
        assert (tmp_path / "posespace" / "posespaced.sqlite").is_file()
        process.terminate()
        assert process.wait(10) == 0
