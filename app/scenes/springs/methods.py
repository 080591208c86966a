"""Names of the integration methods in the panel, in the order of its list, and which of them runs."""

from collections.abc import Callable

from sim.parameters import in_words
from sim.springs import INTEGRATORS, Net
from sim.springs.automatic import AUTO
from sim.springs.integrator_fallback import integrator_or_fallback

TITLES = {  # name -> (title in a list, name in a sentence)
    "explicit_euler": ("Euler, explicit (lab eq. 5)", "explicit Euler"),
    "symplectic_euler": ("Euler, symplectic (lab's code)", "symplectic Euler"),
    "rk4": ("Runge-Kutta 4 (RK4)", "Runge-Kutta 4"),
    "leapfrog": ("Leapfrog", "leapfrog"),
    "leapfrog_lagged": ("Leapfrog, lagged (lab eq. 8)", "lagged leapfrog"),
    "implicit_euler": ("Euler, implicit", "implicit Euler"),
    "implicit_midpoint": ("Midpoint, implicit", "implicit midpoint"),
    "tr_bdf2": ("TR-BDF2, implicit", "TR-BDF2"),
    "pefrl": ("PEFRL (no damping)", "PEFRL"),
    "dopri5": ("Dormand-Prince 5, adaptive", "Dormand-Prince 5"),
    "dop853": ("Dormand-Prince 8, adaptive", "Dormand-Prince 8"),
    "rkn8": ("Nyström 8, adaptive", "Nyström 8"),
}
ORDER = sorted(INTEGRATORS, key=[*TITLES, *INTEGRATORS].index)
# A method that is not listed above comes last, with its name in words.
METHODS = {name: TITLES[name][0] if name in TITLES else in_words(name) for name in ORDER}
METHODS_AND_AUTO = {**METHODS, AUTO: "Automatic (Dormand-Prince or Nyström)"}  # where a net chooses its method

FEW_POINTS = 8  # along a side of a net that has all the links of a large one about some point


def method_name(integrator: str) -> str:
    """A method in a sentence or a label."""
    return TITLES[integrator][1] if integrator in TITLES else in_words(integrator)


def method_that_runs(name: str, step: float, build: Callable[[], Net]) -> str:
    """Name of the method that runs where `name` is chosen.

    build: makes a net with the damping and the fastest vibration of the one that moves. It is called only if
    these decide which method runs: making a large one would take longer than a slider event may.
    """
    if name != AUTO and not INTEGRATORS[name].undamped_only:
        return name
    return integrator_or_fallback(name, build(), step)[0].name
