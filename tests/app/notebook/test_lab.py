"""The handle of a lab in a notebook, without a notebook."""

import dataclasses
import json
import random
import re
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import app
from app.notebook.dataset import to_dataset
from app.notebook.lab import Lab, read_setup
from app.notebook.output import Output
from app.scenes import NAMES, scene_named
from app.scenes.setups import write_query
from app.scenes.stepping import steps_to
from sim.parameters import check_record, parameters_of
from sim.validation import DivergenceError
from tests.waiting import wait_for

pytest.importorskip("xarray", reason="the extra jupyter is not installed")
ROPE = scene_named("rope")


@pytest.fixture(scope="module")
def opened() -> Iterator[Lab]:
    with app.show("rope", stiffness=2000, paused=True) as lab:
        yield lab


@pytest.fixture
def rope(opened: Lab) -> Lab:
    """A rope at its start, as the lab has it but stiffer, standing still."""
    opened.pause()
    opened.set(**{name: p.default for name, p in parameters_of(ROPE.params).items()})
    opened.stiffness = 2000
    opened.reset()
    return opened


def test_importing_the_package_imports_nothing_that_takes_time() -> None:
    code = "import sys; import app; print(sorted({'numpy', 'viser', 'IPython', 'xarray', 'numba'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, encoding="locale", check=True)
    assert done.stdout == "[]\n"


@pytest.mark.parametrize(("height", "size"), [(500, (640, 320)), (1000, (640, 640)), (333, (640, 213))])
def test_the_picture_that_stays_has_the_shape_of_the_page(height: int, size: tuple[int, int]) -> None:
    assert Output(8080, "", height).still_size == size


@pytest.mark.parametrize("scene", NAMES)
def test_no_parameter_has_a_name_that_the_handle_has_for_itself(scene: str) -> None:
    own = {name for name in dir(Lab) if not name.startswith("_")} | {"scene", "preset", "paused", "height", "port"}
    assert not own & set(parameters_of(scene_named(scene).params))


def test_parameters_are_read_and_set_to_the_last_bit(rope: Lab) -> None:
    assert (rope.scene, rope.stiffness, rope.points) == ("rope", 2000.0, 10)
    rope.stiffness = np.float64(0.1) + 1000
    rope.points = np.int64(12)
    rope.set(damping=1 / 3, integrator="rk4", floor=True)
    assert (rope.stiffness, rope.points, rope.damping) == (1000.1, 12, 1 / 3)
    params = ROPE.params(stiffness=1000.1, points=12, damping=1 / 3, integrator="rk4", floor=True)
    assert read_setup(rope.link, "", {})[1] == params


@pytest.mark.parametrize("scene", NAMES)
def test_a_record_goes_through_a_link_or_arguments_to_a_notebook_to_the_last_bit(scene: str) -> None:
    rng = random.Random(scene)
    kind = scene_named(scene)
    for _ in range(20):
        values = {}
        for name, p in parameters_of(kind.params).items():
            if rng.random() < 0.5:
                continue
            if p.choices or p.kind is bool:
                values[name] = rng.choice(p.choices or (True, False))
            else:
                values[name] = p.kind(rng.uniform(p.low, min(p.high, 1e6)))
        params = kind.params(**values)
        assert read_setup(scene, "", values or {"speed": 1.0})[1] == params
        assert read_setup(write_query(kind, params), "", {})[1] == params


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("stiffness", -1, "stiffness: -1 is not allowed; allowed: 1 to 1e9 N/m"),
        ("stiffness", float("nan"), "stiffness: nan is not allowed"),
        ("stiffness", "2000", "stiffness: '2000' is not allowed"),
        ("stiffness", None, "stiffness: None is not allowed"),
        ("points", 3.5, "points: 3.5 is not allowed"),
        ("integrator", "rk5", "integrator: 'rk5' is not allowed"),
        ("stifness", 1, "stifness: no such parameter; did you mean stiffness"),
        ("<script>alert(1)</script>", 1, "no such parameter"),
    ],
)
def test_a_wrong_parameter_is_refused_in_one_line_and_nothing_changes(
    rope: Lab, name: str, value: object, words: str
) -> None:
    before = rope.link
    with pytest.raises(ValueError, match=r".") as error:
        rope.set(**{"damping": 1.0, name: value})  # type: ignore[arg-type]
    assert words in str(error.value)
    assert "\n" not in str(error.value)
    assert rope.link == before


def test_what_is_no_parameter_cannot_be_read_or_set(rope: Lab) -> None:
    with pytest.raises(AttributeError, match="colour"):
        _ = rope.color
    with pytest.raises(AttributeError, match="time: not a parameter"):
        rope.time = 3.0  # type: ignore[misc]
    assert not hasattr(rope, "_ipython_display_")
    assert "stiffness" in dir(rope)


