# SPDX-License-Identifier: Apache-2.0
"""What words of the command line mean: points, sizes, weights, paths."""

from __future__ import annotations

import argparse
import json
import re
from pathlib import Path

from posespace.errors import InvalidArgument

Waypoint = tuple[float, ...]  # x, y or x, y, seconds


def _numbers(text: str, counts: tuple[int, ...], form: str) -> tuple[float, ...]:
    try:
        numbers = tuple(float(word) for word in text.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) not in counts:
        raise argparse.ArgumentTypeError(f"'{text}' is not {form}")
    return numbers


def address(text: str) -> str:
    """127.0.0.1:7433"""
    if not text:
        raise argparse.ArgumentTypeError("an address is HOST:PORT or unix:PATH")
    return text


def point(text: str) -> tuple[float, float]:
    """0.5,1"""
    x, y = _numbers(text, (2,), "X,Y such as 0.5,1")
    return x, y


def _named(text: str, form: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not (name and equals and value):
        raise argparse.ArgumentTypeError(f"'{text}' is not {form}")
    return name, value


def placement(text: str) -> tuple[str, tuple[float, float]]:
    """stand=0,1"""
    form = "ID=X,Y such as stand=0,1"
    name, value = _named(text, form)
    x, y = _numbers(value, (2,), form)
    return name, (x, y)


def weights(text: str) -> dict[str, float]:
    """stand=0.5,jump=0.5"""
    form = "ID=WEIGHT,... such as stand=0.5,jump=0.5"
    found: dict[str, float] = {}
    for part in text.split(","):
        name, value = _named(part, form)
        if name in found:
            raise argparse.ArgumentTypeError(f"'{text}' weighs '{name}' twice")
        (found[name],) = _numbers(value, (1,), form)
    return found


def size(text: str) -> tuple[int, int]:
    """320x240"""
    sides = re.fullmatch(r"(\d{1,6})x(\d{1,6})", text)
    if sides is None:
        raise argparse.ArgumentTypeError(f"'{text}' is not WIDTHxHEIGHT such as 320x240")
    return int(sides[1]), int(sides[2])


def path(text: str) -> list[Waypoint]:
    """0,0 0.5,1 0,1"""
    form = "points X,Y or X,Y,SECONDS with spaces between them, such as '0,0 0.5,1 0,1'"
    if not text.split():
        raise argparse.ArgumentTypeError(f"'{text}' is not {form}")
    return [_numbers(word, (2, 3), form) for word in text.split()]


def path_file(file: Path) -> list[Waypoint]:
    """The waypoints in a file: JSON, or lines "x y [seconds]".

    Raises InvalidArgument that names the line or the waypoint at fault, OSError.
    """
    text = read_text(file)
    if text.lstrip().startswith(("[", "{")):
        document = read_json(file, text)
        if not isinstance(document, list) or not document:
            raise InvalidArgument(
                f"{file}: a path in JSON is a list [[x, y], [x, y, seconds], ...]"
            )
        for k, waypoint in enumerate(document):
            if not is_numbers(waypoint, (2, 3)):
                raise InvalidArgument(
                    f"{file}: waypoint {k} is {json.dumps(waypoint)[:60]}, not [x, y] or "
                    f"[x, y, seconds]"
                )
        return [tuple(waypoint) for waypoint in document]
    waypoints: list[Waypoint] = []
    for number, line in enumerate(text.splitlines(), start=1):
        words = line.partition("#")[0].replace(",", " ").split()
        if not words:
            continue
        try:
            waypoints.append(_numbers(",".join(words), (2, 3), "x y or x y seconds"))
        except argparse.ArgumentTypeError:
            raise InvalidArgument(
                f"{file}: line {number} is '{line.strip()[:60]}', not x y or x y seconds"
            ) from None
    if not waypoints:
        raise InvalidArgument(f"{file}: there is no waypoint in it")
    return waypoints


def read_text(file: Path) -> str:
    """A file's text.  Raises InvalidArgument when it is none, OSError."""
    try:
        return file.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        raise InvalidArgument(f"{file}: this is not text in UTF-8") from None


def read_json(file: Path, text: str) -> object:
    """A file's JSON document.  Raises InvalidArgument that says where it is broken."""
    try:
        document: object = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InvalidArgument(f"{file}: this is not JSON: {error}") from None
    return document


def is_numbers(value: object, counts: tuple[int, ...]) -> bool:
    """Whether a JSON value is a list of so many numbers."""
    return (
        isinstance(value, list)
        and len(value) in counts
        and all(isinstance(x, int | float) and not isinstance(x, bool) for x in value)
    )
