"""Files of a recording: what is in them, and that they are read back."""

import csv
import io
import json
import math
import xml.etree.ElementTree as ET
from typing import Any

import msgspec
import numpy as np
import pytest

from app.panel.recording import recording_files
from app.panel.recording.recorder import RecordedFrame, Recorder
from app.panel.recording.recording_files import Plotted, arrays_of, plots_csv, plots_svg, recording_npz
from app.scenes import NAMES, scene_named
from app.server.loop.sim_loop import SimLoop

SMALL: dict[str, dict[str, Any]] = {  # scene -> what makes it cheap; a new scene needs no entry
    "rope": {"points": 5},
    "race": {"ropes": 2, "points": 5},
    "cloth": {"rows": 5, "cols": 6},
    "square_sea": {"size": "64", "mesh": "64"},
    "radial_sea": {"bodies": 2, "rings": 20, "spokes": 24},
}


def recorded(name: str, frames: int = 6) -> tuple[Any, tuple[RecordedFrame, ...], list[Any]]:
    kind = scene_named(name)
    loop = SimLoop(kind.make(kind.params(**SMALL.get(name, {}))))
    recorder, wall = Recorder(kind.packing), 0.0
    for _ in range(frames):
        loop.tick(1 / 25)
        wall += 1 / 25
        recorder.note(loop.latest, wall)
    return kind, recorder.all_frames(), [row for _, row in loop.run.snapshots.plot_rows]


@pytest.mark.parametrize("name", NAMES)
def test_a_file_holds_every_frame_with_units_and_parameters(name: str) -> None:
    kind, frames, _ = recorded(name)
    with np.load(io.BytesIO(recording_npz(kind, frames))) as file:
        about = json.loads(str(file["about"]))
        assert file["t"].tolist() == [kept.time for kept in frames]
        names = set(file.files) - {"t", "about"}
        assert (
            names == set(about["units"]) - {"t"} == set(kind.frame_units) & {n for n, _ in arrays_of(frames[0].frame)}
        )
        for number, kept in enumerate(frames):
            for key, array in arrays_of(kept.frame):
                if key in names:
                    np.testing.assert_array_equal(file[key][number], array)
    assert msgspec.convert(about["parameters"], kind.params) == frames[-1].params
    assert about["scene"] == name


