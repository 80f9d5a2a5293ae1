# SPDX-License-Identifier: Apache-2.0
"""The arrows of the house, read from the includes: a folder uses only what lies below it."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SERVER = ROOT / "server"

# folder -> folders of server/ that it may include, besides itself
MAY_USE = {
    "geometry": set(),
    "mapping": {"geometry"},
    "interpolation": {"geometry"},
    "drawing": {"geometry"},
    "store": {"geometry"},  # result.h alone, see below
    "session": {"geometry", "mapping", "interpolation", "drawing", "store"},
    "ops": {"geometry", "session"},  # session: its limits, which are flags
    "rpc": {"geometry", "mapping", "interpolation", "drawing", "store", "session", "ops"},
}

# folder -> beginnings of outside headers that it must not include
KERNEL = {"geometry", "mapping", "interpolation"}
FORBIDDEN = {
    **{folder: ("grpc", "google/", "posespace/", "opencv2/", "spdlog/") for folder in KERNEL},
    "drawing": ("grpc", "google/", "posespace/", "opencv2/imgcodecs", "opencv2/highgui"),
    "session": ("grpc", "google/", "posespace/", "opencv2/", "CGAL/"),
    "store": ("grpc", "google/", "posespace/", "opencv2/", "CGAL/", "Eigen/"),
    "rpc": ("opencv2/", "CGAL/"),
    "ops": ("opencv2/", "CGAL/", "Eigen/"),
}
FORBIDDEN["interpolation"] += ("CGAL/", "boost/")

INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.MULTILINE)


def sources(folder: Path) -> list[Path]:
    return sorted(p for p in folder.rglob("*") if p.suffix in {".h", ".cpp"})


def includes(path: Path) -> list[str]:
    return INCLUDE.findall(path.read_text())


def test_every_folder_of_the_server_has_a_rule():
    folders = {p.relative_to(SERVER).parts[0] for p in sources(SERVER) if p.parent != SERVER}
    assert folders <= set(MAY_USE), f"folders without a rule: {folders - set(MAY_USE)}"
    assert {"geometry", "mapping", "interpolation", "drawing", "store", "session", "rpc"} <= folders


@pytest.mark.parametrize("folder", sorted(MAY_USE))
def test_arrows_point_downward(folder):
    wrong = [
        f"{path.relative_to(ROOT)} includes {header}"
        for path in sources(SERVER / folder)
        for header in includes(path)
        if header.split("/")[0] in MAY_USE
        and header.split("/")[0] not in MAY_USE[folder] | {folder}
    ]
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize("folder", sorted(FORBIDDEN))
def test_no_folder_includes_what_it_must_not_know(folder):
    wrong = [
        f"{path.relative_to(ROOT)} includes {header}"
        for path in sources(SERVER / folder)
        for header in includes(path)
        if header.startswith(FORBIDDEN[folder])
    ]
    assert not wrong, "\n".join(wrong)


def test_the_store_knows_no_geometry():
    wrong = [
        f"{path.relative_to(ROOT)} includes {header}"
        for path in sources(SERVER / "store")
        for header in includes(path)
        if header.startswith("geometry/") and header != "geometry/result.h"
    ]
    assert not wrong, "\n".join(wrong)


def test_clients_include_nothing_of_the_server():
    wrong = [
        f"{path.relative_to(ROOT)} includes {header}"
        for path in sources(ROOT / "client")
        for header in includes(path)
        if header.split("/")[0] in {*MAY_USE, "server"}
    ]
    assert not wrong, "\n".join(wrong)


PUBLIC = ROOT / "client/cpp/include/posespace"
STANDARD = re.compile(r"[a-z_]+")  # <vector>, not <grpcpp/channel.h>


def test_public_headers_of_the_cpp_client_need_the_standard_library_alone():
    own = {f"posespace/{path.name}" for path in PUBLIC.glob("*.h")}
    assert "posespace/client.h" in own
    wrong = [
        f"{path.name} includes {header}"
        for path in sources(PUBLIC)
        for header in includes(path)
        if header not in own and not STANDARD.fullmatch(header)
    ]
    assert not wrong, "\n".join(wrong)


def test_public_headers_of_the_cpp_client_name_no_type_of_the_wire():
    wire = re.compile(r"\b(?:grpc|google|protobuf|v1)\s*::|\bgrpc_\w+")
    wrong = [path.name for path in sources(PUBLIC) if wire.search(path.read_text())]
    assert not wrong