def test_a_wait_ends_at_the_whole_step_and_the_run_is_that_of_a_headless_one(rope: Lab) -> None:
    assert rope.wait(0.25) == pytest.approx(0.25)
    assert rope.wait(0.26) == rope.time == pytest.approx(31 / 60)  # the first whole step at or after 0.51 s
    headless = ROPE.make(ROPE.params(stiffness=2000))
    headless.advance(steps_to(headless, 0.51))
    data = rope.data()
    np.testing.assert_array_equal(data.x, headless.arrays()["x"][0])
    np.testing.assert_array_equal(data.v, headless.arrays()["v"][0])
    assert rope.wait(0.0) == rope.time
    assert not rope.running


@pytest.mark.parametrize("seconds", [-1, float("nan"), float("inf"), "1", None, True])
def test_no_time_to_wait_is_refused(rope: Lab, seconds: object) -> None:
    with pytest.raises(ValueError, match="seconds"):
        rope.wait(seconds)  # type: ignore[arg-type]


def test_a_run_that_diverges_ends_the_wait_with_its_reason(rope: Lab) -> None:
    rope.set(integrator="explicit_euler", stiffness=1e5, damping=0)
    with pytest.raises(DivergenceError, match="explicit Euler"):
        rope.wait(5.0)
    with pytest.raises(DivergenceError, match="explicit Euler"):
        rope.wait(5.0)
    rope.set(integrator="leapfrog", stiffness=500.0)
    rope.reset()
    assert rope.wait(0.1) == pytest.approx(0.1)


@pytest.mark.long
def test_a_reset_ends_a_wait_and_an_interrupt_leaves_the_lab_as_it_was(rope: Lab) -> None:
    def interrupt() -> None:
        wait_for(lambda: rope.running)
        signal.raise_signal(signal.SIGINT)

    rope.set(points=50, time_step=0.0001)  # long enough to be waited for, by a method that is compiled
    wait_for(lambda: not rope.running)
    with ThreadPoolExecutor() as pool:
        interrupting = pool.submit(interrupt)
        with pytest.raises(KeyboardInterrupt):
            rope.wait(1e5)
        interrupting.result(60.0)
        wait_for(lambda: not rope.running)
        waiting = pool.submit(rope.wait, 1e5)
        wait_for(lambda: rope.running)
        rope.reset()
        with pytest.raises(RuntimeError, match="was reset"):
            waiting.result(60.0)


def test_the_data_have_units_and_say_what_was_set(rope: Lab) -> None:
    rope.wait(1.0)
    data = rope.data()
    assert data.t.attrs["units"] == data.now.attrs["units"] == "s"
    assert float(data.now) == rope.time
    assert data.sizes["t"] > 25
    np.testing.assert_allclose(np.diff(data.t), 1 / 30, atol=0.02)
    assert data.total.dims == ("t",)
    assert (data.total.units, data.tip_height.units, data.x.units, data.v.units) == ("J", "m", "m", "m/s")
    assert data.x.shape == (10, 3)
    assert float(data.critical_step) > 1 / 60
    assert data.energy.attrs == {"units": "J", "long_name": "kinetic, elastic, gravity, contact"}
    assert read_setup(data.attrs["link"], "", {})[1] == ROPE.params(stiffness=2000)
    assert json.loads(data.attrs["parameters"])["stiffness"] == 2000


def test_a_chart_that_is_not_over_time_is_in_the_data_over_its_own_columns() -> None:
    kind = scene_named("race")
    scene = kind.make(check_record(kind.params, {"ropes": 1, "points": 3}))
    for _ in range(20):
        scene.advance(4)
    data = to_dataset(kind, scene, (), "")
    columns = scene.curves()["plot_errors"].columns
    assert (data.errors_t.units, data.errors_below_the_accuracy_of_the_reference.units) == ("s", "m")
    assert len(columns[0]) > 1
    np.testing.assert_array_equal(data.errors_t, columns[0])
    np.testing.assert_array_equal(data.errors_below_the_accuracy_of_the_reference, columns[1])


