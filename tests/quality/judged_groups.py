# SPDX-License-Identifier: Apache-2.0
"""How the matching of each group of real drawings was judged by eye (judged_groups.json), beside
how sure the service is of it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

DOUBTFUL = 0.5  # confidence below which a person is asked to look


def verdicts() -> dict[str, str]:
    """Group -> "right", "wrong" or "unlike", which has no right answer."""
    groups = json.loads(Path(__file__).with_name("judged_groups.json").read_text())["groups"]
    return {group["group"]: group["verdict"] for group in groups}


def table(confidence: Mapping[str, float]) -> str:
    """Groups by their least confidence, as Markdown."""
    lines = ["| confidence | verdict | group |", "|---|---|---|"]
    judged = verdicts()
    for name, least in sorted(confidence.items(), key=lambda item: item[1]):
        lines.append(f"| {least:.2f} | {judged.get(name, 'not judged')} | {name} |")
    return "\n".join(lines) + "\n"
