# SPDX-License-Identifier: Apache-2.0
"""The command `posespace` as a shell runs it."""

from __future__ import annotations

import json
import os
import subprocess
import sysconfig
from pathlib import Path
from typing import Any

from synthetic_drawings import WALK, figure, png_of

COMMAND = Path(sysconfig.get_path("scripts")) / "posespace"


def run(
    *arguments: str | Path, cwd: Path | None = None, **environment: str
) -> subprocess.CompletedProcess[str]:
    """What the command answers.  Whatever happens, it shows no traceback."""
    done = subprocess.run(
        [COMMAND, *map(str, arguments)],
        cwd=cwd,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert "Traceback" not in done.stderr + done.stdout
    return done


def answer(*arguments: str | Path, **environment: str) -> Any:
    """The JSON document that the command answers, which succeeds and says nothing else."""
    done = run("--json", *arguments, **environment)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    return json.loads(done.stdout)


def refusal(status: int, *arguments: str | Path, **environment: str) -> str:
    """What the command says while it ends with that status."""
    done = run(*arguments, **environment)
    assert done.returncode == status, (done.returncode, done.stdout, done.stderr)
    assert done.stdout == ""
    return done.stderr


def walk_files(folder: Path) -> list[Path]:
    """Three drawings on disk: stand.png, step.png, wave.png."""
    for name, pose in WALK.items():
        (folder / f"{name}.png").write_bytes(png_of(figure(**pose)))
    return [folder / f"{name}.png" for name in WALK]
