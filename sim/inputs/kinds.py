"""Kinds of files, told by their content: one sentence, before any reader tries a file.

A reader that is given a file of another kind refuses it with that sentence, and with what takes such a file.
"""

import json
import re
import tomllib
import zipfile
import zlib
from pathlib import Path
from typing import NamedTuple

from sim.tables import TIME_NAMES, is_value, split_rows
from sim.tables.headers import letters_of, read_header
from sim.tables.times import PARTS, is_time
from sim.validation import argument_error

HEAD = 100_000  # [bytes] that are looked at
MAX_WHOLE = 20_000_000  # [bytes] of a netCDF or TOML file that is looked at as a whole
MAX_ROWS = 60  # lines of a table

# Text of wave models and buoys -> the reader of `wavespectra`, and what it is. Patterns are in small letters.
WAVE_TEXTS = (
    (r"wavewatch", "read_ww3_station", "a spectrum of WAVEWATCH III"),
    (r"triaxys (?:buoy data|buoy) report", "read_triaxys", "a spectrum of a Triaxys buoy"),
    (r"[^\n]*\n\s*nfreqs?,", "read_octopus", "a spectrum of Octopus"),
    (r"[^\n]*\bvariancedensity_0\b", "read_spotter", "a spectrum of a Spotter buoy"),
    (r'\{.*"frequencydata"', "read_spotter", "a spectrum of a Spotter buoy"),
    (r"\s*\d+\s+\d+\s*-?\s*numfreq", "read_funwave", "a spectrum of FUNWAVE"),
)
MAGIC = (  # first bytes -> kind and sentence
    (b"\x89PNG", "picture", "a picture (PNG)"), (b"\xff\xd8\xff", "picture", "a picture (JPEG)"),
    (b"GIF8", "picture", "a picture (GIF)"), (b"%PDF", "document", "a document (PDF)"),
    (b"glTF", "mesh", "a mesh (GLB)"), (b"ply\n", "mesh", "a mesh (PLY)"), (b"ply\r", "mesh", "a mesh (PLY)"),
    (b"OFF", "mesh", "a mesh (OFF)"), (b"\xd0\xcf\x11\xe0", "workbook", "an old Excel workbook"),
)  # fmt: skip
IN_NETCDF = (  # names in a file of netCDF or HDF5 -> kind and sentence
    ((b"added_mass", b"radiation_damping"), "dataset", "a dataset of linear coefficients (Capytaine's netCDF)"),
    ((b"efth",), "spectrum", "spectra in netCDF"),
    ((b"spectral_wave_density",), "spectrum", "spectra in netCDF (NDBC)"),
    ((b"d2fd",), "spectrum", "spectra in netCDF (ERA5)"), ((b"SPSIG",), "spectrum", "spectra in netCDF (WWM)"),
)  # fmt: skip
DECK = re.compile(r"(?mi)^-{3,}\s*(?:LINE (?:TYPES|DICTIONARY|LIST|PROPERTIES)|POINTS?\b|CONNECTION|NODE PROP|LINES)")
PATTERNS = (  # in the first lines of a text -> kind and sentence
    (re.compile(r"\s*'?\s*SWAN\s+\d", re.IGNORECASE), "spectrum", "a spectrum of SWAN"),
    (re.compile(r"\$PNOR"), "spectrum", "a spectrum of an AWAC"),
    (re.compile(r"#?\s*YY(?:YY)?\s+MM\s+DD\b"), "spectrum", "a file of an NDBC buoy"),
    (re.compile(r"(?s)\s*(?:TITLE\s*=|VARIABLES\s*=|ZONE\b)", re.IGNORECASE), "picture",
     "Tecplot's data of a drawing, as WAMIT's _pan.dat: its .gdf has the mesh"),
    (re.compile(r"\s*solid\b[\s\S]*?\bfacet\b"), "mesh", "a mesh (STL)"),
    (re.compile(r"(?m)^v\s+[-+\d.eE]+\s+[-+\d.eE]+\s+[-+\d.eE]+[\s\S]*^f\s+\d"), "mesh", "a mesh (OBJ)"),
    (re.compile(r"\s*\$MeshFormat"), "mesh", "a mesh (Gmsh)"),
    (re.compile(r"# vtk DataFile"), "mesh", "a mesh (VTK)"),
    (re.compile(r"\s*<\?xml[\s\S]*<VTKFile"), "mesh", "a mesh (VTK)"),
    (re.compile(r"\s*<VTKFile"), "mesh", "a mesh (VTK)"),
    (re.compile(r"(?mi)^\*(?:HEADING|NODE)\b"), "mesh", "a mesh (Abaqus)"),
    (re.compile(r"[\s\S]{0,400}\bHull Mesh File\b", re.IGNORECASE), "mesh", "a mesh (HAMS)"),
)  # fmt: skip
PYTHON = re.compile(r"(?m)^(?:import \w|from [\w.]+ import |def \w+\(|class \w+[(:])")
GDF = re.compile(r"[^\n]*\n\s*[-+.\deE]+\s+[-+.\deE]+[^\n]*\n\s*[01]\s+[01]\b[^\n]*\n\s*\d+\b")
NEMOH = re.compile(r"\s*2\s+[01]\s*\n\s*1\s+\S+\s+\S+\s+\S+\s*\n")
DENSITIES = {
    "s", "e", "density", "energy", "psd", "spectrum", "spectraldensity", "energydensity", "variancedensity", "sf", "ef",
    "sw", "s\u03c9", "efth", "wavespectrum", "spectralenergy",
}  # fmt: skip
HEIGHTS = {
    "eta", "\u03b7", "height", "elevation", "surfaceelevation", "waveelevation", "heave", "z", "surface",
    "displacement", "level", "waterlevel", "wave1elev",
}  # fmt: skip
FREQUENCIES = {"frequency", "freq", "f", "omega", "w", "\u03c9", "angularfrequency", "wavefrequency"}
IN_COMMENTS = re.compile(r"(?im)^\s*[#%].*\b(?:frequenc|direction)\w*\b.*\d")

