# SPDX-License-Identifier: Apache-2.0
"""Sessions and meshes as JSON documents; docs/mesh.md and docs/command.md describe them."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from posespace.errors import NotBuilt
from posespace.results import Build, BuildReport, Mesh, Shape
from posespace.session import Session

MESH_FORMAT = "posespace-mesh/1"
REPORT_FORMAT = "posespace-report/1"

Document = dict[str, Any]


def mesh_document(mesh: Mesh, shapes: list[Shape]) -> Document:
    """mesh.json: the mesh in every drawing."""
    sizes = {shape.id: shape.size for shape in shapes}
    return {
        "format": MESH_FORMAT,
        "revision": mesh.revision,
        "triangles": mesh.triangles,
        "boundary": [loop.tolist() for loop in mesh.boundary],
        "landmarks": mesh.landmarks,
        "shapes": [
            {
                "id": shape_id,
                "size": sizes[shape_id],
                "vertices": mesh.vertices[shape_id],
                "outlines": [ring.tolist() for ring in mesh.outlines[shape_id]],
                "turns": mesh.turns[shape_id],
            }
            for shape_id in mesh.shape_ids
        ],
        "report": report_document(mesh.report),
    }


def report_document(report: BuildReport) -> Document:
    """How a build went; what is said by name is in the order of names."""
    return {
        name: dict(sorted(value.items())) if isinstance(value, dict) else value
        for name, value in asdict(report).items()
        if name != "revision"
    }


def built_mesh(session: Session) -> Mesh | None:
    """The mesh, if the session is built."""
    try:
        return session.mesh()
    except NotBuilt:
        return None


def session_document(session: Session) -> Document:
    """report.json, and what `inspect` says: everything about a session but the points."""
    state, shapes, mesh = session.state(), session.shapes(), built_mesh(session)
    confidence = mesh.report.confidence if mesh else {}
    return {
        "format": REPORT_FORMAT,
        "session": state.id,
        "display_name": state.display_name,
        "labels": state.labels,
        "created": state.create_time,
        "changed": state.update_time,
        "etag": state.etag,
        "revision": state.revision,
        "shapes": [
            {
                "id": shape.id,
                "size": shape.size,
                "outline_points": [len(ring) for ring in shape.outline],
                "holes_filled": shape.holes_filled,
                "flipped": shape.flipped,
                "confidence": confidence.get(shape.id),
                "placement": state.placements.get(shape.id),
                "warnings": shape.warnings,
            }
            for shape in shapes
        ],
        "placements_are_default": state.placements_are_default,
        "correspondences": state.correspondences,
        "build": _build_document(state.build),
        "report": report_document(mesh.report) if mesh else None,
    }


def _build_document(build: Build | None) -> Document | None:
    if build is None:
        return None
    return {
        "state": build.state,
        "stage": build.stage,
        "fraction": build.fraction,
        "error": str(build.error) if build.error else None,
        "reason": build.error.reason if build.error else None,
    }
