"""The cost of an addition: each is one file or one folder, added to a copy of the sources.

The examples are those of docs/contributing.md, in its order. All are long: they compile kernels anew, in processes of
their own.
"""

import functools
import json
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from app.__main__ import main
from tests.examples import PAGE, add, commands, copy_of_sources, run, run_command, section

SHOWN = """
import time
from app.scenes import NAMES
from app.scenes.quantities import measured
from app.scenes.radial_sea.parameters import RadialSeaParams
from app.scenes.radial_sea.report import readout_of
from app.server.viewer import Viewer

assert "pendulum" in NAMES
viewer = Viewer("127.0.0.1", 0)
viewer.open("pendulum")
end = time.monotonic() + 90.0
while viewer.served.drawn == 0 and time.monotonic() < end:
    time.sleep(0.05)
assert viewer.served.drawn
assert viewer.loop.latest.frame.bob[2] < 0.0
assert set(viewer.panel.controls) == {"length", "gravity", "angle", "speed", "grid", "plot_swing"}
assert not viewer.loop.run.halted

viewer.open("radial_sea", RadialSeaParams(bodies=5))
while not viewer.view.bodies.batches and time.monotonic() < end:
    time.sleep(0.05)
assert "cone" in viewer.view.bodies.batches
assert "Cone" in readout_of(viewer.loop.latest)
assert measured(viewer.panel.kind, viewer.scene)["cone_draft_at_rest"].value > 0.0
assert not viewer.loop.run.halted
viewer.shut()
"""
MEASURED = """
from app.server.viewer import Viewer
from sim.ocean import Sea

sea = Sea(64, 1000.0, "bretschneider", sea_height=3.0, amplitudes="fixed")
assert 2.7 < sea.significant_height < 3.1, sea.significant_height
viewer = Viewer("127.0.0.1", 0)
for name in ("square_sea", "radial_sea"):
    viewer.open(name)
    viewer.served.stop_threads()
    panel, loop = viewer.panel, viewer.loop
    assert not panel.controls["sea_height"].visible
    panel.settings.set("spectrum", "bretschneider")
    assert panel.controls["sea_height"].visible
    panel.settings.set("sea_height", 4.0)
    loop.tick(1 / 60)
    scene = viewer.scene
    low = scene.sea.conditions.sea_height if name == "square_sea" else scene.readings().clean_height
    assert abs(low - 4.0) < 0.05, low
viewer.shut()
"""
BROWSED = """
SCENE = "pendulum"


def test_the_pendulum_swings_in_the_browser(shown):
    viewer, tab = shown
    start = viewer.loop.latest.frame.bob
    tab.wait(lambda: abs(viewer.loop.latest.frame.bob[0] - start[0]) > 0.1)
    tab.wait(lambda: len(tab.vertices("/bob")) > 10)
    assert not tab.errors
"""


def parameters_in(path) -> dict:
    """The parameters that `springtide run` wrote into a file."""
    with np.load(path) as file:
        return json.loads(str(file["about"]))["parameters"]


@pytest.fixture(scope="module")
def extended(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], tuple[Path, set[str]]]:
    """A function that adds an example to a copy of the sources, once, and returns the copy and the touched files.

    Each test adds its own: before a law and an integrator are there, the kernels are those of the other tests.
    """
    copy = copy_of_sources(tmp_path_factory.mktemp("extended"))
    return functools.cache(lambda heading: (copy, add(section(heading), copy)))


def run_tests(copy: Path, line: str, **variables: str) -> None:
    said = run_command(copy, line, **variables)
    assert " passed" in said
    assert " failed" not in said


@pytest.mark.long
def test_a_parameter_is_one_line_in_one_file(extended):
    copy, touched = extended("Add a parameter")
    assert len(touched) == 1
    test, headless = commands(section("Add a parameter"))
    run_tests(copy, test)
    run_command(copy, headless)
    assert parameters_in(copy / "buoyant.npz")["buoyancy"] == 0.9
    with np.load(copy / "buoyant.npz") as file:
        fall = file["x"][-1, -1, 2] - file["x"][0, -1, 2]
    assert main(["run", "rope", "--seconds", "0.3", "--out", str(copy / "heavy.npz")]) == 0
    with np.load(copy / "heavy.npz") as file:
        assert file["x"][-1, -1, 2] - file["x"][0, -1, 2] < fall < 0.0


