"""`springtide run`: a scene without a browser, sampled into one .npz file with units and all parameters."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
from rich.progress import Progress

from app.files import check_folder, replacing
from app.messages import DivergenceError
from app.scenes.contract import SceneKind
from sim.validation import argument_error

MOST_BYTES = 4e9  # of a file, before it is packed


def run_to_file(name: str, scene: SceneKind[Any, Any, Any], params: Any, seconds: float, rate: float, out: Path) -> int:
    """Run and write; a run that diverges keeps what it had, says so, and returns 1."""
    if not (math.isfinite(seconds) and 0 < seconds <= 1e6):
        raise argument_error("--seconds", seconds, "above 0 to 1e+06 s")
    if not (math.isfinite(rate) and 0 < rate <= 1e5):
        raise argument_error("--rate", rate, "above 0 to 100000 Hz")
    if out.suffix != ".npz":
        raise argument_error("--out", str(out), "a name that ends in .npz")
    check_folder("--out", out)
    running = scene.make(params)
    # More frames than steps would only repeat themselves.
    frames = max(1, min(round(seconds * rate), steps_to(running, seconds)))
    size = (frames + 1) * sum(array.nbytes for array, _ in running.arrays().values())
    if size > MOST_BYTES:
        raise ValueError(
            f"--seconds, --rate: {frames} frames are {size / 1e9:.3g} GB; allowed: at most {MOST_BYTES / 1e9:g} GB"
        )
    if running.note:
        # A file is no place for a method that was not asked for.
        raise argument_error(
            "integrator", params.integrator, "another, as this net is damped: by links, drag, air or contact"
        )
    times, columns, units = [], {}, {}
    problem = ""
    with Progress(transient=True) as progress:
        task = progress.add_task(f"{name}, {seconds:g} s", total=frames)
        for frame in range(frames + 1):
            if frame:
                try:
                    running.advance(steps_to(running, seconds * frame / frames))
                except DivergenceError as reason:
                    problem = str(reason)
                    break
            times.append(running.time)
            for key, (array, unit) in running.arrays().items():
                columns.setdefault(key, []).append(array)
                units[key] = unit
            progress.update(task, completed=frame)
    arrays: dict[str, Any] = {"t": np.array(times), **{key: np.array(values) for key, values in columns.items()}}
    about = {"scene": name, "parameters": vars(params), "units": {"t": "s", **units}, "diverged": problem}
    write_whole(out, {**arrays, "about": np.array(json.dumps(about))})
    print(f"{out}: {len(times)} frames to t = {times[-1]:g} s, {', '.join(arrays)}")
    if problem:
        print(f"The run ended early. {problem}")
        return 1
    return 0


def steps_to(running: Any, until: float) -> int:
    """Steps from a scene's time to the first whole step at or after `until` [s], forgiving round-off."""
    return max(0, math.ceil((until - running.time) / running.step * (1.0 - 1e-9) - 1e-6))


def write_whole(path: Path, arrays: dict[str, Any]) -> None:
    """Write an .npz so that `path` holds all of it or what it held before."""
    with replacing(path) as draft:
        np.savez_compressed(draft, **arrays)
