# SPDX-License-Identifier: Apache-2.0
"""Drawings as files: which there are, what they are called, how they are uploaded."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from posespace.command.values import is_numbers, read_json, read_text
from posespace.errors import Error, InvalidArgument, InvalidDrawing
from posespace.results import Shape
from posespace.session import Session

VECTOR = (".svg", ".svgz")
RINGS = ".json"


def drawing_files(names: Sequence[Path]) -> dict[str, Path]:
    """The files by the ids of their drawings, which are their names without the ending.

    Raises InvalidArgument for two files of one id, OSError for those that cannot be read.
    """
    files: dict[str, Path] = {}
    for file in names:
        with open(file, "rb"):
            pass
        if file.stem in files:
            raise InvalidArgument(
                f"{files[file.stem]} and {file} would both be drawing '{file.stem}', for a "
                f"drawing is called as its file without the ending; rename one"
            )
        files[file.stem] = file
    return files


def put_drawing(
    session: Session,
    shape_id: str,
    file: Path,
    foreground: str | None,
    threshold: int | None,
    flip: bool = False,
) -> Shape:
    """Uploads a drawing in place of one of its id: a picture, an SVG document, or rings in JSON.

    Raises what Session.put_shape does, naming the file; OSError.
    """
    kept: dict[str, Any] = {"replace": True, "flip": flip}
    options: dict[str, Any] = {}
    if foreground is not None:
        options["foreground"] = foreground
    if threshold is not None:
        options["threshold"] = threshold
    try:
        if file.suffix.lower() == RINGS:
            return session.put_shape(shape_id, **kept, **_rings(file))
        source: dict[str, Any] = {"image": file}
        if file.suffix.lower() in VECTOR:
            source = {"svg": file}
        return session.put_shape(shape_id, **kept, **source, **options)
    except Error as error:
        advice = "; rename the file" if error.reason == "INVALID_ID" else ""
        said = str(error) if str(error).startswith(f"{file}:") else f"{file}: {error}"
        raise type(error)(
            said + advice,
            reason=error.reason,
            fields=error.fields,
            retry_after=error.retry_after,
        ) from None


def _rings(file: Path) -> dict[str, Any]:
    """The arguments of put_shape in a document of rings, docs/command.md."""
    document = read_json(file, read_text(file))
    if not isinstance(document, dict) or "outer" not in document:
        raise InvalidDrawing(
            f'{file}: a drawing in JSON is {{"outer": [[x, y], ...], "holes": [...]}}'
        )
    holes = document.get("holes", [])
    if not isinstance(holes, list):
        raise InvalidDrawing(f"{file}: holes are a list of rings")
    names = ["outer", *(f"holes[{k}]" for k in range(len(holes)))]
    for name, ring in zip(names, [document["outer"], *holes], strict=True):
        if not isinstance(ring, list) or not all(is_numbers(point, (2,)) for point in ring):
            raise InvalidDrawing(f"{file}: {name} is not a list of points [x, y]")
    texture = document.get("texture")
    if texture is None:
        return {"polygon": document["outer"], "holes": holes}
    if not isinstance(texture, str):
        raise InvalidDrawing(f"{file}: texture is not the name of a picture file")
    try:
        pixels = (file.parent / texture).read_bytes()
    except OSError as error:
        raise InvalidDrawing(f"{file}: its texture {texture}: {error.strerror}") from None
    return {"polygon": document["outer"], "holes": holes, "texture": pixels}


def read_landmarks(file: Path) -> list[dict[str, tuple[float, float]]]:
    """Marked places: a JSON list of {"drawing": [x, y], ...}, in drawing pixels.

    Raises InvalidArgument that names the entry at fault, OSError.
    """
    document = read_json(file, read_text(file))
    if not isinstance(document, list):
        raise InvalidArgument(f'{file}: landmarks are a list [{{"drawing": [x, y], ...}}, ...]')
    for k, places in enumerate(document):
        if not isinstance(places, dict) or not all(is_numbers(at, (2,)) for at in places.values()):
            raise InvalidArgument(f'{file}: landmark {k} is not {{"drawing": [x, y], ...}}')
    return [{name: (at[0], at[1]) for name, at in places.items()} for places in document]
