"""Decks as people alter them are read where MoorDyn reads them rightly, and are never another mooring."""

import csv

import pytest

from sim.mooring import System, read_moordyn
from sim.validation import Refusals
from tests.sim.mooring.moordyn.altered import ALTERATIONS, BASES, RESULTS, decks

DECKS = decks()
ROWS = list(csv.DictReader(RESULTS.read_text(encoding="utf-8").splitlines()))
CASES = [(row["base"], row["alteration"], row["moordyn"]) for row in ROWS if row["alteration"]]


def read(text: str, folder) -> System:
    path = folder / "deck.txt"
    path.write_bytes(text.encode("utf-8"))
    return read_moordyn(path, [].append)


def test_at_least_60_decks_are_altered_and_all_were_tried():
    assert len(CASES) >= 60
    assert {(base, alteration) for base, alteration, _ in CASES} | {(base, "") for base in BASES} == set(DECKS)
    assert {alteration for _, alteration, _ in CASES} == set(ALTERATIONS)
    assert {row["moordyn"] for row in ROWS} == {"right", "wrong", "refused"}
    assert {row["moordyn"] for row in ROWS if not row["alteration"]} == {"right"}


@pytest.mark.parametrize(("base", "alteration", "moordyn"), CASES)
def test_an_altered_deck_is_read_where_moordyn_reads_it_rightly(base, alteration, moordyn, tmp_path):
    before = read(DECKS[base, ""], tmp_path)
    refused = Refusals()
    with refused:
        after = read(DECKS[base, alteration], tmp_path)
    if refused.reasons:
        assert moordyn != "right", refused.reasons
        assert "is not allowed; allowed: " in refused.reasons[0]
        return
    for name in ("lines", "points", "water", "bed_stiffness", "bed_damping"):
        assert getattr(after, name) == getattr(before, name)
