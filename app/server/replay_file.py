"""A replay: one HTML file with frames of a scene, its parameters and plots, which opens offline in any browser.

The frames are drawn by the scene's own view, on a server that nobody connects to, and recorded by viser's serialiser,
which adds its client. Positions are rounded below visibility, as rounded numbers take half the space. The parameters
are in it as a set-up file, so that it can be loaded again.
"""

import contextlib
import io
import itertools
from collections.abc import Sequence

import numpy as np

from app.formats.packing import is_packed
from app.messages import BaseParams
from app.panel.recording.files import REPLAY_DURATION
from app.panel.recording.recorder import RecordedFrame, arrays_of_frame
from app.panel.recording.recording_files import Plotted, plot_charts
from app.render.cameras import place_cameras
from app.render.client_page import with_ours
from app.render.handles.viser_inside import change_buffers
from app.render.injection import record_shaders
from app.render.markup.html import Html, fill, join, plain_table
from app.render.scripts import BEFORE_REPLAY, REPLAY
from app.render.surroundings import LIGHT_SKY
from app.scenes import view_named
from app.scenes.contract import AnyKind
from app.scenes.setups import setup_block, write_value
from app.server.web.guard import open_server
from sim.parameters import in_words, parameters_of

MAX_FRAMES = 200  # of a replay
MAX_RAW_BYTES = 80e6  # of the arrays of all frames, before they are packed: a file of about 20 MB
TOLERANCE = 1e-3  # [s] of the time between two frames
MIN_VECTORS = 64  # of an array of places; the numbers that shaders read (`app/render/material.py`) are fewer
BITS = 11  # kept of each coordinate, over its largest size in a frame
STYLE = (
    "#springtide-about{position:fixed;top:8px;left:8px;z-index:9;max-width:600px;max-height:80vh;overflow:auto;"
    "background:#fffffff2;color:#1b2a3a;border-radius:6px;padding:6px 10px;font:13px/1.4 sans-serif;"
    "box-shadow:0 1px 6px #0003}#springtide-about summary{cursor:pointer;font-weight:bold}"
    "#springtide-about td{padding:0 10px 0 0}"
    f"canvas[data-engine]{{background:{LIGHT_SKY.css}}}"
    "#springtide-slow{top:52px!important;bottom:auto!important}"  # in the sky, as labels stand below it
    "#webgl-software-rendering{display:none!important}"  # the line on slow drawing says it
)


def rounded(buffer: memoryview) -> memoryview:
    """An array of 3-vectors of float32 with `BITS` bits of each coordinate; any other, or a short one, as it is."""
    values = np.asarray(buffer)
    vectors = values.dtype == np.float32 and values.ndim >= 2 and values.shape[-1] == 3
    if not vectors or values.size < 3 * MIN_VECTORS or is_packed(values):
        return buffer
    largest = np.abs(values).reshape(-1, 3).max(axis=0)
    step = np.exp2(np.ceil(np.log2(np.maximum(largest, 1e-9))) - BITS).astype(np.float32)
    return np.ascontiguousarray(np.round(values / step) * step, np.float32).data


def thinned(frames: Sequence[RecordedFrame]) -> list[RecordedFrame]:
    """The frames of the last `REPLAY_DURATION`, evenly thinned to keep within `MAX_FRAMES` and `MAX_RAW_BYTES`.

    frames: at least one.
    """
    last = frames[-1]
    size = sum(arrays_of_frame(last.frame).values())
    span = min(last.wall - frames[0].wall, REPLAY_DURATION)
    interval = span / max(1, min(MAX_FRAMES, int(MAX_RAW_BYTES / max(size, 1))))
    chosen: list[RecordedFrame] = []
    for frame in (frame for frame in frames if last.wall - frame.wall < span + TOLERANCE):
        if not chosen or frame.wall - chosen[-1].wall >= interval - TOLERANCE:
            chosen.append(frame)
    return chosen


def replay_html(kind: AnyKind, frames: Sequence[RecordedFrame], plotted: Plotted) -> str:
    """The page of a replay of the last of these frames. plotted: the data of the plots.

    Raises ValueError if there is no frame.
    """
    if not frames:
        raise ValueError("nothing has been recorded yet: let the scene run first")
    chosen = thinned(frames)
    server = open_server("127.0.0.1", 0).server
    try:
        injector = record_shaders(server)
        params = chosen[-1].params
        with contextlib.closing(view_named(kind.name)(server, lambda command: None)) as view:
            place_cameras(server, *view.first_view(params), view.FIELD_OF_VIEW)
            view.show(chosen[0].frame)
            whole = injector.whole_picture()
            recording = server.get_scene_serializer()
            for before, frame in itertools.pairwise(chosen):
                recording.insert_sleep(frame.wall - before.wall)
                with server.atomic():
                    view.show(frame.frame)
            server.flush()
            change_buffers(recording, rounded)
            page = recording.as_html()
    finally:
        with contextlib.redirect_stdout(io.StringIO()):  # viser would say that a server has stopped
            server.stop()
    about = about_html(kind, params, plotted, chosen[0].time, chosen[-1].time)
    ours = with_ours(
        page, title=f"Springtide: {kind.title}", words=f"Opening {kind.title} …", before=BEFORE_REPLAY,
        entry=REPLAY, last=f"{whole}{about}{setup_block(kind, params)}",
    )  # fmt: skip
    return ours or page  # viser's page as it is, if it is not as expected


def about_html(kind: AnyKind, params: BaseParams, plotted: Plotted, start: float, end: float) -> Html:
    """Description of the replay: the scene, all parameters, and the plots between two times [s]."""
    charts = join(chart.svg for chart in plot_charts(kind, plotted.between(start, end)))
    values = plain_table(
        (p.title or in_words(name), f"{write_value(getattr(params, name))} {p.unit}")
        for name, p in parameters_of(params).items()
    )
    return fill(
        "<style>{}</style><details id='springtide-about'><summary>{}: t = {:.2f} to {:.2f} s</summary>"
        "{}{}</details>",
        Html(STYLE), kind.title, start, end, charts, values,
    )  # fmt: skip
