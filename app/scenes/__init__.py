"""The scenes: one module each, found by being here, imported on first use.

To add one, write a module here, and its drawing under the same name in `app/pictures`: the two sides of the thread, so
that a headless run imports no viewer. The module has

1. `Params`, a frozen dataclass of knobs with at least `speed` (target real-time factor) and `grid`: from it come the
   panel, the command line, presets and the clamp;
2. `TITLE`, `HELP` (two lines on how to use it), `SERIES` and `PLOTS` (the plot rows' columns, and the charts of each
   plot knob), `PRESETS`: name -> {knob: value}, the first being the defaults;
3. `Scene(params)`, the simulation, on the simulation thread only: `params`, `step` [s], `time` [s], `set_params`,
   `advance(steps)` (raises `DivergenceError`), `reset()`, `obey(command)`, `picture()` (frozen, float32), `gauge()`,
   `take_samples()`, `arrays()` for headless runs, `work()` for the ledger (`app/ledger.py`);
4. `hidden(params)`, the knobs that mean nothing just now, and `warm_up()`, which compiles what the scene may call.

It may have `CURVES` (see `app/plots.py`) with `Scene.curves()`, and `Scene.frame` [s], the time between pictures.

The drawing has `Picture(server, post)` with `show(picture, gauge)`, on the viewer's thread only, whose callbacks only
`post` commands, `readout(snapshot)`, the HTML under the panel's
buttons, `marks(snapshot)`, knob -> the line under it, and `warm_up()`; it may have `notes(snapshot)`, heading -> HTML
to fold out, and `stiffness_knob(params)` with the scene's `build(params)`, the net of a map of step and stiffness.

What a sweep records of it is its plot rows, or what a module of its name in `app/measures` says.
"""

import importlib
import pkgutil
from types import ModuleType

from sim.knobs import refusal

NAMES = tuple(module.name for module in pkgutil.iter_modules(__path__))


def scene_named(name: str) -> ModuleType:
    """The scene's module; raises ValueError with the names there are."""
    if name not in NAMES:
        raise refusal("scene", name, "one of " + ", ".join(NAMES))
    return importlib.import_module(f"{__name__}.{name}")
