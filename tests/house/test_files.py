# SPDX-License-Identifier: Apache-2.0
"""Rules that hold for every file of the project."""

import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SOURCE_SUFFIXES = {".h", ".cpp", ".py", ".proto", ".sh", ".cmake", ".svg", ".yaml", ".toml"}


def tracked_files() -> list[Path]:
    listed = subprocess.run(
        ["git", "ls-files", "-co", "--exclude-standard"],
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
    ).stdout.split("\n")
    return [ROOT / name for name in listed if name and (ROOT / name).is_file()]


def test_every_source_file_names_its_licence_at_its_head():
    without = [
        str(path.relative_to(ROOT))
        for path in tracked_files()
        if path.suffix in SOURCE_SUFFIXES or path.name == "CMakeLists.txt"
        if "SPDX-License-Identifier: Apache-2.0" not in path.read_text()[:400]
    ]
    assert not without, f"no SPDX line in {without}"


def test_nothing_generated_is_committed():
    generated = [
        str(path.relative_to(ROOT))
        for path in tracked_files()
        if re.search(r"(\.pb\.(h|cc)|_pb2(_grpc)?\.pyi?)$", path.name)
    ]
    assert not generated


def test_every_cpp_file_is_listed_in_a_cmakelists():
    unlisted = []
    for path in tracked_files():
        if path.suffix != ".cpp":
            continue
        lists = path.parent / "CMakeLists.txt"
        if not lists.is_file() or not re.search(rf"\b{re.escape(path.name)}\b", lists.read_text()):
            unlisted.append(str(path.relative_to(ROOT)))
    assert not unlisted, f"not built by any target: {unlisted}"


def test_header_guards_name_their_path():
    wrong = []
    for path in tracked_files():
        if path.suffix != ".h":
            continue
        relative = path.relative_to(ROOT)
        included_as = str(relative).removeprefix("server/").removeprefix("client/cpp/include/")
        words = "posespace/" + included_as.removeprefix("posespace/")
        guard = re.sub(r"[^A-Z0-9]", "_", words.upper()) + "_"
        text = path.read_text()
        if f"#ifndef {guard}\n#define {guard}\n" not in text:
            wrong.append(f"{relative}: expected {guard}")
    assert not wrong, "\n".join(wrong)
