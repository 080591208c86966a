"""Files of each kind given to each reader: a refusal names the kind and its reader; its own readers take it."""

import itertools
import json
import zipfile
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import trimesh

from app.commands.added_files import with_hull, with_mooring, with_spectrum
from app.commands.hulls import hull as hull_command
from app.commands.hulls import hydrodynamics
from app.commands.run import write_arrays
from app.scenes import scene_named
from app.scenes.setups import described, make_setup, read_setup_text, setup_block, write_file
from app.study.sweep.spec import read_spec
from sim.floating import Hull, with_dataset
from sim.floating.hulls.hull import AS_IT_IS
from sim.inputs.kinds import TAKEN_BY, kind_of_file
from sim.mooring import read_moordyn
from sim.ocean import read_record, read_spectrum
from tests.sim.mooring.moordyn.altered import BASES

ROOT = Path(__file__).parents[3]
OCEAN = ROOT / "tests" / "sim" / "ocean" / "field"


def box(path: Path) -> None:
    """A box of triangles."""
    trimesh.creation.box((6.0, 2.0, 1.0)).export(path)


def gdf(path: Path) -> None:
    """A mesh of WAMIT."""
    plain = Hull.box(6.0, 2.0, 1.0)
    corners = plain.vertices[plain.faces][:, [0, 1, 2, 2]].reshape(-1, 3)
    rows = "\n".join(" ".join(f"{x:.4f}" for x in corner) for corner in corners)
    path.write_text(f"a box\n1.0 9.81\n0 0\n{len(plain.faces)}\n{rows}\n", "utf-8")


def recording(path: Path) -> None:
    """A recording of a rope."""
    kind = scene_named("rope")
    about = {**described(kind, kind.params()), "units": {}, "diverged": "", "notes": []}
    write_arrays(path, {"t": np.zeros(2), "about": np.array(json.dumps(about))})


def rope_file(path: Path) -> None:
    """A set-up of a rope."""
    path.write_text(write_file(scene_named("rope"), make_setup(scene_named("rope")).params), "utf-8")


def replay(path: Path) -> None:
    """A page with a set-up."""
    block = setup_block(scene_named("rope"), make_setup(scene_named("rope")).params)
    path.write_text(f"<!DOCTYPE html>\n<html><title>Springtide</title>{block}</html>", "utf-8")


def record(path: Path) -> None:
    """A record of heights."""
    path.write_text("time (s),eta (m)\n" + "".join(f"{0.5 * i},{np.sin(0.4 * i):.5f}\n" for i in range(200)), "utf-8")


# kind -> ending, how a file is made, and words of the sentence
KINDS = {
    "deck": (".txt", lambda path: path.write_text(BASES["chain"], "utf-8"), "a deck of MoorDyn"),
    "mesh of triangles": (".stl", box, "a mesh (STL)"),
    "mesh of panels": (".gdf", gdf, "a mesh (WAMIT's GDF)"),
    "table of a spectrum": (".csv", lambda path: path.write_bytes((OCEAN / "spectrum_rads.csv").read_bytes()),
                            "a table of a spectrum, with the columns"),
    "spectrum of a buoy": (".txt", lambda path: path.write_bytes((OCEAN / "46999w2021.txt").read_bytes()),
                           "a file of an NDBC buoy"),
    "spectrum of SWAN": (".sp2", lambda path: path.write_bytes((OCEAN / "swan_sector.sp2").read_bytes()),
                         "a spectrum of SWAN"),
    "record": (".csv", record, "a record in time, with the columns time (s), eta (m)"),
    "dataset": (".nc", lambda path: path.write_bytes((ROOT / "assets" / "barge.nc").read_bytes()),
                "a dataset of linear coefficients (Capytaine's netCDF)"),
    "set-up": (".json", rope_file, "a set-up of Springtide (.json)"),
    "recording": (".npz", recording, "a recording of Springtide (.npz)"),
    "replay": (".html", replay, "a replay of Springtide (.html)"),
    "sweep": (".toml", lambda path: path.write_text(
        'scene = "rope"\nseconds = 1.0\n[parameters]\nstiffness = [100.0, 200.0]\n', "utf-8"),
        "the specification of a sweep (TOML)"),
    "answers": (".toml", lambda path: path.write_text('name = "Student"\n[spring_force]\nstretch = 0.1\n', "utf-8"),
                "answers of the course lab (answers.toml)"),
    "notebook": (".ipynb", lambda path: path.write_text(
        json.dumps({"cells": [], "metadata": {}, "nbformat": 4, "nbformat_minor": 5}), "utf-8"),
        "a notebook (Jupyter)"),
    "workbook": (".xlsx", lambda path: zipfile.ZipFile(path, "w").writestr("xl/workbook.xml", ""),
                 "an Excel workbook"),
    "drawing": (".dat", lambda path: path.write_text(
        'TITLE = "WAMIT"\nVARIABLES = "X" "Y" "Z"\nZONE N=4, E=1\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n1 2 3 4\n', "utf-8"),
        "Tecplot's data of a drawing, as WAMIT's _pan.dat: its .gdf has the mesh"),
    "spectrum of Obscape": (".csv", lambda path: path.write_text(
        "# Obscape\n# frequencies (Hz): 0.05,0.06,0.07\n# directions (deg): 0,90,180,270\n"
        "0.1,0.2,0.1,0\n0.3,0.5,0.2,0\n0.1,0.2,0.1,0\n", "utf-8"), "as Obscape writes it"),
    "program": (".py", lambda path: path.write_text("import numpy as np\n\n\ndef f(x):\n    return x\n", "utf-8"),
                "a Python program"),
}  # fmt: skip
SEA, RADIAL, MOORING = scene_named("square_sea"), scene_named("radial_sea"), scene_named("mooring")
READERS = {  # reader -> kinds that it takes, and its call
    "read_moordyn": (("deck",), lambda path: read_moordyn(path, [].append)),
    "--mooring": (("deck",), lambda path: with_mooring(MOORING.params(), path, make_setup(MOORING))),
    "Hull.load": (("mesh of triangles", "mesh of panels"), Hull.load),
    "--hull": (("mesh of triangles", "mesh of panels"), lambda path: with_hull(RADIAL.params(), path, AS_IT_IS)),
    "springtide hull": (("mesh of triangles", "mesh of panels"),
                        lambda path: hull_command.print_facts(path, AS_IT_IS, 500.0, None)),
    "springtide hydrodynamics": ((), lambda path: hydrodynamics.make(path, None)),
    "read_spectrum": (("table of a spectrum", "spectrum of a buoy", "spectrum of SWAN"), read_spectrum),
    "--spectrum": (("table of a spectrum", "spectrum of a buoy", "spectrum of SWAN"),
                   lambda path: with_spectrum(SEA.params(), path, "", "", False)),
    "read_record": (("record",), read_record),
    "with_dataset": (("dataset",), lambda path: with_dataset(Hull.box(60.0, 16.0, 6.0), path)),
    "--preset": (("set-up", "recording", "replay"), lambda path: read_setup_text("--preset", path)),
    "springtide sweep": (("sweep",), read_spec),
}  # fmt: skip


