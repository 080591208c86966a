"""Files of a recording: what is in them, and that they are read back."""

import csv
import io
import json
import math
import xml.etree.ElementTree as ET
from typing import Any

import numpy as np
import pytest

from app.panel import recording_files
from app.panel.recorder import Kept, Recorder
from app.panel.recording_files import arrays_of, plots_csv, plots_svg, recording_npz
from app.scenes import NAMES, scene_named
from app.server.loop import SimLoop

SMALL: dict[str, dict[str, Any]] = {
    "rope": {"points": 5},
    "race": {"ropes": 2, "points": 5},
    "cloth": {"rows": 5, "cols": 6},
    "square_sea": {"size": "64", "mesh": "64"},
    "radial_sea": {"bodies": 2, "rings": 20, "spokes": 24},
}


def recorded(name: str, frames: int = 6) -> tuple[Any, tuple[Kept, ...], list[Any]]:
    kind = scene_named(name)
    loop = SimLoop(kind.make(kind.params(**SMALL[name])))
    recorder, wall = Recorder(kind.packing), 0.0
    for _ in range(frames):
        loop.tick(1 / 25)
        wall += 1 / 25
        recorder.note(loop.latest, wall)
    return kind, recorder.kept(), [row for row in loop.plot_rows if not math.isnan(row[0])]


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
    assert kind.params(**about["parameters"]) == frames[-1].params
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


def test_plots_are_read_back_from_csv_to_the_last_bit_and_drawn_as_svg() -> None:
    kind, _, rows = recorded("rope", 10)
    rows[2] = (rows[2][0], *(math.nan for _ in rows[2][1:]))
    head, *lines = csv.reader(plots_csv(kind, rows).splitlines())
    assert head[:2] == ["t [s]", "total [J]"]
    assert lines[2][1] == "nan"
    np.testing.assert_array_equal(np.array(lines, float), np.array(rows))
    root = ET.fromstring(plots_svg(kind, rows).encode())
    assert len(root.findall("{http://www.w3.org/2000/svg}g")) == len(kind.plots)
    with pytest.raises(ValueError, match="nothing has been plotted yet"):
        plots_svg(kind, [])
