"""Broken files of each kind: one line that says what is wrong, and nothing is started."""

import random
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from app.__main__ import main
from sim.floating import Hull, with_dataset
from tests.sim.floating import test_mesh_files as meshes
from tests.sim.ocean import test_measured as seas

BROKEN = 40  # files of each kind
S = seas.density(seas.FREQUENCY)
TABLE = "f,S,dir,r1\n" + "".join(f"{f},{s},225,0.9\n" for f, s in zip(seas.FREQUENCY, S, strict=True))
MATRIX = "f,0,90,180,270\n" + "".join(f"{f},{s},{s},0,0\n" for f, s in zip(seas.FREQUENCY, S, strict=True))
SUMMARY = (
    "#YY  MM DD hh mm WVHT  SwH  SwP  WWH  WWP SwD WWD  STEEPNESS  APD MWD\n"
    "2024 02 01 05 40  2.2  2.0 11.0  0.9  5.0 SW N  AVERAGE  6.2 226\n"
)
SPECTRA = {  # name -> a file that is read
    "a.csv": TABLE,
    "b.csv": MATRIX,
    "44013.data_spec": seas.realtime(S, "spec", "0.140 "),
    "44013w2019.txt": seas.history(S),
    "44013.spec": SUMMARY,
}
VERTICES = "".join("v {} {} {}\n".format(*place) for place in meshes.VERTICES)
OBJ = VERTICES + "".join("f {} {} {}\n".format(*(face + 1)) for face in np.concatenate([meshes.DECK, meshes.SIDES]))
MESHES = {"a.obj": OBJ, "a.gdf": meshes.gdf(), "a.dat": meshes.nemoh(), "a.pnl": meshes.hams()}


def broken(text: str, seed: int) -> bytes:
    """A text with one of the faults that files have: cut off, other bytes, words that are no numbers, columns lost."""
    draw, lines = random.Random(seed), text.splitlines()
    rows = [i for i, line in enumerate(lines) if i and any(c.isdigit() for c in line)]
    at, kind = draw.choice(rows), seed % 10
    words = lines[at].replace(",", " ").split()
    number = next(word for word in words if any(c.isdigit() for c in word))
    if kind == 0:
        return b""
    if kind == 1:
        return text.encode()[: draw.randrange(1, 12)]
    if kind == 2:
        return draw.randbytes(2000)
    if kind == 3:
        return ("\0" + text).encode()
    if kind == 4:  # a word in place of each number of a row
        lines[at] = " ".join("x" + word for word in words)
    elif kind == 5:
        lines = [line.replace("1", "nan") for line in lines]
    elif kind == 6:
        lines[1:] = [line.replace("0", "-7e400") for line in lines[1:]]
    elif kind == 7:
        lines[at] = lines[at].replace(number, "inf", 1)
    elif kind == 8:
        lines = lines[:1]
    else:
        return b"<html><body>404 Not Found</body></html>\n" * 3
    return "\n".join(lines).encode("utf-16" if seed % 4 == 3 else "utf-8")


