"""Compile the kernels of the integrators ahead."""

from collections.abc import Iterator

from sim.springs import INTEGRATORS, Net, simulate

WARM_UP_STEP = 1e-4  # [s]


def compile_integrators(net: Net, undamped: Net) -> Iterator[str]:
    """Run two steps of each method, with the energy account; yields the name of the next. undamped: for those that
    accept no damping."""
    for name, record in INTEGRATORS.items():
        yield name
        chosen = undamped if record.undamped_only else net
        simulate(chosen, name, WARM_UP_STEP, 2 * WARM_UP_STEP, 2, with_account=True)
