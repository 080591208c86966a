"""The work counts of the open scene as a table."""

from typing import NamedTuple

from app.formats.formatting import fixed, number
from app.messages import WorkCounts
from app.render.html import Html, table


class WorkRow(NamedTuple):
    """One kind of work."""

    what: str  # with its unit
    done: float
    skipped: float
    skipped_percent: float


def work_rows(counts: WorkCounts) -> list[WorkRow]:
    """A row for each kind of work."""
    return [
        WorkRow(f"{what} [{work.unit}]" if work.unit else what, work.done, work.skipped, 100.0 * work.skipped_share)
        for what, work in counts.items()
    ]


def work_table(counts: WorkCounts) -> Html:
    """The work counts as an HTML table."""
    return table(
        (("", ""), ("done", ""), ("not needed", ""), ("not needed", "%")),
        ((row.what, number(row.done), number(row.skipped), fixed(row.skipped_percent, 0)) for row in work_rows(counts)),
    )
