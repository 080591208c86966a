"""Decks as people alter them: commas, comments, words behind a row, case, tabs, line ends, and ways to write numbers.

`python -m tests.sim.mooring.moordyn.altered` reads each by MoorDyn, and writes what it did to altered.csv: "right" if
the tension at the start is that of the deck before, "wrong" if it is another, "refused" if MoorDyn ends or hangs.
"""

import csv
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

HERE = Path(__file__).parent
RESULTS = HERE / "altered.csv"
HEAD = """MoorDyn v2 input file
made to be altered
---------------------- LINE TYPES ----------------------
Name Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
{}
---------------------- POINTS --------------------------
ID Attachment X Y Z Mass Volume CdA Ca
(#) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)
{}
---------------------- LINES ---------------------------
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (#) (#) (m) (-) (-)
{}
---------------------- OPTIONS -------------------------
0.0005 dtM
0.5 TmaxIC
9.81 g
{} WtrDpth
3.0e6 kBot
3.0e5 cBot
---------------------- need this line ------------------
"""
BASES = {
    "chain": HEAD.format(
        "c 0.1 150.5 1.0e8 -1.0 0 2.0 1.0 0.5 0.5", "1 Fixed 500.25 0.5 -150.0 0 0 0 0\n2 Coupled 0.5 0.0 -9.5 0 0 0 0",
        "1 c 1 2 535.5 20 p", "150.0",
    ),
    "taut": HEAD.format(
        "poly 0.18 22.5 9.0e7 4.0e5 0 1.2 1.0 0.05 0.0", "1 Fix -300.5 50.25 -200 0 0 0 0\n2 Vessel 0 0 -20.5 0 0 0 0",
        "1 poly 1 2 345.5 15 p", "200",
    ),
    "clump": HEAD.format(
        "chain 0.1 150.5 1.0e8 -1.0 0 1.2 1.0 0.5 0.5\nwire 0.05 12.5 2.0e8 -1.0 0 1.2 1.0 0.1 0.0",
        "1 Fixed 400.5 0 -100 0 0 0 0\n2 Free 150.25 0 -90.5 900 0.15 1.5 0.5\n3 Coupled 0.5 0 -9.5 0 0 0 0",
        "1 chain 1 2 260.5 12 p\n2 wire 2 3 175.5 10 p", "100.0",
    ),
}  # fmt: skip
SAME = 1e-6  # of a tension


def rows_of(text: str, change: Callable[[str, str], str]) -> str:
    """The text with changed rows; change: takes the name of the section and a row."""
    section, skip, found = "", 0, []
    for line in text.split("\n"):
        head = re.match(r"-{3,}\s*([A-Z][A-Z ]*[A-Z])", line)
        if head or line.startswith("---"):
            section = head[1] if head else ""
            skip = 0 if section == "OPTIONS" else 2
        elif skip:
            skip -= 1
        elif section and line.strip():
            line = change(section, line)
        found.append(line)
    return "\n".join(found)


def of(section: str, change: Callable[[str], str]) -> Callable[[str], str]:
    """An alteration of the rows of one section, before their comments; section "": of all."""
    return lambda text: rows_of(text, lambda name, row: change(row) if section in ("", name) else row)


def commas(row: str) -> str:
    """Commas behind the coordinates of a point."""
    words = row.split()
    return " ".join([*words[:2], *(f"{word}," for word in words[2:5]), *words[5:]])


