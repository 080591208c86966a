"""The method that runs: the one chosen, or another in its stead where that one refuses the net."""

from sim.springs import INTEGRATORS, Net
from sim.springs.integrators import Integrator


def integrator_or_fallback(name: str, net: Net) -> tuple[Integrator, str]:
    """The integrator to take `net` on with, and the line that says why it is not the one called `name`, or ""."""
    chosen = INTEGRATORS[name]
    if not (chosen.undamped_only and net.is_damped):
        return chosen, ""
    # Its nearest kin: as symplectic, and at home with damping.
    kin = [r for r in INTEGRATORS.values() if r.symplectic and not (r.undamped_only or r.implicit)]
    instead = max(kin, key=lambda r: r.order)
    return instead, (
        f"{name} takes no damping, so {instead.name} runs instead: set damping, drag and air to 0, and contact "
        "damping and friction too where there is contact"
    )
