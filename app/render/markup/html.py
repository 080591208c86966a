"""HTML for panel and reports: text from outside is escaped by construction.

`fill` puts values into a template and escapes each one unless it is `Html` already. Templates are literals in the
source, which pyright checks, so that no text from outside can be taken for HTML.
"""

from collections.abc import Iterable, Sequence
from typing import LiteralString, NamedTuple

import markupsafe

# Declared in `js/page.css`, once for the light and once for the dark panel.
GOOD_COLOUR, WARNING_COLOUR, ERROR_COLOUR, WRONG_COLOUR = (
    f"var(--springtide-{name})" for name in ("good", "warning", "error", "wrong")
)

# Text that is HTML: any other text is escaped where it becomes part of it. What is handed to viser is converted by
# `str` first, as viser's encoder refuses subclasses of `str`.
Html = markupsafe.Markup
escape = markupsafe.escape  # any text as HTML; `Html` as it is


def fill(template: LiteralString, *values: object, **named: object) -> Html:
    """The HTML `template` with its fields filled in as by `str.format`; `Html` says how values are escaped."""
    return Html(template).format(*values, **named)


def join(parts: Iterable[object], separator: LiteralString = "") -> Html:
    """Parts one after the other, each escaped unless it is `Html`."""
    return Html(separator).join(map(escape, parts))


def note(text: object) -> str:
    """Text with the panel's margins, as viser takes it: a plain `str`, as it encodes no subclass of it."""
    return str(fill('<div class="springtide-note">{}</div>', text))


def lines(texts: Iterable[object]) -> Html:
    """Each text on a line of its own, with a little space above it."""
    return join(fill('<div style="margin-top:4px">{}</div>', text) for text in texts)


def faint(text: object) -> Html:
    """Text of secondary importance, on a line of its own."""
    return fill('<div class="springtide-faint">{}</div>', text)


def bold(text: object) -> Html:
    """Important text."""
    return fill("<b>{}</b>", text)


def coloured(text: object, colour: str) -> Html:
    """Important text in a CSS colour."""
    return fill('<b style="color:{}">{}</b>', colour, text)


def info(text: str, section: str) -> Html:
    """A sign that shows a text below it under mouse or finger, and the section of docs/physics.md that says more.

    text: two sentences.
    """
    return fill(
        '<span class="springtide-info" tabindex="0" role="note" aria-label="{0}" data-text="{0}">i</span>',
        f"{text} More in docs/physics.md, {section}.",
    )


class TableCell(NamedTuple):
    """A cell of a table with a name for the style sheet, over several columns."""

    content: object
    name: str = ""
    columns: int = 1


def table_row(cells: Iterable[object], tag: LiteralString = "td") -> Html:
    """A row of cells or their contents. The panel puts the first to the left, and the others, numbers, to the right."""
    table_cells = (cell if isinstance(cell, TableCell) else TableCell(cell) for cell in cells)
    return fill("<tr>{}</tr>", join(cell_html(cell, tag) for cell in table_cells))


def cell_html(cell: TableCell, tag: LiteralString) -> Html:
    """A cell; without a name and over one column it has no attributes."""
    name = fill(' class="{}"', cell.name) if cell.name else Html()
    width = fill(' colspan="{}"', cell.columns) if cell.columns > 1 else Html()
    return fill("<{0}{1}{2}>{3}</{0}>", tag, name, width, cell.content)


def plain_table(rows: Iterable[Iterable[object]], head: Sequence[object] = (), name: str = "") -> Html:
    """A table of a page without the panel. rows, head: cells or their contents; name: for the style sheet."""
    top = fill("<thead>{}</thead>", table_row(head, "th")) if head else Html()
    body = join(table_row(row) for row in rows)
    return fill("<table{}>{}<tbody>{}</tbody></table>", fill(' class="{}"', name) if name else Html(), top, body)


def table_head(columns: Iterable[tuple[object, object]]) -> Html:
    """The head of a table: for each column its name over its unit."""
    return fill("<thead>{}</thead>", table_row((fill("{}<br>{}", *column) for column in columns), "th"))


def table(columns: Iterable[tuple[object, object]], rows: Iterable[Sequence[object]]) -> Html:
    """A table as wide as the panel. columns: (name, unit) of each, at most seven; rows: one cell a column."""
    body = join(table_row(cells) for cells in rows)
    return fill('<table class="springtide-table">{}<tbody>{}</tbody></table>', table_head(columns), body)