ALTERATIONS: dict[str, Callable[[str], str]] = {
    "commas behind coordinates": of("POINTS", commas),
    "commas between all columns": of("POINTS", lambda row: ", ".join(row.split())),
    "a word behind the outputs": of("LINES", lambda row: f"{row}   (main line)"),
    "outputs with a space": of("LINES", lambda row: f"{row}, t"),
    "words behind a point": of("POINTS", lambda row: f"{row.split('!')[0]}   west anchor of three"),
    "words behind a type": of("LINE TYPES", lambda row: f"{row.split('#')[0]}   studless grade four"),
    "words behind an option": of("OPTIONS", lambda row: f"{row}   - as measured, see report"),
    "comments with #": of("", lambda row: f"{row} # checked"),
    "comments with !": of("", lambda row: f"{row} ! checked"),
    "tabs": of("", lambda row: row.replace(" ", "\t")),
    "line ends of Windows": lambda text: text.replace("\n", "\r\n"),
    "small letters": of("POINTS", str.lower),
    "capitals": of("POINTS", lambda row: row.split("!")[0].upper()),
    "options in capitals": of("OPTIONS", str.upper),
    "spaces at the ends": of("", lambda row: f"   {row}   "),
    "exponents of Fortran": of("LINE TYPES", lambda row: row.replace("e", "D")),
    "capital exponents": of("LINE TYPES", lambda row: re.sub(r"(?<=\d)e(?=\d)", "E+0", row)),
    "signs": of("POINTS", lambda row: re.sub(r" (\d+\.)", r" +\1", row)),
    "without zeros": of("", lambda row: re.sub(r"(?<![\d.])0\.(?=[1-9])", ".", row)),
    "decimal commas": of("POINTS", lambda row: re.sub(r"(?<=\d)\.(?=\d)", ",", row)),
    "quotes around options": of("OPTIONS", lambda row: re.sub(r"^(\S+)", r'"\1"', row)),
    "letters of other languages": lambda text: text.replace("MoorDyn", "Ankerl\u00e4nge \u2116 MoorDyn", 1),
    "a mark at the beginning": lambda text: "\ufeff" + text,
    "short dashes": lambda text: re.sub(r"-{4,}", "---", text),
}  # fmt: skip


def decks() -> dict[tuple[str, str], str]:
    """Texts of the altered decks by base and alteration, and of the decks before under ""."""
    found = {}
    for base, text in BASES.items():
        found[base, ""] = text
        changed = {name: alter(text) for name, alter in ALTERATIONS.items()}
        found |= {(base, name): after for name, after in changed.items() if after != text}
    return found


RUN = """
import sys
import moordyn
system = moordyn.Create(sys.argv[1])
places = [moordyn.GetPointPos(moordyn.GetPoint(system, i + 1)) for i in range(moordyn.GetNumberPoints(system))]
kinds = [moordyn.GetPointType(moordyn.GetPoint(system, i + 1)) for i in range(moordyn.GetNumberPoints(system))]
x = [c for place, kind in zip(places, kinds) if kind == -1 for c in place]
moordyn.Init(system, x, [0.0] * len(x))
for i in range(moordyn.GetNumberLines(system)):
    line = moordyn.GetLine(system, i + 1)
    print("ten", moordyn.GetLineFairTen(line), moordyn.GetLineNumberNodes(line))
print("pos", *(c for place in places for c in place))
"""


def by_moordyn(text: str, folder: Path) -> list[float] | None:
    """Tensions and places that MoorDyn has of a deck; None if it ends."""
    path = folder / "deck.txt"
    path.write_bytes(text.encode("utf-8"))
    try:
        ran = subprocess.run(
            [sys.executable, "-c", RUN, str(path)],
            capture_output=True,
            encoding="utf-8",
            cwd=folder,
            timeout=30,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return None
    lines = [line.split() for line in ran.stdout.splitlines() if line.startswith(("ten ", "pos "))]
    return [float(word) for words in lines for word in words[1:]] if ran.returncode == 0 and lines else None


def main() -> None:
    """Write altered.csv."""
    rows, before = [], {}
    with tempfile.TemporaryDirectory() as name:
        for (base, alteration), text in decks().items():
            found = by_moordyn(text, Path(name))
            before.setdefault(base, found)
            expected = before[base] or []
            is_same = found is not None and len(found) == len(expected) and all(
                abs(a - b) <= SAME * abs(b) for a, b in zip(found, expected, strict=True)
            )  # fmt: skip
            rows.append([base, alteration, "refused" if found is None else "right" if is_same else "wrong"])
            print(*rows[-1], found)
    with RESULTS.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([["base", "alteration", "moordyn"], *rows])


if __name__ == "__main__":
    main()
