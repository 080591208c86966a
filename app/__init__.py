"""The lab around the numerics: viewer, threads, the wall clock, files."""

import os
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from app.notebook.lab import Lab

# Before numpy is first imported: its BLAS would meet a 32 x 32 eigenproblem with a thread a core, which spin while they
# wait; on a busy machine that turns 0.3 ms into 300.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def show(
    scene: str = "rope",
    *,
    preset: str = "",
    paused: bool = False,
    height: int = 560,
    port: int = 0,
    **parameters: float | str,
) -> "Lab":
    """Show a scene in the output cell of a notebook, and return a handle on it.

    scene: its name, or the address of a set-up, "?scene=...". preset: a name, or the path of a set-up file. paused:
    start with the clock standing still. height: of the output [pixels]. port: to serve on; 0 for any free one.
    parameters: of the scene, as in `app.show("rope", stiffness=2000)`.

    Raises ValueError for what is not allowed, with its name, the value and what is allowed; OSError for a busy port.
    """
    from app.notebook.lab import show_lab  # a program that shows nothing pays nothing for it

    return show_lab(scene, preset, parameters, paused=paused, height=height, port=port)