@pytest.mark.long
def test_a_body_shape_is_one_file(extended):
    copy, touched = extended("Add a body shape")
    assert len(touched) == 1
    (headless,) = commands(section("Add a body shape"))
    run_command(copy, headless)
    with np.load(copy / "cone.npz") as file:
        draft = file["draft"][-1]
    # What is above the water is a smaller cone: V (1 - d/H)^3, of the height 0.7 m of size 1 at size 1.5.
    archimedes = 1.5 * 0.7 * (1.0 - (1.0 - 450.0 / 1025.0) ** (1 / 3))
    assert draft[4] == pytest.approx(archimedes, abs=1e-4)


@pytest.mark.long
def test_a_task_is_two_files_and_its_solutions(extended):
    copy, touched = extended("Add a task")
    assert len(touched) == 4
    new, check, test = commands(section("Add a task"))
    run_command(copy, new)
    assert "def phase_speed(k, gravity):" in (copy / "solved" / "square_sea.py").read_text("utf-8")
    assert "How fast a wave runs" in run_command(copy, check)
    run_tests(copy, test)


@pytest.mark.long
def test_a_scene_is_one_folder_and_passes_the_tests_of_all_scenes(extended):
    copy, touched = extended("Add a scene")
    assert {path.rpartition("/")[0] for path in touched} == {"app/scenes/pendulum"}
    test, headless = commands(section("Add a scene"))
    run_command(copy, headless)
    with np.load(copy / "pendulum.npz") as file:
        assert file["t"][-1] == pytest.approx(1.0)
        assert abs(file["theta"][-1]) < np.pi / 4
    run_tests(copy, test)


@pytest.mark.long
def test_an_added_scene_and_an_added_body_are_shown(extended):
    extended("Add a body shape")
    run(extended("Add a scene")[0], "-c", SHOWN)


@pytest.mark.stress  # five processes; the other examples are tried in fewer
def test_a_spectrum_with_new_parameters_is_one_file(extended):
    copy, touched = extended("Add a spectrum")
    assert len(touched) == 1
    test, *headless = commands(section("Add a spectrum"))
    run_tests(copy, test)
    for line in headless:
        run_command(copy, line)
    for name in ("square", "radial"):
        assert parameters_in(copy / f"{name}.npz")["sea_height"] == 3.0
    run(copy, "-c", MEASURED)


@pytest.mark.long
@pytest.mark.parametrize(
    ("heading", "written", "parameter", "value"),
    [("Add an integrator", "rk2.npz", "integrator", "rk2"), ("Add a law of a link", "rubber.npz", "law", "rubber")],
)
def test_an_integrator_and_a_law_of_a_link_are_one_file_each(extended, heading, written, parameter, value):
    copy, touched = extended(heading)
    assert len(touched) == 1
    test, headless = commands(section(heading))
    run_tests(copy, test)
    run_command(copy, headless)
    assert parameters_in(copy / written)[parameter] == value


@pytest.mark.long
def test_a_force_that_stores_energy_and_one_that_damps_are_one_file_each(extended):
    """Nets run in plain Python: all of their kernels hold the forces, and would be compiled again."""
    copy, touched = extended("Add a force")
    assert len(touched) == 2
    nets, lines = commands(section("Add a force"))
    run_tests(copy, nets, NUMBA_DISABLE_JIT="1")
    run_tests(copy, lines)


@pytest.mark.long
@pytest.mark.skipif(shutil.which("pyright") is None, reason="pyright is not installed")
def test_the_examples_pass_the_type_checker(extended):
    headings = re.findall(r"^## (Add .+)$", PAGE.read_text("utf-8"), re.MULTILINE)
    (copy, *_), touched = zip(*map(extended, headings), strict=True)
    sources = sorted(path for path in set().union(*touched) if re.match(r"(?!tests/).*\.py$", path))
    done = subprocess.run(
        ["pyright", "--pythonpath", sys.executable, *sources],
        cwd=copy,
        capture_output=True,
        encoding="locale",
        timeout=240,
    )
    assert done.returncode == 0, done.stdout


@pytest.mark.stress  # a browser of its own: without one, the test of its folder opens it
@pytest.mark.browser
@pytest.mark.skipif(not any(map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), reason="no Chromium")
def test_an_added_scene_opens_in_the_browser(tmp_path):
    pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    copy = copy_of_sources(tmp_path)
    add(section("Add a scene"), copy)
    (copy / "tests" / "browser" / "test_pendulum.py").write_text(BROWSED, "utf-8")
    assert "1 passed" in run(copy, "-m", "pytest", "tests/browser/test_pendulum.py")
