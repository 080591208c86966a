"""Compile the kernels of the integrators ahead."""

import functools

from app.scenes.contract import Pieces
from sim.springs import INTEGRATORS, Net, simulate

WARM_UP_STEP = 1e-4  # [s]
GAUGE = "stability gauge"  # name of the piece that every scene of springs needs


def integrator_pieces(net: Net, undamped: Net) -> Pieces:
    """Two steps of each method, with the energy account. undamped: for those that accept no damping."""
    return {
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
