"""Numbers that physics, or their neighbours, contradict: each is said once, and nothing is said of good data."""

import re
import warnings
from pathlib import Path

import numpy as np
import pytest

from sim.floating import Hull, with_dataset
from sim.inputs.bounds import BOUNDS, TABLE, WARNING, beyond
from sim.mooring import read_moordyn
from sim.ocean import read_record, read_spectrum
from tests.sim.mooring.moordyn.altered import BASES, decks

ROOT = Path(__file__).parents[3]
SPREAD = """MoorDyn v2 input file
three anchors
---------------------- LINE TYPES ----------------------
Name Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
chain 0.1 150.0 1.0e9 -1.0 0 2.0 1.0 0.5 0.5
rope 0.16 20.0 8.0e7 -1.0 0 1.2 1.0 0.1 0.0
---------------------- POINTS --------------------------
ID Attachment X Y Z Mass Volume CdA Ca
(#) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)
1 Fixed 837 0 -200 0 0 0 0
2 Fixed -418 725 -200 0 0 0 0
3 Fixed -418 -725 -200 0 0 0 0
4 Coupled 58 0 -14 0 0 0 0
5 Coupled -29 50 -14 0 0 0 0
6 Coupled -29 -50 -14 0 0 0 0
7 Free 0 0 -60 2000 0.8 1.0 1.0
8 Coupled 0 5 -14 0 0 0 0
---------------------- LINES ---------------------------
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (#) (#) (m) (-) (-)
1 chain 1 4 850 40 p
2 chain 2 5 850 40 p
3 chain 3 6 850 40 p
4 rope 8 7 47 10 p
---------------------- OPTIONS -------------------------
9.81 g
1025 rho
200 WtrDpth
---------------------- need this line ------------------
"""

# what is altered -> the words before and after, and words of the warning
DECKS = {
    "an anchor without a zero": ("-418 725 -200", "-418 725 -20", "anchor 2 lies 180 m above the bed, points 1, 3"),
    "an anchor at half the depth": ("837 0 -200", "837 0 -100", "anchor 1 lies 100 m above the bed"),
    "an anchor with the other sign": ("-725 -200", "-725 200", "point 3 lies 200 m above the water"),
    "the mass of the chain in t/m": ("0.1 150.0", "0.1 0.150", "is the mass in t/m"),
    "the mass of the rope in t/m": ("0.16 20.0", "0.16 0.020", "line type rope"),
    "a digit too many in a mass": ("0.1 150.0", "0.1 1500.0", "heavier than any line"),
    "a diameter in mm": ("chain 0.1 ", "chain 100 ", "is it in mm?"),
    "a diameter without its point": ("rope 0.16", "rope 16", "is it in mm?"),
    "a diameter with a zero too many": ("chain 0.1 ", "chain 0.01 ", "heavier than any line"),
    "EA of the chain in kN": ("1.0e9", "1.0e6", "is EA in kN?"),
    "EA of the chain in MN": ("1.0e9", "1.0e3", "is EA in kN?"),
    "EA with digits too many": ("1.0e9", "1.0e12", "is EA in N?"),
    "EA of the rope without its exponent": ("8.0e7", "8.0", "is EA in kN?"),
    "a drag without its point": ("0 2.0 1.0 0.5", "0 20 1.0 0.5", "Cd 20"),
    "an added mass without its point": ("1.2 1.0 0.1", "1.2 10 0.1", "Ca 10"),
    "a line without its last digit": ("2 5 850", "2 5 85", "line 2: 85 m between ends"),
    "a line with a digit too many": ("2 5 850", "2 5 8500", "line 2: 8500 m between ends"),
    "an anchor ten times as far": ("837 0", "8370 0", "line 1: 850 m between ends"),
    "an anchor a tenth as far": ("837 0", "83.7 0", "line 1: 850 m between ends"),
    "gravity without its point": ("9.81 g", "981 g", "OPTIONS: gravity 981"),
    "gravity of another unit": ("9.81 g", "32.2 g", "OPTIONS: gravity 32.2"),
    "a density in t/m3": ("1025 rho", "1.025 rho", "is it in t/m3?"),
    "a density with a digit too many": ("1025 rho", "10250 rho", "density of the water 1.02e+04"),
    "the mass of a point in t": ("2000 0.8", "2.0 0.8", "point 7: density 2.5"),
    "the volume of a point in a wrong unit": ("2000 0.8", "2000 0.0008", "point 7: density 2.5e+06"),
    "all depths positive": (" -", " ", "no point is under water"),
}  # fmt: skip


