# SPDX-License-Identifier: Apache-2.0
"""Writes the drawings of this folder.  Usage: draw.py [FOLDER]"""

from __future__ import annotations

import sys
from pathlib import Path

import face
import figure
import snake

SETS = {"figure": figure, "snake": snake, "face": face}


def drawings() -> dict[str, str]:
    """Every file's name and text."""
    return {
        f"{name}-{pose}.svg": module.draw(pose).svg()
        for name, module in SETS.items()
        for pose in module.POSES
    }


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent
    for name, text in drawings().items():
        (folder / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