@pytest.mark.parametrize("lines", [1, 3, 4])
def test_the_data_of_a_mooring_have_named_dimensions_and_only_lines_that_exist(lines: int) -> None:
    kind = scene_named("mooring")
    scene = kind.make(check_record(kind.params, {"lines": lines, "segments": 12}))
    scene.advance(40)
    arrays, rows = scene.arrays(), scene.take_plot_rows()
    data = to_dataset(kind, scene, rows, "")
    assert len(rows) > 0
    assert dict(data.sizes) == {"t": len(rows), "line": lines, "node": 13, "segment": 12, "axis": 3, "end": 2} | {
        name: size for name, size in data.sizes.items() if name.startswith("restoring")
    }
    np.testing.assert_array_equal(data.x.sel(axis="z"), arrays["x"][0][..., 2])
    np.testing.assert_array_equal(data.x.sel(line=lines), arrays["x"][0][lines - 1])
    np.testing.assert_array_equal(data.end_tension.sel(end="fairlead"), arrays["end_tension"][0][:, 1])
    assert float(data.body.sel(axis="y")) == arrays["body"][0][1]
    assert data.tension.dims == ("line", "segment")
    plotted = {name for name in data.variables if re.fullmatch(r"(line|anchor)_\d", name)}
    assert plotted == {f"{part}_{i}" for part in ("line", "anchor") for i in range(1, lines + 1)}
    last = np.array(rows[-1])[1 : 1 + lines]
    np.testing.assert_array_equal([float(data[f"line_{i}"][-1]) for i in range(1, lines + 1)], last)
    assert not any(np.isnan(data[name]).any() for name in plotted)


def test_the_data_of_a_mooring_from_a_file_have_a_dimension_for_the_nodes_of_each_line() -> None:
    kind = scene_named("mooring")
    path = Path(__file__).parents[2] / "sim" / "mooring" / "moordyn" / "files" / "chain.txt"
    scene = kind.make(dataclasses.replace(kind.params(), moordyn_file=str(path)))
    data = to_dataset(kind, scene, (), "")
    (line,) = scene.system.lines  # type: ignore[attr-defined]
    x = data[f"x_{line.id}"]
    assert x.dims == (f"node_{line.id}", "axis")
    np.testing.assert_array_equal(x.sel(axis="z"), scene.arrays()[f"x_{line.id}"][0][:, 2])
    assert data[f"tension_{line.id}"].dims == (f"segment_{line.id}",)
    assert data.vessel.dims == ("axis",)
    assert data.end_tension.dims == ("line", "end")
    assert "line_1" in data
    assert "line_2" not in data


def test_without_a_browser_there_is_no_picture_and_the_error_says_so(rope: Lab, monkeypatch) -> None:
    monkeypatch.setattr("app.notebook.picture.PAGE_TIMEOUT", 0.1)
    with pytest.raises(RuntimeError, match="no browser shows this lab"):
        rope.picture()
    for size in ((0, 100), (100, 10**6), ("a", 100)):
        with pytest.raises(ValueError, match="pixels"):
            rope.picture(*size)


def test_a_picture_is_half_a_large_screen_unless_told_otherwise(rope: Lab, monkeypatch) -> None:
    sizes = []
    monkeypatch.setattr("app.notebook.lab.take_still", lambda viewer, *size: sizes.append(size))
    rope.picture()
    rope.picture(320, height=200)
    assert sizes == [(960, 540), (320, 200)]


def test_a_busy_port_is_said_and_changes_nothing(rope: Lab) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(OSError, match=f"port: {port} cannot be used"):
            app.show("rope", port=port)
    assert rope.scene == "rope"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"scene": "rop"}, "scene: 'rop'"), ({"scene": 3}, "scene, preset"),
        ({"scene": "?scene=rope&a=b"}, "a: no such parameter"), ({"preset": "nothing"}, "preset: 'nothing'"),
        ({"preset": "nothing.json"}, "nothing.json"), ({"height": 5}, "height: 5"),
        ({"height": "100%"}, "height: '100%'"), ({"port": 99999}, "port: 99999"), ({"port": "8080"}, "port: '8080'"),
        ({"stiffness": -1}, "stiffness: -1"),
    ],
)  # fmt: skip
def test_a_wrong_argument_is_refused_before_anything_is_opened(arguments: dict, words: str, monkeypatch) -> None:
    monkeypatch.setattr("app.notebook.lab.Viewer", None)
    with pytest.raises(ValueError, match=r".") as error:
        app.show(**arguments)
    assert words in str(error.value)


def test_two_labs_do_not_know_of_each_other_and_end_by_themselves(rope: Lab) -> None:
    with app.show("?scene=rope&stiffness=300", paused=True, damping=2.0) as other:
        other.wait(0.5)
        assert (other.stiffness, other.damping, rope.stiffness) == (300.0, 2.0, 2000.0)
        assert rope.time == 0.0
        assert other.address != rope.address
    assert repr(other) == "<a lab that was stopped>"
    with pytest.raises(RuntimeError, match="this lab was stopped"):
        other.wait(1.0)
    other.stop()
    assert rope.wait(0.1) > 0.0