def warnings_of(text: str, folder: Path) -> list[str]:
    """Warnings on a deck."""
    path = folder / "deck.txt"
    path.write_text(text, encoding="utf-8")
    said: list[str] = []
    read_moordyn(path, said.append)
    return [one for one in said if one.startswith(WARNING)]


@pytest.mark.parametrize("name", DECKS)
def test_an_implausible_number_of_a_deck_is_said(name, tmp_path):
    before, after, words = DECKS[name]
    if name == "all depths positive":
        text = re.sub(r"(?m)^(\d) (Fixed|Coupled|Free) (\S+) (\S+) -?(\S+)", r"\1 \2 \3 \4 \5", SPREAD)
    else:
        assert SPREAD.count(before) == 1
        text = SPREAD.replace(before, after)
    said = warnings_of(text, tmp_path)
    assert any(words in one for one in said), said
    assert len(said) <= 3
    assert all("\n" not in one and len(one) < 400 for one in said)


# --- datasets ---


@pytest.fixture(scope="module")
def barge():
    pytest.importorskip("netCDF4")
    xarray = pytest.importorskip("xarray")
    with xarray.open_dataset(ROOT / "assets" / "barge.nc") as found:
        return found.load()


def at(dataset, name: str, motion: str, other: str | None = None):
    """A coefficient of a dataset by frequency; its values may be changed."""
    return dataset[name].loc[{"influenced_dof": motion, "radiating_dof": other or motion}]


def spoiled(dataset, what: str) -> None:
    """One implausible change of a dataset."""
    middle = dataset.sizes["omega"] // 2
    kind, _, motion = what.partition(": ")
    if kind == "negative at one frequency":
        values = at(dataset, "radiation_damping", motion)
        values[middle] = -0.3 * float(abs(values).max())
    elif kind == "shifted":
        values = at(dataset, "radiation_damping", motion)
        values -= 0.2 * float(abs(values).max())
    elif kind == "other sign":
        values = at(dataset, "radiation_damping", motion)
        values *= -1.0
    elif kind == "added mass x50":
        values = at(dataset, "added_mass", motion)
        values[middle] *= 50.0
    elif kind == "damping x50":
        values = at(dataset, "radiation_damping", motion)
        values[int(np.abs(values.values).argmax())] *= 50.0
    elif kind == "asymmetric":
        values = at(dataset, "added_mass", *motion.split("-"))
        values *= 1.5
    else:
        for name in ("diffraction_force", "Froude_Krylov_force"):
            dataset[name] *= 1e-3 if kind == "forces in kN" else 9.81


DATASETS = {
    "negative at one frequency: Heave": "Heave at omega", "negative at one frequency: Sway": "Sway at omega",
    "negative at one frequency: Pitch": "Pitch at omega", "shifted: Heave": "Heave at omega",
    "shifted: Surge": "Surge at omega", "other sign: Roll": "Roll at omega", "other sign: Heave": "Heave at omega",
    "added mass x50: Heave": "Heave at omega", "added mass x50: Roll": "Roll at omega",
    "added mass x50: Yaw": "Yaw at omega", "damping x50: Heave": "Heave at omega", "damping x50: Sway": "Sway at omega",
    "asymmetric: Surge-Pitch": "Surge and pitch at omega", "asymmetric: Pitch-Surge": "Surge and pitch at omega",
    "forces in kN": "which follows from the exciting force", "forces by g": "which follows from the exciting force",
}  # fmt: skip


def said_of(dataset, folder: Path) -> list[str]:
    """Warnings on a dataset."""
    dataset.to_netcdf(folder / "barge.nc")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        with_dataset(Hull.box(60.0, 16.0, 6.0), folder / "barge.nc")
    return [str(one.message) for one in caught if one.category is UserWarning]


@pytest.mark.parametrize("what", DATASETS)
def test_an_implausible_coefficient_is_said_with_its_motion_and_frequency(what, barge, tmp_path):
    dataset = barge.copy(deep=True)
    spoiled(dataset, what)
    said = said_of(dataset, tmp_path)
    assert any(DATASETS[what] in one for one in said), said
    assert all("\n" not in one and "rad/s" in one for one in said)


def test_there_are_40_implausible_decks_and_datasets():
    assert len(DECKS) + len(DATASETS) >= 40


