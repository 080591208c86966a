"""Dormand-Prince 5(4), adaptive: it chooses its steps for a given tolerance, and fills frames in between.

Six force evaluations a step of fifth order, the last one shared with the next. Undamped modes hold to h omega = 1 only,
so that it is expensive on stiff nets. Choose it for soft nets and tolerances of 1e-5 to 1e-8.
Coefficients: Dormand & Prince (1980), J. Comp. Appl. Math. 6, table 2.
"""

from functools import partial

from sim.springs.analysis.amplification import changes_of_polynomial, polynomial_of, stable_step_of_polynomial
from sim.springs.integrators import Integrator
from sim.springs.integrators.embedded.march import march
from sim.springs.integrators.embedded.stages import tableau, take_steps

C = (0.0, 0.2, 0.3, 0.8, 0.8888888888888888, 1.0)  # times of the stages
A = (  # slopes of the stages
    (0.0,),
    (0.2,),
    (0.075, 0.225),
    (0.9777777777777777, -3.7333333333333334, 3.5555555555555554),
    (2.9525986892242035, -11.595793324188385, 9.822892851699436, -0.2908093278463649),
    (2.8462752525252526, -10.757575757575758, 8.906422717743473, 0.2784090909090909, -0.2735313036020583),
)  # fmt: skip
B = (  # weights
    0.09114583333333333, 0.0, 0.44923629829290207, 0.6510416666666666, -0.322376179245283, 0.13095238095238096,
)  # fmt: skip
E = (  # the fifth-order weights less the embedded fourth-order ones, the new state included
    0.0012326388888888888, 0.0, -0.0042527702905061394, 0.03697916666666667, -0.05086379716981132, 0.0419047619047619,
    -0.025,
)  # fmt: skip

METHOD = tableau(5, C, A, B, (E,))
POLYNOMIAL = polynomial_of(A, B)


def stable_step(omega: float, rate: float) -> float:
    """Limit: the stability polynomial, 1 + s + ... + s^5/120 + s^6/600, exceeds 1 on the ray of s = h lambda."""
    return stable_step_of_polynomial(POLYNOMIAL, omega, rate)


RECORD = Integrator(
    "dopri5", 5, False, 6, stable_step, partial(take_steps, METHOD),
    "For a known error: chooses its own steps, errors of 1e-5 to 1e-8.",
    changes_of_polynomial(POLYNOMIAL), march=partial(march, METHOD),
)  # fmt: skip
