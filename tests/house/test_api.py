# SPDX-License-Identifier: Apache-2.0
"""The API is well formed and breaks no client: `buf lint`, and `buf breaking` against what was
published (proto/baseline.binpb; made anew at each release by
`buf build --exclude-source-info -o proto/baseline.binpb`)."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BUF = Path(sys.executable).with_name("buf")
BASELINE = ROOT / "proto/baseline.binpb"


@pytest.fixture
def buf(tmp_path):
    """Runs buf in a folder: the project, or a changed copy of its API."""

    def run(*arguments: str, folder: Path = ROOT) -> subprocess.CompletedProcess[str]:
        assert BUF.exists(), "buf is missing: tests/requirements.txt brings it"
        return subprocess.run(
            [BUF, *arguments],
            cwd=folder,
            env={**os.environ, "BUF_CACHE_DIR": str(tmp_path / "cache")},
            capture_output=True,
            text=True,
            timeout=60,
        )

    return run


@pytest.fixture
def changed_api(tmp_path):
    """A copy of the API with one text replaced by another."""

    def change(old: str, new: str) -> Path:
        folder = tmp_path / "api"
        shutil.copytree(ROOT / "proto", folder / "proto")
        shutil.copy(ROOT / "buf.yaml", folder)
        changed = 0
        for path in folder.glob("proto/posespace/v1/*.proto"):
            text = path.read_text()
            changed += text.count(old)
            path.write_text(text.replace(old, new))
        assert changed == 1
        return folder

    return change


def test_the_api_passes_the_linter(buf):
    result = buf("lint")
    assert result.returncode == 0, result.stdout + result.stderr


def test_the_api_breaks_no_client(buf):
    result = buf("breaking", "--against", str(BASELINE))
    assert result.returncode == 0, result.stdout + result.stderr


def test_the_linter_finds_a_field_without_a_comment(buf, changed_api):
    folder = changed_api(
        "  // Sharpness of texture transitions, 0 (linear, the default) to 1 (a step).\n", ""
    )
    assert "sigma" in buf("lint", folder=folder).stdout


def test_a_renumbered_field_is_found_to_break_clients(buf, changed_api):
    folder = changed_api("double sigma = 4;", "double sigma = 15;")
    result = buf("breaking", "--against", str(BASELINE), folder=folder)
    assert result.returncode != 0 and "sigma" in result.stdout
