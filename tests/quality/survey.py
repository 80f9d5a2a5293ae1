# SPDX-License-Identifier: Apache-2.0
"""Measures every group of drawings, real and generated, and draws contact sheets of them.

    build/venv/bin/python tests/quality/survey.py [--out DIR] [--sheets] [--thorough]
                                                  [--tighten | --accept] [GROUP ...]

Leaves DIR/quality.md, DIR/confidence.md and, with --sheets, DIR/GROUP.png; see
contact_sheets.py.  DIR is build/quality unless told otherwise.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import posespace

sys.path.append(str(Path(__file__).resolve().parents[1] / "support"))

import judged_groups
import quality_bounds
from contact_sheets import contact_sheet
from families import generated_groups
from quality_table import Group, Row, line, measure, table
from quality_targets import REAL, Survey, foot, pair_errors
from real_groups import ROOT, all_groups

OUT = ROOT / "build/quality"


def document(survey: Survey) -> str:
    return f"# Quality\n\n{table(survey.rows)}\n{foot(survey)}"


def write(survey: Survey, folder: Path = OUT) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "quality.md").write_text(document(survey))
    confidence = {row.name: row.values["confidence"] for row in survey.rows if row.kind in REAL}
    (folder / "confidence.md").write_text(judged_groups.table(confidence))


def store_bounds(survey: Survey, whole: bool, accept: bool) -> None:
    """Tightens the stored bounds of what was measured, or replaces them."""
    bounds = quality_bounds.load() if quality_bounds.FILE.exists() else {}
    found = {row.name: quality_bounds.of_row(row) for row in survey.rows}
    if whole:
        found[quality_bounds.OVER_ALL] = quality_bounds.of_targets(survey)
    for name, new in found.items():
        bounds[name] = new if accept else quality_bounds.tightened(bounds.get(name, {}), new)
    quality_bounds.save(bounds)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("groups", nargs="*", metavar="GROUP", help="default: all")
    parser.add_argument("--out", type=Path, default=OUT)
    parser.add_argument("--sheets", action="store_true", help="draw contact sheets, too")
    parser.add_argument("--thorough", action="store_true", help="more generated groups, N = 2..8")
    writing = parser.add_mutually_exclusive_group()
    writing.add_argument("--tighten", action="store_true", help="store bounds that got better")
    writing.add_argument("--accept", action="store_true", help="store bounds, also worse ones")
    arguments = parser.parse_args()
    groups: list[Group] = [*all_groups(), *generated_groups(arguments.thorough)]
    if arguments.groups:
        groups = [group for group in groups if group.name in arguments.groups]
    arguments.out.mkdir(parents=True, exist_ok=True)
    rows: list[Row] = []
    with (
        posespace.serve_locally() as server,
        posespace.connect(server.address, timeout=120) as client,
    ):
        for group in groups:
            session = client.create_session(display_name=group.name)
            try:
                group.upload(session)
                session.build()
                rows.append(measure(session, group))
                print(line(rows[-1]), flush=True)
                if arguments.sheets:
                    contact_sheet(session).save(arguments.out / f"{group.name}.png")
            except posespace.Error as error:
                print(f"{group.name}: {error}", flush=True)
            session.delete()
        whole = not arguments.groups
        survey = Survey(rows, pair_errors(client) if whole else [])
    write(survey, arguments.out)
    print(foot(survey))
    if arguments.tighten or arguments.accept:
        store_bounds(survey, whole and not arguments.thorough, arguments.accept)


if __name__ == "__main__":
    main()
