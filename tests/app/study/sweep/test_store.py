"""The store of finished cases: what is in the file is checked before it is used."""

import json
import math
import sqlite3

import pytest

from app.__main__ import main
from app.study.sweep.case import FINISHED, Outcome
from app.study.sweep.results import identity
from app.study.sweep.spec import read_spec
from app.study.sweep.store import Store

SPEC = 'scene = "rope"\nseconds = 0.1\n[parameters]\nmass = [1, 2]\n'
GOOD = Outcome(FINISHED, "", math.nan, 0.5, {"a": [1.0]}, {"a": ("m", "A length")})


def file_of(tmp_path, about: str | None, *outcomes: str, columns: str = "number INTEGER PRIMARY KEY, outcome TEXT"):
    """A store beside the spec, with this text in `about` (None: what the sweep has) and these outcomes."""
    (tmp_path / "s.toml").write_text(SPEC, "utf-8")
    text = json.dumps(identity(read_spec(tmp_path / "s.toml"))) if about is None else about
    with sqlite3.connect(tmp_path / "out.nc.cases") as connection:
        connection.execute("CREATE TABLE about (content TEXT)")
        connection.execute("INSERT INTO about VALUES (?)", (text,))
        connection.execute(f"CREATE TABLE cases ({columns})")
        connection.executemany("INSERT INTO cases VALUES (?, ?)", enumerate(outcomes))
    connection.close()
    return tmp_path / "out.nc.cases"


def error_of(tmp_path, capsys) -> str:
    """The one line with which the sweep ends; the store is as it was."""
    store = tmp_path / "out.nc.cases"
    before = store.read_bytes()
    assert main(["sweep", str(tmp_path / "s.toml"), "--out", str(tmp_path / "out.nc")]) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1
    assert store.read_bytes() == before
    return lines[0]


@pytest.mark.parametrize("about", ["null", "[1, 2]", "3", '"x"', "{}", '{"spec": null}', '{"spec": 3}', "{", ""])
def test_a_store_with_another_identity_is_one_line(about, tmp_path, capsys):
    file_of(tmp_path, about)
    assert "--fresh" in error_of(tmp_path, capsys)


@pytest.mark.parametrize("columns", ["number INTEGER, result TEXT", "a TEXT, b TEXT"])
def test_a_store_with_other_columns_is_one_line(columns, tmp_path, capsys):
    file_of(tmp_path, None, columns=columns)
    assert "--fresh" in error_of(tmp_path, capsys)


@pytest.mark.parametrize(
    "outcome",
    [
        "null", "[]", "3", "{}", "{", "",
        json.dumps({**GOOD._asdict(), "more": 1}),
        json.dumps({**GOOD._asdict(), "end": "perhaps"}),
        json.dumps({**GOOD._asdict(), "measures": None}),
        json.dumps({**GOOD._asdict(), "measures": {"a": ["x"]}}),
        json.dumps({**GOOD._asdict(), "labels": {}}),
        json.dumps({**GOOD._asdict(), "labels": {"a": 3}}),
        json.dumps({**GOOD._asdict(), "run_time": "long"}),
    ],
)  # fmt: skip
def test_a_store_with_an_odd_outcome_is_one_line(outcome, tmp_path, capsys):
    file_of(tmp_path, None, outcome)
    assert "--fresh" in error_of(tmp_path, capsys)


def test_what_is_stored_is_read_again(tmp_path):
    for _ in range(2):
        store = Store(tmp_path / "a.cases", {"spec": {"seconds": 1.0}})
        store.add(4, GOOD)
        store.close()
    store = Store(tmp_path / "a.cases", {"spec": {"seconds": 1.0}})
    assert list(store.outcomes) == [4]
    assert store.outcomes[4]._replace(diverged_at=0.0) == GOOD._replace(
        diverged_at=0.0, labels={"a": ["m", "A length"]}
    )
    store.remove()
    assert list(tmp_path.iterdir()) == []
