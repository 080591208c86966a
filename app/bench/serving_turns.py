"""Processor time that two versions of the program take to serve the same preset, in turns in one run.

`python -m app.bench.serving_turns BEFORE AFTER [SCENE/PRESET ...]`: two folders with the sources, for example a git
worktree of an older commit and this one. Each serves in a process of its own to one client that draws nothing, as a
browser with shaders is served. One runs while the other is paused, a few seconds each, in changing order: so what else
the machine does meets both. The figures are medians, and the ratio is the median of those of the pairs.

The older version must have what `serve` calls, which is so since commit 801f303.
"""

import json
import os
import statistics
import subprocess
import sys
import time
from typing import Any

PRESETS = (  # of the seas, which cost most
    "square_sea/Earth breeze",
    "square_sea/Storm arriving",
    "square_sea/Rain shower",
    "radial_sea/Clear water",
    "radial_sea/Burning rig",
    "radial_sea/Light crude spill 0.2 m",
)
PAIRS, TURN, SETTLING = 9, 2.0, 0.4  # turns of each version, their length [s], and what is not measured before each


def serve() -> None:
    """Serve what is asked for on standard input, a list a line: "open" scene preset, or "run" settling seconds [s].

    Runs with the modules of the version that is measured.
    """
    from app.messages import Pause, Play
    from app.render.injection import record_shaders
    from app.server.viewer import Viewer

    viewer = Viewer("127.0.0.1", 0)
    listener = subprocess.Popen([sys.executable, "-m", "app.bench.listener", str(viewer.port)])
    shown_scene = ""
    try:
        for line in sys.stdin:
            what, *rest = json.loads(line)
            answer: list[float] = []
            if what == "open":
                scene, preset = rest
                if scene != shown_scene:
                    shown_scene = scene
                    viewer.open(scene)
                    record_shaders(viewer.server)
                while not viewer.server.get_clients():
                    time.sleep(0.05)
                viewer.panel.load(preset)
                time.sleep(1.0)
            else:
                settling, seconds = rest
                viewer.loop.commands.put(Play())
                time.sleep(settling)
                spent, simulated, shown = time.process_time(), viewer.loop.latest.status.time, viewer.served.shown
                time.sleep(seconds)
                spent, simulated = time.process_time() - spent, viewer.loop.latest.status.time - simulated
                answer = [spent / simulated, (viewer.served.shown - shown) / simulated]
            viewer.loop.commands.put(Pause())
            time.sleep(0.15)
            print(json.dumps(answer), flush=True)
    finally:
        listener.terminate()
        listener.wait()
        viewer.shut()


class Version:
    """A folder of sources that serves."""

    def __init__(self, folder: str) -> None:
        """folder: that holds the folder app; kernels of all versions share a cache, which is named by their sources."""
        environment = os.environ | {"PYTHONPATH": folder}
        self.process = subprocess.Popen(
            [sys.executable, os.path.abspath(__file__)], cwd=folder, env=environment,
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        )  # fmt: skip

    def ask(self, *what: object) -> list[float]:
        """What `serve` answers. Raises RuntimeError where it has ended."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self.process.stdin.write(json.dumps(what) + "\n")
        self.process.stdin.flush()
        for line in self.process.stdout:
            if line.startswith("["):
                return json.loads(line)
        raise RuntimeError("serving_turns: a version ended")

    def end(self) -> None:
        """Have it end."""
        assert self.process.stdin is not None
        self.process.stdin.close()
        self.process.wait()


def compare(versions: tuple[Version, Version], preset: str, pairs: int, turn: float) -> dict[str, Any]:
    """A row of the table: a preset by both versions."""
    for version in versions:
        version.ask("open", *preset.split("/"))
    for version in versions:
        version.ask("run", SETTLING, turn)
    found: tuple[list[list[float]], list[list[float]]] = [], []
    for pair in range(pairs):
        for i in (0, 1) if pair % 2 == 0 else (1, 0):
            found[i].append(versions[i].ask("run", SETTLING, turn))
    before, after = ([100.0 * cost for cost, _ in turns] for turns in found)
    ratios = sorted(b / a for a, b in zip(before, after, strict=True))
    frames = [statistics.median(frames for _, frames in turns) for turns in found]
    return {
        "preset": preset,
        "before [% of a core]": statistics.median(before),
        "after [% of a core]": statistics.median(after),
        "ratio": statistics.median(ratios),
        "least ratio": ratios[0],
        "greatest ratio": ratios[-1],
        "frames before, after [1/s]": f"{frames[0]:.0f}, {frames[1]:.0f}",
    }


def main(arguments: list[str]) -> None:
    """Print the table, a row after the other."""
    if len(arguments) < 2 or not all(os.path.isdir(os.path.join(folder, "app")) for folder in arguments[:2]):
        raise SystemExit("serving_turns: BEFORE AFTER [SCENE/PRESET ...], two folders that hold the folder app")
    versions = Version(os.path.abspath(arguments[0])), Version(os.path.abspath(arguments[1]))
    try:
        for preset in arguments[2:] or PRESETS:
            row = compare(versions, preset, PAIRS, TURN)
            print("  ".join(f"{name}: {v:.3g}" if isinstance(v, float) else v for name, v in row.items()), flush=True)
    finally:
        for version in versions:
            version.end()


if __name__ == "__main__":
    main(sys.argv[1:]) if len(sys.argv) > 1 else serve()
