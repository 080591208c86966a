"""The Nystroem pair 8(6) of Dormand, El-Mikkawy and Prince, adaptive, for nets that are stiff or weakly damped.

Eight force evaluations a step where dop853 takes twelve, and eighth order without damping. With damping it is of fifth
order, in small terms. Where stiffness limits the steps, or damping is weak, it takes half to three quarters of dop853's
evaluations at equal error. A soft net with strong damping, as the lab's default rope, costs it 1.4 times as many at
1e-9 m and three times as many at 1e-12 m: choose dop853 there.

A, B and B_V: Dormand, El-Mikkawy & Prince (1987), IMA J. Numer. Anal. 7, 423, for x'' = g(x). V, the velocities of the
stages, is our own and takes damping in. With b' the weights of the velocity and e those of its error estimate, it
solves sum_j V_ij = c_i, sum_j V_ij c_j = c_i^2/2 (of stage 2 the first only), sum_i b'_i V_ij = b'_j (1 - c_j),
sum b'_i c_i^p V_ij c_j^q = 1/((q + 1)(p + q + 2)) for p + q <= 4, sum e_i c_i^p V_ij c_j^q = 0 for (p, q) = (0, 2),
(0, 3), (1, 2), and, as stage 2 is less exact, sum b'_i c_i V_i2 = sum e_i V_i2 = 0. The error is then of order 6 in
terms with one factor of the damping and of order 5 in others. What is left free makes the sums of p + q = 5, 6 and V
itself small.
"""

import functools

from sim.springs.analysis.amplification import changes_of_nystroem, stable_step_of_nystroem
from sim.springs.integrators import Integrator
from sim.springs.integrators.embedded.march import march
from sim.springs.integrators.embedded.stages import rows_of, tableau_of_rows, take_steps

C = (0.0, 1 / 20, 1 / 10, 3 / 10, 1 / 2, 7 / 10, 9 / 10, 1.0)  # times of the stages
A = (  # their positions
    (0.0,),
    (1 / 800,),
    (1 / 600, 1 / 300),
    (9 / 200, -9 / 100, 9 / 100),
    (-66701 / 197352, 28325 / 32892, -2665 / 5482, 2170 / 24669),
    (227015747 / 304251000, -54897451 / 30425100, 12942349 / 10141700, -9499 / 304251, 539 / 9250),
    (-1131891597 / 901789000, 41964921 / 12882700, -6663147 / 3220675, 270954 / 644135, -108 / 5875, 114 / 1645),
    (13836959 / 3667458, -17731450 / 1833729, 1063919505 / 156478208, -33213845 / 39119552, 13335 / 28544,
     -705 / 14272, 1645 / 57088),
)  # fmt: skip
V = (  # their velocities
    (0.0,),
    (0.05,),
    (0.0, 0.1),
    (0.7735746913599653, -1.8471493827199306, 1.3735746913599653),
    (-0.5145341672757767, 1.7727711876120718, -1.3191627336014244, 0.5609257132651295),
    (-1.5280579553033204, 2.2080051695175986, 0.04872872452441776, -0.7203241922051312, 0.6916482534664353),
    (1.690631856384449, -2.4107949792623815, 0.3930132721416066, 1.1426520869604175, -0.42147180508848564,
     0.5059695688643943),
    (0.47720538514093636, -1.0396967827831831, 0.45475640942513995, 0.8067188170667985, 0.3073920847641276,
     -0.5826791647348954, 0.5763032511210763),
)  # fmt: skip
B = (223 / 7938, 0.0, 1175 / 8064, 925 / 6048, 41 / 448, 925 / 14112, 1175 / 72576, 0.0)  # weights of the position
B_V = (  # and of the velocity
    223 / 7938, 0.0, 5875 / 36288, 4625 / 21168, 41 / 224, 4625 / 21168, 5875 / 36288, 223 / 7938,
)  # fmt: skip
E = (  # weights of the position less those of sixth order
    223 / 7938 - 7987313 / 109941300, 0.0, 1175 / 8064 - 1610737 / 44674560, 925 / 6048 - 10023263 / 33505920,
    41 / 448 + 497221 / 12409600, 925 / 14112 - 10023263 / 78180480, 1175 / 72576 - 1610737 / 402071040, 0.0, 0.0,
)  # fmt: skip
E_V = (  # and of the velocity, the new state's acceleration included
    223 / 7938 - 7987313 / 109941300, 0.0, 5875 / 36288 - 1610737 / 40207104, 4625 / 21168 - 10023263 / 23454144,
    41 / 224 + 497221 / 6204800, 4625 / 21168 - 10023263 / 23454144, 5875 / 36288 - 1610737 / 40207104,
    223 / 7938 + 4251941 / 54970650, -3 / 20,
)  # fmt: skip

VELOCITY, POSITION = rows_of((*V, B_V, E_V), len(B)), rows_of((*A, B, E), len(B))
METHOD = tableau_of_rows(7, C, VELOCITY, POSITION)
STEP = C, VELOCITY[: len(C) + 1, :-1], POSITION[: len(C) + 1, :-1]


@functools.lru_cache(maxsize=1000)
def stable_step(omega: float, rate: float) -> float:
    """Limit at which the step matrix of its eight stages has an eigenvalue above 1."""
    return stable_step_of_nystroem(STEP, omega, rate)


RECORD = Integrator(
    "rkn8", 5, False, 8, stable_step, functools.partial(take_steps, METHOD),
    "For references of stiff or weakly damped nets: chooses its own steps.",
    functools.partial(changes_of_nystroem, STEP),
    undamped_order=8, march=functools.partial(march, METHOD),
)  # fmt: skip
