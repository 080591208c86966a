"""`springtide warmup`: compile every kernel once, with a progress bar, so that the first scene opens at once."""

from rich.progress import Progress

from sim.jit import CACHE


def warm_up() -> int:
    """Run every integrator over a short rope, with floor, sphere and ledger."""
    from sim.springs import INTEGRATORS, rope, simulate

    net = rope(4, floor=-1.0, sphere=(0.0, 0.0, -1.0, 0.2))
    with Progress() as progress:
        task = progress.add_task("compiling", total=len(INTEGRATORS))
        for name in INTEGRATORS:
            progress.update(task, description=name)
            simulate(net, name, 1e-3, 2e-3, 2, with_ledger=True)
            progress.advance(task)
    print(f"Kept in {CACHE}" if CACHE else "Nothing could be kept: no cache directory is writable")
    return 0
