"""Make the replays that the front page of the documentation shows: `python docs/make_replays.py`.

They are the program's own replay files, one of each scene, in `docs/replays`, which `conf.py` adds to the site.
"""

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from app.panel.recording.recorder import Recorder
from app.panel.recording.recording_files import Plotted
from app.scenes import scene_named
from app.scenes.setups import make_setup
from app.server.loop.sim_loop import SimLoop
from app.server.replay_file import replay_html

FOLDER = Path(__file__).with_name("replays")
MAX_BYTES = 3_000_000
ROUNDING = 1e-6  # [s]


class Clip(NamedTuple):
    """A part of a run. rate: frames a second. values: parameters beside those of the preset."""

    preset: str
    start: float  # [s]
    end: float
    rate: float = 20.0
    values: Mapping[str, Any] = {}


CLIPS = {
    "rope": Clip("Over the sphere", 0.0, 6.0),
    "race": Clip("Undamped until chaos", 8.0, 13.0, 14.0),
    "cloth": Clip("Drape over the sphere", 0.0, 3.0, values={"rows": 32, "cols": 32}),
    "square_sea": Clip("Earth breeze", 4.0, 9.0, 12.0, {"size": "64"}),
    "radial_sea": Clip("Light crude spill 0.2 m", 8.0, 12.0, 8.0),
    "mooring": Clip("Chain catenary", 4.0, 12.0),
}


def page_of(scene: str, clip: Clip) -> str:
    """The page of the replay of a part of a run."""
    kind = scene_named(scene)
    loop = SimLoop(kind.make(make_setup(kind, clip.preset, clip.values).params), audience=lambda: 1)
    recorder, rows, wall = Recorder(kind.packing), [], 0.0
    while loop.scene.time < clip.end:
        loop.tick(1.0 / clip.rate)
        wall += 1.0 / clip.rate + ROUNDING
        rows += [row for _, row in loop.run.snapshots.pop_rows()]
        if loop.scene.time >= clip.start:
            recorder.note(loop.latest, wall)
    return replay_html(kind, recorder.all_frames(), Plotted(rows, {}))


def main() -> None:
    """Write the replays that are named, or all."""
    FOLDER.mkdir(exist_ok=True)
    for scene in sys.argv[1:] or CLIPS:
        page = page_of(scene, CLIPS[scene]).encode()
        print(f"{scene}: {len(page) / 1e6:.2f} MB")
        if len(page) > MAX_BYTES:
            raise SystemExit(f"the replay of {scene} has {len(page)} bytes; at most {MAX_BYTES} are allowed")
        (FOLDER / f"{scene}.html").write_bytes(page)


if __name__ == "__main__":
    main()
