# SPDX-License-Identifier: Apache-2.0
"""posespace build: drawings to a pose space, its mesh, its report and a sheet of pictures."""

from __future__ import annotations

import argparse
import contextlib
import math
from pathlib import Path

from posespace.client import Client
from posespace.command import output
from posespace.command.contact_sheet import contact_sheet
from posespace.command.documents import Document, mesh_document, session_document
from posespace.command.drawings import drawing_files, put_drawing, read_landmarks
from posespace.command.parsers import Commands
from posespace.command.progress import Progress
from posespace.command.values import placement
from posespace.errors import Error, InvalidArgument, NotFound
from posespace.files import whole_file
from posespace.session import Session

_MORE = """\
Each drawing is called as its file without the ending.  It may be a PNG, JPEG or
WebP picture, an SVG document, or rings in JSON, in pixels, x right, y down:
  {"outer": [[x, y], ...], "holes": [[[x, y], ...], ...], "texture": "FILE"}
where holes and texture, a picture of its pixels, may be left out.

With the name of a session that is there, drawings are added or replaced, and
what has not changed is not built again; drawings that are not named stay.

The folder gets mesh.json, report.json and contact-sheet.png.

examples:
  posespace build stand.png jump.png wave.png --session tux --out tux
  posespace build a.svg b.svg --place a=0,0 --place b=0,1 --out ab
"""


def add(commands: Commands) -> None:
    parser = commands.add("build", "turn drawings into a pose space", _MORE, run)
    parser.add_argument("drawings", metavar="DRAWING", nargs="+", type=Path, help="files")
    parser.add_argument(
        "--out", metavar="DIR", type=Path, required=True, help="folder for what it writes"
    )
    parser.add_argument(
        "--session", metavar="ID", help="name of the session; by default the service chooses one"
    )
    parser.add_argument(
        "--place",
        metavar="ID=X,Y",
        type=placement,
        action="append",
        default=[],
        help="a drawing's place in pose space; by default all lie on the unit circle",
    )
    parser.add_argument(
        "--landmarks",
        metavar="FILE",
        type=Path,
        help='marked places, which replace earlier ones: [{"stand": [x, y], "jump": [x, y]}, ...]',
    )
    parser.add_argument(
        "--remove", metavar="ID", action="append", default=[], help="a drawing to take out"
    )
    parser.add_argument(
        "--flip",
        metavar="ID",
        action="append",
        default=[],
        help="keep the mirror image of a drawing named here, as suggest proposes it; say so again "
        "whenever the drawing is named",
    )
    parser.add_argument(
        "--foreground",
        choices=["alpha", "light", "dark"],
        help="which pixels are the drawing; by default those that are not transparent",
    )
    parser.add_argument(
        "--threshold", metavar="N", type=int, help="from where on a pixel is painted, 1 to 255"
    )
    parser.add_argument(
        "--tolerance",
        metavar="R",
        type=float,
        help="farthest the mesh outline may lie from the drawing's, / its size; default 0.03",
    )
    parser.add_argument(
        "--target-edge-length",
        metavar="R",
        type=float,
        help="length of mesh edges, / size of the drawing; default 0.08",
    )
    parser.add_argument(
        "--max-vertices", metavar="N", type=int, help="most vertices of the mesh; default 8000"
    )
    parser.add_argument(
        "--rotation",
        choices=["upright", "any"],
        default="upright",
        help="whether drawings stand upright (the default) or may be turned at will",
    )
    parser.add_argument(
        "--no-align",
        action="store_true",
        help="leave inner vertices where they are, instead of moving them to what is drawn there",
    )


