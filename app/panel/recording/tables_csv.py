"""Tables of the panel as CSV: the displayed cells, with numbers in machine-readable form."""

import csv
import io
import re
from html.parser import HTMLParser

from app.formats.formatting import NO_NUMBER, SUPERSCRIPTS, THOUSANDS

POWER = re.compile(r" × 10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)")
DIGITS = str.maketrans({sign: chr(plain) for plain, sign in SUPERSCRIPTS.items()})
HIDDEN_CLASS = "springtide-info"  # of an information sign, whose text does not belong to its cell
NO_TABLE = "there is no table here now"


class Tables(HTMLParser):
    """Reads the tables out of a text of `app.render.markup.html`."""

    def __init__(self) -> None:
        super().__init__()
        self.tables: list[list[list[str]]] = []  # rows of cells
        self.cell: list[str] | None = None  # parts of the present cell: a heading has its unit in the second
        self.skipping = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Begin a table, row, cell or line, or a sign without content."""
        if tag == "table":
            self.tables.append([])
        elif tag == "tr":
            self.tables[-1].append([])
        elif tag in ("td", "th"):
            self.cell = [""]
        elif tag == "br" and self.cell is not None:
            self.cell.append("")
        elif tag == "span" and ("class", HIDDEN_CLASS) in attrs:
            self.skipping = True

    def handle_endtag(self, tag: str) -> None:
        """End a cell, or the sign."""
        if tag == "span":
            self.skipping = False
        elif tag in ("td", "th") and self.cell is not None:
            words = [part.strip() for part in self.cell]
            unit = f" [{words[1]}]" if tag == "th" and words[1:] and words[1] else ""
            self.tables[-1][-1].append(words[0] + unit if tag == "th" else plain(" ".join(words)))
            self.cell = None

    def handle_data(self, data: str) -> None:
        """Add text to a cell."""
        if self.cell is not None and not self.skipping:
            self.cell[-1] += data


def plain(cell: str) -> str:
    """A cell with its numbers as programs read them; "" for no number."""
    text = POWER.sub(lambda match: "e" + match[1].translate(DIGITS), cell.replace(THOUSANDS, ""))
    return "" if text == NO_NUMBER else text.replace("−", "-").replace("\u00a0", " ")


def has_table(text: str) -> bool:
    """True if a text has a table."""
    return "<table" in text


def tables_csv(text: str) -> str:
    """The tables of a text of the panel as CSV, with an empty line between two. Raises ValueError for no table."""
    reader = Tables()
    reader.feed(text)
    reader.close()
    if not reader.tables:
        raise ValueError(NO_TABLE)
    content = io.StringIO()
    writer = csv.writer(content, lineterminator="\n")
    for number, rows in enumerate(reader.tables):
        if number > 0:
            writer.writerow(())
        writer.writerows(rows)
    return content.getvalue()
