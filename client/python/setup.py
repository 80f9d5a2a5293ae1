# SPDX-License-Identifier: Apache-2.0
"""Makes the Python code of proto/posespace/v1 while the package is built; the rest is pyproject."""

from importlib.resources import files
from pathlib import Path
from tempfile import TemporaryDirectory

from grpc_tools import protoc
from setuptools import setup
from setuptools.command.build_py import build_py

PROTO = Path(__file__).resolve().parents[2] / "proto"


class BuildWithMessages(build_py):
    """build_py that adds posespace/v1/*_pb2*.py and their types."""

    def run(self) -> None:
        super().run()
        sources = sorted(PROTO.glob("posespace/v1/*.proto"))
        if not sources:
            raise SystemExit(f"no messages in {PROTO}: build the client from a whole checkout")
        arguments = [
            "protoc",
            f"--proto_path={PROTO}",
            f"--proto_path={files('grpc_tools') / '_proto'}",
            f"--python_out={self.build_lib}",
            f"--pyi_out={self.build_lib}",
            *map(str, sources),
        ]
        if protoc.main(arguments) != 0:
            raise SystemExit("protoc failed")


# Built aside: nothing of an earlier build gets in, nothing stays in the checkout.
with TemporaryDirectory() as scratch:
    setup(
        cmdclass={"build_py": BuildWithMessages},
        options={"build": {"build_base": scratch}},
    )
