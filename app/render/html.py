"""HTML for panel and reports: text from outside is escaped by construction.

`fill` puts values into a template and escapes each one unless it is `Html` already. Templates are literals in the
source, which pyright checks, so that no text from outside can be taken for HTML.
"""

import html
import string
from collections.abc import Iterable, Sequence
from typing import Any, LiteralString

# Declared in `js/page.css`, once for the light and once for the dark panel.
GOOD_COLOUR, WARNING_COLOUR, ERROR_COLOUR = (f"var(--springtide-{name})" for name in ("good", "warning", "error"))


class Html(str):
    """Text that is HTML. Any other text is escaped where it becomes part of HTML.

    What is handed to viser is converted by `str` first: viser's encoder refuses subclasses of `str`.
    """

    __slots__ = ()


class EscapingFormatter(string.Formatter):
    """Formats as `str.format` does, and escapes every value that is not `Html`."""

    def format_field(self, value: Any, format_spec: str) -> str:
        """One value as HTML."""
        return value if isinstance(value, Html) else html.escape(format(value, format_spec))


FORMATTER = EscapingFormatter()


def fill(template: LiteralString, *values: object, **named: object) -> Html:
    """The HTML `template` with its fields, `{}`, `{0}` or `{name:.3g}`, filled in; see `Html` for what is escaped."""
    return Html(FORMATTER.vformat(template, values, named))


def escape(text: object) -> Html:
    """Any text as HTML; `Html` as it is."""
    return text if isinstance(text, Html) else Html(html.escape(str(text)))


def join(parts: Iterable[object], separator: LiteralString = "") -> Html:
    """Parts one after the other, each escaped unless it is `Html`."""
    return Html(separator.join(escape(part) for part in parts))


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


def table_row(cells: Iterable[object], tag: LiteralString = "td") -> Html:
    """A row of a table. The style sheet puts the first cell to the left, and the others, numbers, to the right."""
    return fill("<tr>{}</tr>", join(fill("<{0}>{1}</{0}>", tag, cell) for cell in cells))


def table_head(columns: Iterable[tuple[object, object]]) -> Html:
    """The head of a table: for each column its name over its unit."""
    return fill("<thead>{}</thead>", table_row((fill("{}<br>{}", *column) for column in columns), "th"))


def table(columns: Iterable[tuple[object, object]], rows: Iterable[Sequence[object]]) -> Html:
    """A table as wide as the panel, of at most five columns. columns: (name, unit) of each; rows: one cell a column."""
    body = join(table_row(cells) for cells in rows)
    return fill('<table class="springtide-table">{}<tbody>{}</tbody></table>', table_head(columns), body)
