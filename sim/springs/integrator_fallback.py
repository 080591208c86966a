"""Integrator of a run: the chosen one, the choice of `auto`, or a replacement if the chosen one refuses the net."""

from sim.springs.automatic import AUTO, choose_for_step
from sim.springs.integrators import Integrator, discover, integrator_named
from sim.springs.net import Net


def integrator_or_fallback(name: str, net: Net, h: float) -> tuple[Integrator, str]:
    """The integrator called `name`, or its replacement if it allows no damping and `net` is damped.

    h: [s], by which "auto" chooses. Also returns a line that says why another method runs, or "". Raises ValueError
    for an unknown name.
    """
    if name == AUTO:
        choice = choose_for_step(net, h)
        return choice.integrator, f"{choice.integrator.name} runs: {choice.reason}"
    chosen = integrator_named(name)
    if not (chosen.undamped_only and net.is_damped):
        return chosen, ""
    # The closest method that allows damping: explicit and symplectic too, of the highest order there is.
    similar = [r for r in discover().values() if r.symplectic and not (r.undamped_only or r.implicit)]
    fallback = max(similar, key=lambda r: r.order)
    return fallback, (
        f"{name} allows no damping, so {fallback.name} runs instead: set damping, drag and air to 0, and with floor "
        "or sphere also contact damping and friction"
    )
