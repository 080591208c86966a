"""The work counts of the open scene as a table."""

import html
from typing import Any

from app.messages import WorkCounts


def work_rows(counts: WorkCounts) -> list[dict[str, Any]]:
    """A table: what, done, skipped, skipped [%]."""
    return [
        {
            "what": f"{what} [{work.unit}]" if work.unit else what,
            "done": work.done,
            "skipped": work.skipped,
            "skipped [%]": 100.0 * work.skipped_share,
        }
        for what, work in counts.items()
    ]


def short(value: float) -> str:
    """A count whole, anything else to three digits."""
    return f"{value:,.0f}" if value == int(value) else f"{value:.3g}"


def work_table(counts: WorkCounts) -> str:
    """The ledger as an HTML table."""
    cell = '<td style="text-align:right;padding-left:8px">'
    lines = [
        f"<tr><td>{html.escape(row['what'])}</td>{cell}{short(row['done'])}</td>{cell}{short(row['skipped'])}</td>"
        f"{cell}{row['skipped [%]']:.0f}</td></tr>"
        for row in work_rows(counts)
    ]
    head = f"<tr><td></td>{cell}<b>done</b></td>{cell}<b>not needed</b></td>{cell}<b>%</b></td></tr>"
    return f'<table style="width:100%;font-variant-numeric:tabular-nums">{head}{"".join(lines)}</table>'