TAKEN_BY = {  # kind -> what takes such a file
    "deck": "`--mooring` and `read_moordyn` take it",
    "mesh": "`--hull`, `springtide hull` and `Hull.load` take it",
    "spectrum": "`--spectrum` and `read_spectrum` take it",
    "record": "`read_record` takes it",
    "dataset": "`with_dataset` takes it",
    "set-up": "`--preset` takes it",
    "sweep": "`springtide sweep` takes it",
    "answers": "`springtide lab` takes the folder that it lies in",
    "coefficients": "`--hull` finds it beside its mesh",
    "workbook": "save its sheet as CSV",
    "archive": "unpack it",
    "notebook": "save it as a Python file",
}


class Seen(NamedTuple):
    """The kind that a file seems to be of."""

    kind: str  # "" if it is not known
    sentence: str  # for "this is ..."


UNKNOWN = Seen("", "")


def kind_of_file(path: Path) -> Seen:
    """The kind of a file by its content; `UNKNOWN` for a file that cannot be read, or of no known kind."""
    try:
        with path.open("rb") as file:
            head = file.read(HEAD)
        size = path.stat().st_size
    except OSError:
        return UNKNOWN
    if head.startswith(b"\x1f\x8b"):
        try:
            head = zlib.decompressobj(31).decompress(head, HEAD)
        except zlib.error:
            return UNKNOWN
    for first, kind, sentence in MAGIC:
        if head.startswith(first):
            return Seen(kind, sentence)
    if head.startswith(b"PK\x03\x04"):
        return of_archive(path)
    if head.startswith((b"\x89HDF", b"CDF\x01", b"CDF\x02", b"CDF\x05")):
        return of_netcdf(path if size <= MAX_WHOLE else None, head)
    if len(head) >= 84 and size == 84 + 50 * int.from_bytes(head[80:84], "little"):
        return Seen("mesh", "a mesh (STL)")
    if head.startswith((b"\xff\xfe", b"\xfe\xff")):
        return of_text(head.decode("utf-16", "replace"), path, size)
    if b"\0" in head:
        return UNKNOWN
    return of_text(head.decode("utf-8-sig", "replace"), path, size)


def of_archive(path: Path) -> Seen:
    """The kind of a ZIP archive, by the names in it."""
    try:
        names = zipfile.ZipFile(path).namelist()
    except (OSError, zipfile.BadZipFile, ValueError, RuntimeError):
        return UNKNOWN
    if "about.npy" in names:
        return Seen("set-up", "a recording of Springtide (.npz)")
    if {"added_mass.npy", "damping.npy"} <= set(names):
        return Seen("coefficients", "a table of linear coefficients of Springtide (.hydrodynamics.npz)")
    if names and all(name.endswith(".npy") for name in names):
        return Seen("arrays", "arrays of NumPy (.npz)")
    if any(name.startswith("xl/") for name in names):
        return Seen("workbook", "an Excel workbook")
    if "content.xml" in names:
        return Seen("workbook", "an OpenDocument file")
    return Seen("archive", "an archive (ZIP)")


def of_netcdf(path: Path | None, head: bytes) -> Seen:
    """The kind of a file of netCDF or HDF5, by the names that stand in it. path: to look at the whole."""
    try:
        content = head if path is None else path.read_bytes()
    except OSError:
        return UNKNOWN
    return next((Seen(kind, sentence) for names, kind, sentence in IN_NETCDF if all(name in content for name in names)),
                UNKNOWN)  # fmt: skip