def files(known: dict[str, str]) -> Iterator[tuple[str, bytes]]:
    """BROKEN names and contents, of all formats in turn."""
    for seed in range(BROKEN):
        name = sorted(known)[seed % len(known)]
        yield f"{seed}_{name}" if not name.startswith("4401") else name, broken(known[name], seed // len(known) + seed)


@pytest.fixture
def refused(monkeypatch, capsys) -> Callable[..., str]:
    """Run a command that has to end with status 2, one line, and no server, run or table; returns the line."""
    for place in (
        "app.commands.serve.serve_lab",
        "app.commands.run.run_to_file",
        "app.commands.hulls.hydrodynamics.make_table",
    ):
        monkeypatch.setattr(place, lambda *_, **__: pytest.fail("started"))

    def run(*words: str) -> str:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            assert main([*words]) == 2, words
        shown = capsys.readouterr()
        assert shown.err.count("\n") == 1, shown.err
        assert shown.err.startswith("springtide: ")
        assert shown.out == ""
        return shown.err

    return run


def test_the_files_that_are_broken_here_are_read_whole(tmp_path):
    from sim.ocean import read_spectrum

    for name, text in SPECTRA.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
        assert read_spectrum(tmp_path / name).moments().significant_height > 0.0
    for name, text in MESHES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
        assert Hull.load(tmp_path / name, cap="" if name == "a.obj" else "deck").volume == pytest.approx(240.0)


def test_broken_spectra_end_with_one_line(tmp_path, refused):
    for name, content in files(SPECTRA):
        (tmp_path / name).write_bytes(content)
        said = refused("--scene", "square_sea", "--no-open", "--spectrum", str(tmp_path / name))
        assert name in said


def test_broken_meshes_end_with_one_line(tmp_path, refused):
    for name, content in files(MESHES):
        (tmp_path / name).write_bytes(content)
        cap = [] if name.endswith("obj") else ["--cap", "deck"]
        said = refused("--scene", "radial_sea", "--no-open", "--hull", str(tmp_path / name), *cap)
        assert name in said or "cap: 'deck'" in said
        refused("hydrodynamics", str(tmp_path / name), *cap)


def changed(dataset, seed: int):
    """A dataset with one fault of forty."""
    names = ["added_mass", "radiation_damping", "diffraction_force", "Froude_Krylov_force", "omega", "wave_direction",
             "influenced_dof", "radiating_dof", "rho", "g"]  # fmt: skip
    name = names[seed % len(names)]
    kind, values = seed // len(names), dataset[name]
    if kind == 0:
        return dataset.drop_vars(name)
    if kind == 1:  # an axis more, with two places on it
        return dataset.drop_vars(name).assign({name: values.expand_dims(elsewhere=2)})
    if kind == 2 and values.dtype.kind == "f":
        return dataset.drop_vars(name).assign({name: (values.dims, np.full(values.shape, np.nan))})
    if kind == 3 and values.dims:  # two places of its last axis
        return dataset.isel({values.dims[-1]: [0, 2]})
    return dataset.drop_vars(name).assign({name: (values.dims, np.full(values.shape, "word"))})


def test_broken_datasets_end_with_one_line(tmp_path):
    pytest.importorskip("netCDF4")
    xarray = pytest.importorskip("xarray")
    path = Path(__file__).parents[2] / "sim" / "floating" / "datasets" / "depths.nc"
    with xarray.open_dataset(path) as file:
        whole = file.load().sel(water_depth=20.0)
    hull = Hull.box(20.0, 10.0, 4.0)
    for seed in range(BROKEN):
        place = tmp_path / f"{seed}.nc"
        changed(whole.copy(deep=True), seed).to_netcdf(place)
        with pytest.raises(ValueError, match=r"^(path|rho|g|body): .* is not allowed; allowed: \S") as error:
            with_dataset(hull, place)
        assert "\n" not in str(error.value)
    for seed in range(10):
        place = tmp_path / f"{seed}.txt.nc"
        place.write_bytes(broken(TABLE, seed) if seed % 2 else path.read_bytes()[: 4000 * seed])
        with pytest.raises(ValueError, match=r"^path: .* is not allowed; allowed: \S") as error:
            with_dataset(hull, place)
        assert "\n" not in str(error.value)


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # a reader leaves its file open
def test_broken_files_of_wave_models_end_with_one_line(tmp_path, refused):
    pytest.importorskip("wavespectra")
    swan = "SWAN   1\nLOCATIONS\n 1\n 0. 0.\nAFREQ\n 3\n 0.1\n 0.2\n 0.3\nNDIR\n 4\n 0\n 90\n 180\n 270\n"
    for seed in range(BROKEN):
        path = tmp_path / ("a.spc" if seed % 2 else "a.nc")
        path.write_bytes(b"SWAN   1\n" + broken(swan, seed) if seed % 2 else broken(swan, seed))
        refused("--scene", "square_sea", "--no-open", "--spectrum", str(path))


@pytest.mark.parametrize("ending", ["msh", "vtu", "vtk"])
def test_broken_files_of_meshio_end_with_one_line(tmp_path, refused, ending):
    pytest.importorskip("meshio")
    head = "# vtk DataFile Version 3.0\nmesh\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 1 float\n0 0 0\n"
    heads = {
        "msh": "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n2\n1 0 0 0\n2 1 0 0\n$EndNodes\n",
        "vtu": "<VTKFile type='UnstructuredGrid'>\n<UnstructuredGrid>\n<Piece n='1'>\n</Piece>\n",
        "vtk": head,
    }
    for seed in range(14):
        path = tmp_path / f"a.{ending}"
        path.write_bytes(broken(heads[ending], seed))
        assert path.name in refused("--scene", "radial_sea", "--no-open", "--hull", str(path))