def test_nothing_is_said_of_good_datasets(barge, tmp_path):
    assert said_of(barge, tmp_path) == []
    for i in range(0, 26, 3):  # parts of the frequencies
        assert said_of(barge.isel(omega=[j for j in range(26) if j != i]), tmp_path) == []


GOOD = [
    *((name, text) for name, text in decks().items() if name[1] in ("", "small letters", "signs", "without zeros")),
    *((path.name, path.read_text("utf-8")) for folder in ("files", "rods")
      for path in sorted((ROOT / "tests/sim/mooring/moordyn" / folder).glob("*.txt"))),
    *((f"three anchors, {name}", SPREAD.replace(before, after)) for name, before, after in (
        ("plain", "", ""), ("a slope", "725 -200", "725 -199"), ("a scale of 1 to 1", "9.81 g", "9.80665 g"),
        ("fresh water", "1025 rho", "1000 rho"), ("steel in air", "0.1 150.0", "0.1 61.7"),
        ("rope that floats", "0.16 20.0", "0.16 18.0"), ("studless by its bar", "0.1 150.0", "0.1 199.0"),
        ("taut", "2 5 850", "2 5 830"), ("slack", "2 5 850", "2 5 900"), ("a heavy clump", "2000 0.8", "9000 0.8"),
        ("a float", "2000 0.8", "200 0.8"))),
]  # fmt: skip


def test_at_least_40_good_decks_and_datasets_are_tried():
    assert len(GOOD) + 10 >= 40
    assert len(BASES) == 3


@pytest.mark.parametrize(("name", "text"), GOOD, ids=lambda one: one if isinstance(one, str) and len(one) < 60 else "")
def test_nothing_is_said_of_a_good_deck(name, text, tmp_path):
    for table in (ROOT / "tests/sim/mooring/moordyn/files").glob("*.dat"):
        (tmp_path / table.name).write_bytes(table.read_bytes())
    assert warnings_of(text, tmp_path) == []


# --- spectra and records ---

F = np.arange(0.04, 0.405, 0.01)
S = 4.0 * np.exp(-(((F - 0.1) / 0.02) ** 2)) + 0.1 * np.exp(-(((F - 0.25) / 0.06) ** 2))


def test_a_slip_of_the_decimal_point_in_a_density_is_said(tmp_path):
    path = tmp_path / "table.csv"
    density = S.copy()
    density[20] *= 100.0
    path.write_text("f,S\n" + "".join(f"{f:.3f},{s:.6f}\n" for f, s in zip(F, density, strict=True)), "utf-8")
    assert any("0.24 Hz: the density" in note for note in read_spectrum(path).notes)
    path.write_text("f,S\n" + "".join(f"{f:.3f},{s:.6f}\n" for f, s in zip(F, S, strict=True)), "utf-8")
    assert not any(note.startswith(WARNING) for note in read_spectrum(path).notes)


def test_a_spike_of_a_record_is_said(tmp_path):
    t = 0.5 * np.arange(2400)
    eta = np.sin(2.0 * np.pi * t / 8.0) + 0.3 * np.sin(2.0 * np.pi * t / 5.3)
    eta[700] = 40.0
    path = tmp_path / "record.csv"
    path.write_text("t,eta\n" + "".join(f"{a:g},{b:.6f}\n" for a, b in zip(t, eta, strict=True)), "utf-8")
    assert any("t = 350 s: the height 40 m" in note for note in read_record(path).notes)


# --- the table ---


def test_each_bound_has_a_reason_and_is_once_in_the_table():
    assert len(TABLE) == len(BOUNDS)
    for bound in BOUNDS:
        assert bound.low < bound.high
        assert bound.reason
        assert bound.below or bound.above or bound.kind == "deck"


@pytest.mark.parametrize("bound", BOUNDS, ids=lambda bound: f"{bound.kind}, {bound.name}")
def test_a_bound_is_said_outside_and_not_inside(bound):
    inside = [value for value in (bound.low, bound.high) if np.isfinite(value)]
    for value in inside:
        assert beyond(bound.kind, bound.name, value) == []
    for value in (bound.low - abs(bound.low) - 1.0, 2.0 * bound.high + 1.0):
        if np.isfinite(value):
            (said,) = beyond(bound.kind, bound.name, value, "here")
            assert said.startswith(f"{WARNING}here: ")
            assert bound.reason in said
    assert beyond(bound.kind, bound.name, float("nan")) == []
