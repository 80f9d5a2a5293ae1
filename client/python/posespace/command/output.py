# SPDX-License-Identifier: Apache-2.0
"""What commands print: JSON for programs, lines and tables for people."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from datetime import datetime
from pathlib import Path

import numpy as np

from posespace.files import whole_file


def _plain(value: object) -> object:
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, datetime):
        return value.isoformat()
    if isinstance(value, Path):
        return str(value)
    raise TypeError(f"{type(value).__name__} has no form in JSON")


def json_text(document: object) -> str:
    """A document on one line; arrays as nested lists."""
    return json.dumps(document, default=_plain)


def print_json(document: object) -> None:
    """One document on standard output."""
    print(json_text(document))


def write_json(path: Path, document: object) -> None:
    """One document as a file that appears when it is whole."""
    with whole_file(path) as file:
        file.write(json_text(document).encode() + b"\n")


def table(header: Sequence[str], rows: Iterable[Sequence[str]], indent: str = "") -> str:
    """Columns as wide as their widest cell."""
    cells = [list(header), *map(list, rows)]
    widths = [max(len(row[column]) for row in cells) for column in range(len(header))]
    lines = ("  ".join(map(str.ljust, row, widths)).rstrip() for row in cells)
    return "\n".join(indent + line for line in lines)


def place(at: Iterable[float]) -> str:
    """(0.5, 1)"""
    return "(" + ", ".join(f"{number:g}" for number in at) + ")"


def counted(number: int, word: str) -> str:
    """3 drawings"""
    plural = word[:-2] + "ices" if word.endswith("ex") else word + "s"
    return f"{number:,} {word if number == 1 else plural}"
