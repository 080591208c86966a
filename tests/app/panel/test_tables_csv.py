"""Tables of the panel as files: what is shown, in numbers that programs read."""

import csv
import io
from typing import Any

import pytest

from app.formats.formatting import number
from app.panel.recording.tables_csv import has_table, tables_csv
from app.render.markup.html import bold, coloured, faint, fill, info, join, table
from app.scenes import NAMES, scene_named, view_named
from app.scenes.setups import make_setup
from app.server.loop.sim_loop import SimLoop


def rows_of(text: str) -> list[list[str]]:
    return list(csv.reader(io.StringIO(text)))


def test_cells_are_those_of_the_table_and_numbers_are_read_by_programs() -> None:
    shown = table(
        (("Line", ""), (fill("force {}", info("How it is meant.", "1. Springs")), "kN"), ("share", "%")),
        (
            (1, bold(number(-69300.0)), number(0.00189)),
            ("A, with <b>", coloured(number(1.3e8), "red"), number(float("nan"))),
        ),
    )
    other = table((("name", ""), ("n", "")), ((fill("{}", "two"), number(12345678.9)),))
    text = tables_csv(join((faint("Before."), shown, "between", other)))
    assert rows_of(text) == [
        ["Line", "force [kN]", "share [%]"], ["1", "-69300", "0.00189"], ["A, with <b>", "1.3e8", ""],
        [],
        ["name", "n"], ["two", "1.23e7"],
    ]  # fmt: skip
    assert float(rows_of(text)[2][1]) == 1.3e8


def test_a_text_without_a_table_has_no_file() -> None:
    assert not has_table(faint("No table"))
    with pytest.raises(ValueError, match="no table"):
        tables_csv(faint("No table"))


@pytest.mark.parametrize("name", NAMES)
def test_every_table_of_the_first_seconds_becomes_as_many_rows(name: str) -> None:
    kind = scene_named(name)
    loop = SimLoop(kind.make(make_setup(kind, next(iter(kind.presets))).params))
    for _ in range(30):
        loop.tick(1 / 30)
    view: Any = view_named(name)
    made = view.__new__(view)  # its texts need no drawing
    for text in made.notes(loop.latest).values():
        if has_table(text):
            rows = [row for row in rows_of(tables_csv(text)) if row]
            assert len(rows) == text.count("<tr>")
            assert all(row[0] for row in rows[1:])
