"""A replay: one page that holds the frames, the parameters and the plots."""

import base64
import html
import json
import re
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
import zstandard

from app.formats.packing import pack
from app.panel.recording.files import REPLAY_DURATION
from app.panel.recording.recorder import Recorder
from app.panel.recording.recording_files import Plotted
from app.render.material import Grid, Material, Waterline, uniform_table, waterline_table
from app.render.surroundings import LIGHT_SKY
from app.scenes import scene_named, view_named
from app.scenes.setups import read_setup
from app.server.loop.sim_loop import SimLoop
from app.server.replay_file import BITS, MAX_FRAMES, MAX_RAW_BYTES, replay_html, rounded, thinned

DURATION = 2.0  # [s]


@pytest.fixture(scope="module")
def recorded() -> Any:
    kind = scene_named("rope")
    loop = SimLoop(kind.make(kind.params(points=7)), audience=lambda: 1)
    recorder, rows, wall = Recorder(), [], 0.0
    while wall < DURATION:
        loop.tick(1 / 30)
        wall += 1 / 30 + 1e-6
        recorder.note(loop.latest, wall)
        rows += [row for _, row in loop.run.snapshots.pop_rows()]
    return kind, recorder.all_frames(), Plotted(rows, {})


@pytest.fixture(scope="module")
def page(recorded: Any) -> str:
    return replay_html(*recorded)


def content(page: str) -> dict[str, Any]:
    """The recording within a page, in viser's format: a length, then zstandard, in it a length and msgpack."""
    data = re.search(r'__VISER_EMBED_DATA__="([^"]*)"', page)
    assert data is not None
    raw = zstandard.ZstdDecompressor().decompress(base64.b64decode(data[1])[8:])
    return msgspec.msgpack.decode(raw[8 : 8 + int.from_bytes(raw[:8], "little")])


def test_the_page_holds_every_frame_and_its_time(recorded: Any, page: str) -> None:
    _, frames, _ = recorded
    found = content(page)
    times = sorted({time for time, message in found["messages"] if message.get("name") == "/points"})
    assert found["durationSeconds"] == pytest.approx(frames[-1].wall - frames[0].wall)
    assert len(times) == len(frames)


def test_the_page_says_what_it_shows_and_runs_no_text_of_ours(recorded: Any, page: str) -> None:
    kind, frames, _ = recorded
    assert f"<title>Springtide: {kind.title}</title>" in page
    assert page.index(f"Opening {kind.title} …") < page.index("__VISER_EMBED_DATA__=")  # the cover is seen first
    state = html.unescape(re.findall(r'<span data-springtide-topic="picture" data-value="([^"]*)">', page)[0])
    assert json.loads(state) == {"scene": 1, "sky": "studio", "nodes": ["/rope"]}
    assert LIGHT_SKY.css in page  # which has no style sheet of ours
    assert f"t = {frames[0].time:.2f} to {frames[-1].time:.2f} s" in page
    about = page[page.index("springtide-about") :]
    assert "<td>Points</td><td>7 </td>" in about
    assert about.count("<svg") == len(kind.plots)
    assert "src=" not in about


def test_the_page_of_a_race_has_its_charts() -> None:
    kind = scene_named("race")
    loop = SimLoop(kind.make(kind.params(points=4, ropes=2)), audience=lambda: 1)
    recorder = Recorder()
    for i in range(30):
        loop.tick(1 / 30)
        recorder.note(loop.latest, i / 30 + 1e-6)
    page = replay_html(kind, recorder.all_frames(), Plotted((), loop.latest.curves or {}))  # type: ignore[arg-type]
    about = page[page.index("springtide-about") :]
    assert about.count("<svg") == len(kind.curves) == 2
    assert "Distance from the reference" in about


def test_the_page_opens_as_a_set_up(recorded: Any, page: str, tmp_path: Path) -> None:
    kind, frames, _ = recorded
    file = tmp_path / "rope.html"
    file.write_text(page, "utf-8")
    setup = read_setup(str(file))
    assert setup.scene == kind.name
    assert setup.params == frames[-1].params


def test_rounding_keeps_what_is_seen_and_leaves_other_arrays() -> None:
    rng = np.random.default_rng(1)
    points = (rng.uniform(-1, 1, (500, 3)) * (100.0, 3.0, 0.01)).astype(np.float32)
    kept = np.asarray(rounded(points.data))
    assert (np.abs(kept - points).max(axis=0) <= 0.5**BITS * np.abs(points).max(axis=0) * 1.0001).all()
    assert kept.dtype == np.float32
    assert len(np.unique(kept[:, 0])) < len(np.unique(points[:, 0]))
    packed = pack(points.T, (1e-4,) * 3, 10)
    assert (np.asarray(rounded(packed.data)) == packed).all()
    material = uniform_table(Material(haze_distance=3000.0), (1.0, 2.0, 0.02), Grid(9, 9, 600.0))
    for table in (material, waterline_table([Waterline((300.0, 200.0), 0.3, (0.4, 0.6), 0.1)])):
        assert (np.asarray(rounded(table.data)) == table).all()
    faces = np.arange(12, dtype=np.uint32).reshape(4, 3)
    assert (np.asarray(rounded(faces.data)) == faces).all()


def test_a_replay_holds_the_last_frames_evenly_thinned(recorded: Any) -> None:
    _, frames, _ = recorded
    long = [frames[0]._replace(wall=n / 30) for n in range(6000)]
    walls = np.array([kept.wall for kept in thinned(long)])
    assert 0.9 * MAX_FRAMES <= len(walls) <= MAX_FRAMES + 1
    assert (walls[0], walls[-1]) == pytest.approx((walls[-1] - REPLAY_DURATION, long[-1].wall), abs=0.1)
    assert np.ptp(np.diff(walls)) < 2 / 30
    points = np.zeros(1_000_000, np.uint8)
    big = [kept._replace(packed=frames[0].frame._replace(points=points)) for kept in long]
    assert 70 <= len(thinned(big)) <= MAX_RAW_BYTES / points.nbytes + 1
    assert len(thinned(long[:7])) == 7


def test_without_a_frame_it_says_so(recorded: Any) -> None:
    with pytest.raises(ValueError, match="nothing has been recorded yet"):
        replay_html(recorded[0], (), Plotted((), {}))


def test_a_view_that_fails_is_closed(recorded: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    view = view_named(recorded[0].name)
    closed: list[object] = []

    def fail(*_: object) -> None:
        raise RuntimeError("this frame cannot be drawn")

    monkeypatch.setattr(view, "show", fail)
    monkeypatch.setattr(view, "close", lambda self: closed.append(self))
    with pytest.raises(RuntimeError, match="cannot be drawn"):
        replay_html(*recorded)
    assert len(closed) == 1
