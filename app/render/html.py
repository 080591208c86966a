"""HTML for panel and reports: text from outside is escaped by construction, and numbers are written alike everywhere.

`fill` puts values into a template and escapes each one unless it is `Html` already. Templates are literals in the
source, which pyright checks, so that no text from outside can be taken for HTML.
"""

import html
import math
import string
from collections.abc import Iterable, Sequence
from typing import Any, LiteralString

NO_NUMBER = "–"
GOOD_COLOUR, WARNING_COLOUR, ERROR_COLOUR = "#2b8a3e", "#e67700", "#c92a2a"  # readable on light and dark panels
LENGTH_UNITS = (("m", 1.0), ("mm", 1e-3), ("µm", 1e-6), ("nm", 1e-9))  # [m]
# [s] of each unit, and how many of it there must be at least before it is used.
TIME_UNITS = (
    ("years", 3.156e7, 1.5),
    ("days", 86400.0, 1.5),
    ("h", 3600.0, 1.5),
    ("min", 60.0, 1.5),
    ("s", 1.0, 0.9995),
    ("ms", 1e-3, 0.9995),
    ("µs", 1e-6, 0.0),
)
MAX_GROUPED = 1e6  # numbers below are written out in full, larger ones with a power of ten


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
    """Small text with the panel's margins, as viser takes it: a plain `str`, as it encodes no subclass of it."""
    return str(fill('<div style="padding:2px 12px 8px;font-size:12px">{}</div>', text))


def lines(texts: Iterable[object]) -> Html:
    """Each text on a line of its own, with a little space above it."""
    return join(fill('<div style="margin-top:4px">{}</div>', text) for text in texts)


def faint(text: object) -> Html:
    """Text of secondary importance, on a line of its own."""
    return fill('<div style="opacity:.75">{}</div>', text)


def bold(text: object) -> Html:
    """Important text."""
    return fill("<b>{}</b>", text)


def coloured(text: object, colour: str) -> Html:
    """Important text in a CSS colour."""
    return fill('<b style="color:{}">{}</b>', colour, text)


def row(cells: Sequence[object], tag: LiteralString = "td") -> Html:
    """A row of a table: the first cell to the left, the others to the right, where numbers belong."""
    first = '<{0} style="text-align:left;font-weight:inherit;padding:1px 6px 1px 0">{1}</{0}>'
    other = '<{0} style="text-align:right;font-weight:inherit;padding:1px 0 1px 6px">{1}</{0}>'
    return fill("<tr>{}</tr>", join(fill(other if i else first, tag, cell) for i, cell in enumerate(cells)))


def table(head: Sequence[object], rows: Iterable[Sequence[object]]) -> Html:
    """A table as wide as the panel; `head` and each row hold one entry a column."""
    return fill(
        '<table style="width:100%;border-spacing:0;font-size:12px;font-variant-numeric:tabular-nums">'
        '<thead style="opacity:.75">{}</thead><tbody>{}</tbody></table>',
        row(head, "th"),
        join(row(cells) for cells in rows),
    )


def number(value: float, digits: int = 3) -> str:
    """A number with `digits` significant digits; – for NaN, ∞ for infinity. Whole thousands are written out."""
    if math.isnan(value):
        return NO_NUMBER
    if math.isinf(value):
        return "∞" if value > 0.0 else "-∞"
    if abs(value) < MAX_GROUPED and (value == int(value) or abs(value) >= 10**digits):
        return f"{value:,.0f}"
    return f"{value:.{digits}g}"


def fixed(value: float, decimals: int) -> str:
    """A number with `decimals` digits after the point; – where it is NaN or infinite."""
    return f"{value:.{decimals}f}" if math.isfinite(value) else NO_NUMBER


def metres(value: float) -> str:
    """A length [m] in the unit in which it is easily read, m to nm; – for NaN."""
    if not math.isfinite(value):
        return number(value)
    for unit, size in LENGTH_UNITS:
        if abs(value) >= 0.9995 * size:
            return f"{number(value / size)} {unit}"
    return f"{value:.1e} m" if value else "0 m"


def seconds(value: float, digits: int = 3) -> str:
    """A time [s] in the unit in which it is easily read, years to µs; – for NaN."""
    if not math.isfinite(value):
        return number(value)
    if value == 0.0:
        return "0 s"
    unit, size = next((unit, size) for unit, size, least in TIME_UNITS if abs(value) >= least * size)
    return f"{number(value / size, digits)} {unit}"