def test_a_file_begins_where_the_number_of_points_changed_and_keeps_within_its_size(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    kind, frames, _ = recorded("rope", 20)
    other = frames[3]._replace(packed=frames[3].frame._replace(points=np.zeros((9, 3), np.float32)))  # type: ignore
    with np.load(io.BytesIO(recording_npz(kind, (*frames[:3], other, *frames[4:])))) as file:
        assert file["t"].tolist() == [kept.time for kept in frames[4:]]
    monkeypatch.setattr(recording_files, "MAX_ARRAYS", 500)
    with np.load(io.BytesIO(recording_npz(kind, frames))) as file:
        assert file["points"].nbytes + file["tension"].nbytes <= 500
        assert len(file["t"]) > 3
    with pytest.raises(ValueError, match="nothing has been recorded yet"):
        recording_npz(kind, ())


def read_columns(text: str) -> dict[str, np.ndarray]:
    """The columns of a CSV file; empty cells end a column."""
    head, *lines = csv.reader(text.splitlines())
    assert all(len(line) == len(head) for line in lines)
    return {name: np.array([cell for cell in cells if cell], float) for name, *cells in zip(head, *lines, strict=True)}


def test_plots_are_read_back_from_csv_to_the_last_bit_and_drawn_as_svg() -> None:
    kind, _, rows = recorded("rope", 10)
    rows[2] = (rows[2][0], *(math.nan for _ in rows[2][1:]))
    head, *lines = csv.reader(plots_csv(kind, Plotted(rows, {})).splitlines())
    assert head[:2] == ["t [s]", "total [J]"]
    assert lines[2][1] == ""  # a spreadsheet draws a gap there, and a word as 0
    np.testing.assert_array_equal(np.array([[cell or "nan" for cell in line] for line in lines], float), np.array(rows))
    root = ET.fromstring(plots_svg(kind, Plotted(rows, {})).encode())
    assert len(root.findall("{http://www.w3.org/2000/svg}g")) == len(kind.plots)
    for write in (plots_csv, plots_svg):
        with pytest.raises(ValueError, match="nothing has been plotted yet"):
            write(kind, Plotted((), {}))


def with_curves(name: str, values: dict[str, Any], seconds: float) -> tuple[Any, Any, Plotted]:
    kind = scene_named(name)
    scene: Any = kind.make(kind.params(**{**SMALL[name], **values}))
    for _ in range(round(30 * seconds)):
        scene.advance(max(1, round(1 / 30 / scene.step)))
        scene.frame()
    rows = [row for row in scene.take_plot_rows() if not math.isnan(row[0])]
    return kind, scene, Plotted(rows, scene.curves() or {})


def test_the_plots_of_a_race_go_into_the_files_with_what_they_clip() -> None:
    values = {"integrator": "rk4", "integrator_2": "explicit_euler", "time_step": 1 / 240}
    kind, scene, plotted = with_curves("race", values, 2.0)
    columns = read_columns(plots_csv(kind, plotted))
    names = [line.label for line in plotted.curves["plot_energies"].lines]  # type: ignore[union-attr]
    errors = [f"Distance from the reference: {name} [m]" for name in names]
    energies = [f"Energy error: {name} [J]" for name in names]
    floor = "Distance from the reference: below the accuracy of the reference [m]"
    assert list(columns) == ["t [s]", floor, *errors, *energies]
    rows = scene.charts.rows[: scene.charts.count]
    np.testing.assert_array_equal(columns["t [s]"], rows[:, 0])
    np.testing.assert_array_equal(columns[errors[0]], rows[:, 2])
    np.testing.assert_array_equal(columns[energies[1]], rows[:, 5])
    assert rows[-1, 2] == scene.race.error(scene.race.entrants[0])
    svg = plots_svg(kind, plotted)
    assert len(ET.fromstring(svg.encode()).findall("{http://www.w3.org/2000/svg}g")) == 2
    assert "Energy error [J]" in svg
    assert "0.1 mm" in svg


def test_the_spectrum_of_the_gauge_stands_beside_its_height_while_its_chart_is_open() -> None:
    values = {"plot_wave_spectrum": True, "statistics": False}
    kind, scene, plotted = with_curves("square_sea", values, 12.0)
    columns = read_columns(plots_csv(kind, plotted))
    measured, theory = (f"Spectrum at the wave gauge: {name} [m²/Hz]" for name in ("measured", "theory"))
    assert list(columns) == ["t [s]", "wave gauge [m]", "f [Hz]", measured, theory]
    assert len(columns["t [s]"]) > len(columns["f [Hz]"]) > 4
    for name, column in zip(("f [Hz]", measured, theory), plotted.curves["plot_wave_spectrum"], strict=True):
        np.testing.assert_array_equal(columns[name], np.asarray(column))
    assert "Spectrum at the wave gauge [m²/Hz]" in plots_svg(kind, plotted)
    scene.params = type(scene.params)(**{**vars(scene.params), "plot_wave_spectrum": False})
    assert scene.curves() is None


def test_the_oil_budget_goes_into_the_file_as_shares_and_not_as_it_is_stacked() -> None:
    values = {"spill": "layer", "oil": "Arabian Light", "plot_budget": True, "spill_hours": 24.0}
    kind, _, plotted = with_curves("radial_sea", values, 0.2)
    columns = read_columns(plots_csv(kind, plotted))
    parts = [columns[f"Oil budget: {name} [%]"] for name in ("evaporated", "drops in the water", "on the sea")]
    assert not any(name.startswith("Oil budget: now") for name in columns)
    np.testing.assert_allclose(sum(parts), 100.0)
    assert parts[0][0] == 0.0
    assert parts[2][-1] < parts[2][0]
    assert "Oil budget [%]" in plots_svg(kind, plotted)


def test_a_part_of_the_plots_is_that_of_a_time() -> None:
    kind, _, plotted = with_curves("race", {}, 1.0)
    part = plotted.between(0.3, 0.7)
    for name, chart in part.curves.items():
        t = chart.columns[0]  # type: ignore[union-attr]
        assert (t.min(), t.max()) == pytest.approx((0.3, 0.7), abs=0.034)
        assert all(len(column) == len(t) for column in chart.columns), name  # type: ignore[union-attr]
    assert len(read_columns(plots_csv(kind, part))["t [s]"]) == pytest.approx(12, abs=1)
    sea = Plotted((), {"plot_wave_spectrum": (np.arange(9.0),) * 3})
    assert len(sea.between(1.0, 2.0).curves["plot_wave_spectrum"][0]) == 9  # type: ignore[arg-type]
