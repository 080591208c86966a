"""Names of the integration methods in the panel, in the order of its list."""

from sim.parameters import in_words
from sim.springs import INTEGRATORS
from sim.springs.automatic import AUTO

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


def method_name(integrator: str) -> str:
    """A method in a sentence or a label."""
    return TITLES[integrator][1] if integrator in TITLES else in_words(integrator)
