# SPDX-License-Identifier: Apache-2.0
"""What posespaced loads may be shipped in a product: every library is known, and none is GPL."""

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

# Library (a pattern over its name without ".so") -> its licence, as its package states it.
# A library that is new here is looked up first, and added only when its licence may be linked.
REVIEWED = {
    r"ld-linux.*|linux-vdso|libc|libm": "LGPL-2.1+",
    r"libstdc\+\+|libgcc_s|libgfortran|libquadmath": "GPL-3+ with the GCC runtime exception",
    r"libgrpc(\+\+)?|libgrpc\+\+_reflection|libgpr|libaddress_sorting|libabsl_\w+": "Apache-2.0",
    r"libupb|libprotobuf|libre2": "BSD-3-Clause",
    r"libssl|libcrypto|libtbb|libopencv_core|libopencv_imgproc": "Apache-2.0",
    r"libopencv_video|libopencv_dnn|libopencv_calib3d|libopencv_features2d": "Apache-2.0",
    r"libopencv_flann": "BSD-3-Clause",
    r"libspdlog|libfmt|libcares|libX11|libXau|libXdmcp|libxcb|libGLX|libGLdispatch": "MIT",
    r"libGL|libOpenGL|libEGL": "MIT",
    r"libblas|liblapack|libopenblas": "BSD-3-Clause",
    r"libbsd|libmd": "BSD and ISC",
    r"libgmp|libmpfr": "LGPL-3+",
    r"libpng16": "libpng",
    r"libjpeg": "IJG and BSD-3-Clause",
    r"libwebp": "BSD-3-Clause",
    r"libz": "Zlib",
    r"libsqlite3": "public domain",
    r"libhwy": "Apache-2.0 or BSD-3-Clause",
}


# What posespace-svg loads besides: librsvg and what draws for it.
REVIEWED_FOR_SVG = {
    r"librsvg-2|libgdk_pixbuf-2.0|libpango(cairo|ft2)?-1.0": "LGPL-2.1+",
    r"libgio-2.0|libglib-2.0|libgmodule-2.0|libgobject-2.0": "LGPL-2.1+",
    r"libfribidi|libthai|libdatrie|libblkid|libmount": "LGPL-2.1+",
    r"libcairo(-gobject)?|libgraphite2": "LGPL-2.1 or MPL",
    r"libpixman-1|libharfbuzz|libfontconfig|libexpat|libffi|libxml2|libbrotli(common|dec)": "MIT",
    r"libXext|libXrender|libxcb-render|libxcb-shm": "MIT",
    r"libfreetype": "FTL",
    r"libicudata|libicuuc": "Unicode",
    r"libpcre2-8": "BSD-3-Clause",
    r"liblzma|libselinux": "public domain",
}


def loaded_libraries(name: str) -> list[str]:
    program = ROOT / "build/bin" / name
    assert program.is_file(), f"{program} is not built; tests/run builds it"
    listing = subprocess.run(["ldd", program], check=True, capture_output=True, text=True).stdout
    names = [line.split()[0].rsplit("/", 1)[-1] for line in listing.splitlines() if line.strip()]
    return [re.sub(r"\.so.*", "", name) for name in names]


@pytest.mark.parametrize(
    ("program", "reviewed"),
    [("posespaced", REVIEWED), ("posespace-svg", {**REVIEWED, **REVIEWED_FOR_SVG})],
)
def test_a_program_loads_only_libraries_whose_licence_was_reviewed(program, reviewed):
    unknown = [
        name
        for name in loaded_libraries(program)
        if not any(re.fullmatch(pattern, name) for pattern in reviewed)
    ]
    assert not unknown, f"look up the licence of {unknown}; a GPL library must not be linked"


def test_the_review_would_notice_the_module_that_loads_gpl_libraries():
    for name in ("libopencv_imgcodecs", "libx265", "libpoppler", "libcholmod"):
        assert not any(re.fullmatch(pattern, name) for pattern in {**REVIEWED, **REVIEWED_FOR_SVG})
