"""Tables of spectra: a row a frequency, with columns by name, or densities under a row of directions."""

import math
import re
from pathlib import Path
from typing import Any

import numpy as np

from sim.ocean.records.measured import spread_by_mean
from sim.ocean.spectra.record import Spectrum
from sim.ocean.spectrum_files.buoys import shares
from sim.ocean.spectrum_files.contents import DIRECTIONS, FORMS, line_error, made, towards
from sim.validation import argument_error

COLUMNS = {  # of a table with one row a frequency, by the letters and digits of its header
    "frequency": ("frequency", "freq", "f", "frequencyhz", "freqhz", "fhz"),
    "omega": ("omega", "w", "omegarads", "wrads"),
    "density": (
        "density",
        "s",
        "energy",
        "spectraldensity",
        "psd",
        "e",
        "variancedensity",
        "ef",
        "sm2hz",
        "densitym2hz",
    ),
    "alpha1": ("direction", "dir", "alpha1", "meandirection", "mwd", "theta", "a1", "mdir"),
    "r1": ("r1",),
    "spread": ("spread", "spreading", "spr", "directionalspread", "sigma"),
}


def from_table(text: str, path: Path) -> Spectrum[Any]:
    """The spectrum of a table with one row a frequency.

    Columns by name, or frequency and density without names; or a first row of directions, and densities over both.
    """
    rows = table_rows(text)
    if len(rows) < 3:
        raise argument_error("path", str(path), FORMS)
    number, head = rows[0]
    numeric = [is_number(word) for word in head]
    if len(head) > 4 and all(numeric[1:]) and (not numeric[0] or len(head) > len(COLUMNS)):
        return from_matrix(rows, path)
    if all(numeric):
        if len(head) != 2:
            raise line_error(path, number, "two columns, frequency [Hz] and density [m2/Hz], or names of columns")
        names, body = ["frequency", "density"], rows
    else:
        names, body = [column_of(word) for word in head], rows[1:]
    if not {"density"} < set(names) or not {"frequency", "omega"} & set(names):
        raise line_error(
            path, number, "the columns frequency [Hz] and density [m2/Hz]; and direction and spread, or r1"
        )
    values = np.array([numbers_of(words, path, line, len(names), names) for line, words in body])
    columns = {name: values[:, i] for i, name in enumerate(names) if name}
    f = columns["frequency"] if "frequency" in columns else columns["omega"] / (2.0 * math.pi)
    S = columns["density"] * (1.0 if "frequency" in columns else 2.0 * math.pi)
    order = np.argsort(f)
    columns = {name: column[order] for name, column in columns.items()}
    f, S = f[order], S[order]
    if "alpha1" not in columns or not {"r1", "spread"} & columns.keys():
        return made(path, None, f, S)
    # the spread of a buoy is sqrt(2 - 2 r1), Kuik, van Vledder, Holthuijsen 1988, J. Phys. Oceanogr. 18:1020
    r1 = columns["r1"] if "r1" in columns else 1.0 - 0.5 * np.radians(columns["spread"]) ** 2
    return made(
        path, None, f, S[:, None] * spread_by_mean(DIRECTIONS, towards(columns["alpha1"]), shares(r1)), DIRECTIONS
    )


def from_matrix(rows: list[tuple[int, list[str]]], path: Path) -> Spectrum[Any]:
    """The spectrum of rows of densities [m2/Hz/degree] behind a frequency, under a row of directions [degrees]."""
    number, head = rows[0]
    degrees = numbers_of(head[1:], path, number, len(head) - 1)
    values = np.array([numbers_of(words, path, line, len(head)) for line, words in rows[1:]])
    values = values[np.argsort(values[:, 0])]
    return made(path, None, values[:, 0], values[:, 1:] * (180.0 / math.pi), towards(degrees))


def table_rows(text: str) -> list[tuple[int, list[str]]]:
    """(number, words) of the lines of a table, without comments. Semicolons and tabs allow decimal commas."""
    rows = []
    for number, line in enumerate(text.splitlines(), start=1):
        if not line.strip() or line.lstrip().startswith(("#", "%", "//")):
            continue
        mark = next((mark for mark in (";", "\t", ",") if mark in line), None)
        words = [word.strip().strip('"') for word in line.split(mark)]
        rows.append((number, words if mark == "," else [w.replace(",", ".") if is_number(w.replace(",", ".")) else w
                                                        for w in words]))  # fmt: skip
    return rows


def is_number(word: str) -> bool:
    """True for the text of a number."""
    try:
        float(word)
    except ValueError:
        return False
    return True


def column_of(word: str) -> str:
    """The name of a column by its header, "" for another one."""
    letters = re.sub(r"[^a-z0-9]", "", re.sub(r"[\[(].*?[\])]", "", word.lower()))
    return next((name for name, known in COLUMNS.items() if letters in known), "")


def numbers_of(words: list[str], path: Path, number: int, count: int, names: list[str] | None = None) -> np.ndarray:
    """The numbers (count,) of a row of a table; nan for the words of columns without a name, where these are known.

    Raises ValueError that names the line.
    """
    if len(words) != count:
        raise line_error(path, number, f"{count} columns; here are {len(words)}")
    if not all(is_number(word) for i, word in enumerate(words) if names is None or names[i]):
        raise line_error(path, number, "numbers")
    return np.array([float(word) if is_number(word) else math.nan for word in words])