@pytest.fixture(scope="module")
def files(tmp_path_factory) -> SimpleNamespace:
    """A file of each kind."""
    folder = tmp_path_factory.mktemp("kinds")
    paths = {}
    for name, (ending, make, _) in KINDS.items():
        paths[name] = folder / f"{name.replace(' ', '_')}{ending}"
        make(paths[name])
    return SimpleNamespace(paths=paths)


@pytest.mark.parametrize("kind", KINDS)
def test_a_file_is_told_by_its_content(kind, files, tmp_path):
    seen = kind_of_file(files.paths[kind])
    assert KINDS[kind][2] in seen.sentence
    if kind != "mesh of panels":  # the name of a mesh of WAMIT is a part of its format
        other = tmp_path / "renamed.bin"
        other.write_bytes(files.paths[kind].read_bytes())
        assert kind_of_file(other) == seen


PAIRS = [
    (reader, kind)
    for reader, kind in itertools.product(READERS, KINDS)
    if kind not in READERS[reader][0] and not (reader == "springtide hydrodynamics" and kind.startswith("mesh"))
]


def test_12_readers_are_given_12_kinds_and_more():
    assert len(READERS) == 12
    assert len(KINDS) >= 12


@pytest.mark.parametrize(("reader", "kind"), PAIRS, ids=lambda word: word)
def test_a_file_of_another_kind_is_refused_with_what_it_is(reader, kind, files):
    path = files.paths[kind]
    with pytest.raises(ValueError, match="this is ") as error:
        READERS[reader][1](path)
    said = str(error.value)
    assert KINDS[kind][2] in said
    assert "\n" not in said
    assert said.count("is not allowed; allowed: ") == 1
    seen = kind_of_file(path)
    assert TAKEN_BY.get(seen.kind, "") in said


@pytest.mark.parametrize("reader", READERS)
def test_a_reader_takes_the_files_of_its_own_kind(reader, files, capsys):
    taken, call = READERS[reader]
    if reader == "with_dataset":
        pytest.importorskip("netCDF4")
    for kind in taken:
        call(files.paths[kind])


def test_a_file_of_no_known_kind_goes_to_the_reader(tmp_path):
    for name, content in (
        ("a.txt", b""),
        ("b.txt", b"hello\n"),
        ("c.csv", b"0.1,2\n0.2,3\n0.3,4\n"),
        ("d.bin", bytes(range(256))),
    ):
        (tmp_path / name).write_bytes(content)
        assert kind_of_file(tmp_path / name).kind == ""
    assert kind_of_file(tmp_path / "missing").kind == ""
    assert kind_of_file(tmp_path).kind == ""