def of_text(text: str, path: Path, size: int) -> Seen:
    """The kind of a text, by its beginning."""
    plain = text.lstrip()
    if plain.startswith(("{", "[")) and not re.match(r"\[\w+\]", plain):
        return of_json(text, size)
    if re.match(r"(?i)<(?:!doctype html|html)", plain):
        is_replay = 'id="springtide-setup"' in text or "springtide" in text[:3000].lower()
        return Seen("set-up", "a replay of Springtide (.html)") if is_replay else Seen("page", "a page of a web site")
    if DECK.search(text):
        return Seen("deck", "a deck of MoorDyn")
    small = text.lower().lstrip("'\" #\n\r")
    for words, _, sentence in WAVE_TEXTS:
        if re.match(words, small, re.DOTALL):
            return Seen("spectrum", sentence)
    for pattern, kind, sentence in PATTERNS:
        if pattern.match(text) if not pattern.pattern.startswith("(?m") else pattern.search(text):
            return Seen(kind, sentence)
    if GDF.match(text) and path.suffix.lower() in (".gdf", ""):
        return Seen("mesh", "a mesh (WAMIT's GDF)")
    if NEMOH.match(text):
        return Seen("mesh", "a mesh (NEMOH)")
    if size <= MAX_WHOLE and re.search(r"(?m)^\s*[\w\"-]+\s*=\s*\S", text):
        toml = of_toml(path)
        if toml.kind:
            return toml
    if PYTHON.search(text):
        return Seen("program", "a Python program")
    if len(IN_COMMENTS.findall(text)) >= 2 and "," in text:
        return Seen("table of comments",
                    "a table of densities with its frequencies and directions in comments, as Obscape writes it: "
                    "write them as the first column and the first row")  # fmt: skip
    return of_table(text, path)


def of_json(text: str, size: int) -> Seen:
    """The kind of a JSON text, by its keys."""
    keys = set(re.findall(r'"(\w+)"\s*:', text[:HEAD]))
    if "nbformat" in keys or {"cells", "metadata"} <= keys:
        return Seen("notebook", "a notebook (Jupyter)")
    if "frequencyData" in keys:
        return Seen("spectrum", "a spectrum of a Spotter buoy")
    if {"asset", "meshes"} <= keys or {"asset", "accessors"} <= keys:
        return Seen("mesh", "a mesh (glTF)")
    if keys & {"scene", "preset"} and keys & {"parameters", "preset", "version"}:
        return Seen("set-up", "a set-up of Springtide (.json)")
    try:
        json.loads(text)
    except (ValueError, RecursionError):
        return UNKNOWN if size <= HEAD else Seen("json", "a JSON file")
    return Seen("json", "a JSON file")


def of_toml(path: Path) -> Seen:
    """The kind of a TOML file, by its tables."""
    try:
        content = tomllib.loads(path.read_text("utf-8-sig"))
    except (OSError, ValueError, RecursionError):
        return UNKNOWN
    if {"scene", "parameters"} <= content.keys():
        return Seen("sweep", "the specification of a sweep (TOML)")
    if "name" in content and any(isinstance(value, dict) for value in content.values()):
        return Seen("answers", "answers of the course lab (answers.toml)")
    return Seen("toml", "a TOML file") if content else UNKNOWN


def of_table(text: str, path: Path) -> Seen:
    """The kind of a table, by the names of its columns."""
    lines = text.splitlines()[:MAX_ROWS]
    try:
        rows, _ = split_rows("\n".join(lines), path)
    except ValueError:
        return UNKNOWN
    if len(rows) < 3 or len(rows[-2].words) < 2 or not all(map(is_cell, rows[-2].words[:1])):
        return UNKNOWN
    head = next((row.words for row in rows if len(row.words) == len(rows[-2].words)), [])
    if all(map(is_cell, head)):
        return Seen("record", "a record of stamps and numbers") if is_time(head[0]) else UNKNOWN
    try:
        known = (*FREQUENCIES, *DENSITIES, *HEIGHTS, *TIME_NAMES)
        names = {read_header(word[:200], known).name for word in head}
    except ValueError:
        return UNKNOWN
    if names & FREQUENCIES and names & DENSITIES:
        return Seen("spectrum", f"a table of a spectrum, with the columns {listed(head)}")
    parts = {name for part in ("hour", "minute") for name in PARTS[part][0]}
    if names & HEIGHTS and (names & set(TIME_NAMES) or {letters_of(word) for word in head} & parts):
        return Seen("record", f"a record in time, with the columns {listed(head)}")
    return UNKNOWN


def is_cell(word: str) -> bool:
    """True for a number, a missing one, or a time."""
    return is_value(word) or is_time(word)


def listed(words: list[str]) -> str:
    """The first names of columns."""
    return ", ".join(word[:30] for word in words[:4]) + (", ..." if len(words) > 4 else "")


def check_file(name: str, path: Path, kinds: tuple[str, ...], allowed: str) -> None:
    """Raises ValueError for a file that seems to be of another kind, with that kind and the reader that takes it.

    name: of the argument. kinds: that the reader takes. allowed: the forms that it reads, for the message.
    """
    seen = kind_of_file(path)
    if seen.kind and seen.kind not in kinds:
        taken = f"; {TAKEN_BY[seen.kind]}" if seen.kind in TAKEN_BY else ""
        raise argument_error(name, str(path), f"{allowed}; this is {seen.sentence}{taken}")
