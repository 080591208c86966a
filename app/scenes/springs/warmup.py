"""Compile the kernels of the integrators ahead."""

import functools
from collections.abc import Iterable

import numpy as np

from app.scenes.contract import Pieces
from sim.jit import compile_ahead
from sim.springs import INTEGRATORS, Net, simulate
from sim.springs.damping import make_decay
from sim.springs.kicks.kick import kick, make_kick_room

WARM_UP_STEP = 1e-4  # [s]
GAUGE = "stability gauge"  # name of the piece that every scene of springs needs
KICKED = "leapfrog"  # the method whose kicks are compiled separately
KICKS = f"kicks of {KICKED}"


def integrator_pieces(net: Net, undamped: Net) -> Pieces:
    """Two steps of each method, with the energy account. undamped: for those that accept no damping.

    Leapfrog takes long to compile, so its kicks are a separate piece. They come first and a scene's gauge last: of two
    workers one compiles the kicks and then the gauge, the other the rest of leapfrog.
    """
    methods = {
        name: functools.partial(
            simulate,
            undamped if record.undamped_only else net,
            2 * WARM_UP_STEP,
            2,
            WARM_UP_STEP,
            name,
            with_account=True,
        )
        for name, record in INTEGRATORS.items()
    }
    return {KICKS: functools.partial(compile_kicks, net), **methods}


def compile_kicks(net: Net) -> None:
    """Compile the kicks of leapfrog."""
    p, x, ledger = net.kernel_view(WARM_UP_STEP), net.start().reshape(-1), np.zeros(4)
    decay, room = compile_ahead(make_decay, p, 0.0), compile_ahead(make_kick_room, x, p, 0.0, True)
    compile_ahead(kick, x, x, x, 0.0, 0.0, decay, room, p, True, True, True, ledger)


def pieces_of_methods(methods: Iterable[str]) -> tuple[str, ...]:
    """The names of the pieces that methods need."""
    return *((KICKS,) if KICKED in methods else ()), *methods