def run(client: Client, arguments: argparse.Namespace) -> None:
    files = drawing_files(arguments.drawings)
    for shape_id in arguments.flip:
        if shape_id not in files:
            raise InvalidArgument(
                f"--flip {shape_id}: name the drawing's file, too; the files given are of "
                f"{', '.join(files)}"
            )
    landmarks = read_landmarks(arguments.landmarks) if arguments.landmarks else None
    arguments.out.mkdir(parents=True, exist_ok=True)
    session, is_new = _session(client, arguments.session)
    before = session.state().revision
    try:
        with Progress() as progress:
            _upload(session, files, landmarks, arguments, progress)
            session.build(
                tolerance=arguments.tolerance,
                target_edge_length=arguments.target_edge_length,
                max_vertices=arguments.max_vertices,
                rotation=arguments.rotation,
                align=False if arguments.no_align else None,
                on_progress=progress.show,
            )
            document, written = _write(session, arguments.out, progress)
    except BaseException:
        if is_new and arguments.session is None:  # nobody could know its name
            with contextlib.suppress(Error):
                session.delete()
        raise
    document["rebuilt"] = document["revision"] != before
    if arguments.json:
        output.print_json({**document, "files": written})
    else:
        print("\n".join(_lines(document, set(files), written)))


def _session(client: Client, session_id: str | None) -> tuple[Session, bool]:
    """The session of that name, and whether it had to be made."""
    if session_id is not None:
        with contextlib.suppress(NotFound):
            return client.session(session_id), False
    return client.create_session(session_id), True


def _upload(
    session: Session,
    files: dict[str, Path],
    landmarks: list[dict[str, tuple[float, float]]] | None,
    arguments: argparse.Namespace,
    progress: Progress,
) -> None:
    for k, (shape_id, file) in enumerate(files.items()):
        progress.show(f"uploading {file.name}", k / len(files))
        flip = shape_id in arguments.flip
        put_drawing(session, shape_id, file, arguments.foreground, arguments.threshold, flip)
    for shape_id in arguments.remove:
        session.delete_shape(shape_id)
    state = session.state()
    if arguments.place:
        wanted = dict(arguments.place)
        if len(wanted) < len(arguments.place):
            raise InvalidArgument("--place names a drawing twice")
        kept = {} if state.placements_are_default else state.placements
        if {**kept, **wanted} != kept:
            session.set_placements({**kept, **wanted})
    if landmarks is not None and landmarks != state.correspondences:
        session.set_correspondences(landmarks)


def _write(session: Session, out: Path, progress: Progress) -> tuple[Document, dict[str, str]]:
    """Writes the files, and answers the report and where they are."""
    mesh, shapes = session.mesh(), session.shapes()
    sheet = contact_sheet(session, mesh, lambda done: progress.show("drawing a sheet", done))
    document = session_document(session)
    written = {
        "mesh": out / "mesh.json",
        "report": out / "report.json",
        "contact_sheet": out / "contact-sheet.png",
    }
    output.write_json(written["mesh"], mesh_document(mesh, shapes))
    output.write_json(written["report"], document)
    with whole_file(written["contact_sheet"]) as file:
        sheet.save(file, format="PNG")
    return document, {name: str(path) for name, path in written.items()}


def _lines(document: Document, named: set[str], written: dict[str, str]) -> list[str]:
    report, shapes = document["report"], document["shapes"]
    how = f"built in {sum(report['seconds'].values()):.2f} s"
    if not document["rebuilt"]:
        how = "built before, nothing has changed"
    lines = [
        f"session {document['session']}: {output.counted(len(shapes), 'drawing')}, {how}",
        f"  {output.counted(report['vertices'], 'vertex')}, "
        f"{output.counted(report['triangles'], 'triangle')}, smallest angle "
        f"{math.degrees(report['min_angle']):.1f} degrees",
    ]
    kept = [shape["id"] for shape in shapes if shape["id"] not in named]
    if kept:
        lines.append(f"  kept from before: {', '.join(kept)}")
    for shape in shapes:
        lines += [f"  {shape['id']}: {warning}" for warning in shape["warnings"]]
    lines += [f"  {warning}" for warning in report["warnings"]]
    return lines + [f"  wrote {path}" for path in written.values()]
