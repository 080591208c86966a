"""The work counts of each scene after some seconds with its default parameters: what was done and what was skipped."""

from typing import Any

from app.bench.cases.frames import run_scene
from app.panel.work_table import work_rows
from app.scenes import NAMES


def rows(quick: bool = False) -> list[dict[str, Any]]:
    """Rows of scene, what, done, skipped, skipped [%]. Modules are counted for the process and not for the scene."""
    table = []
    for name in NAMES:
        _, counts = run_scene(name, 20 if quick else 150)
        table += [{"scene": name, **row._asdict()} for row in work_rows(counts) if row.done or row.skipped]
    return table
