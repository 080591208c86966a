"""Dormand and Prince's pair of orders 5 and 4: six force evaluations a step, the last one shared with the next.

Coefficients: Dormand & Prince (1980), J. Comp. Appl. Math. 6, table 2.
"""

from sim.springs.integrators.embedded.stages import tableau

C = (  # times of the stages
    0.0,
    0.2,
    0.3,
    0.8,
    0.8888888888888888,
    1.0,
)
A = (  # slopes of the stages
    (0.0,),
    (0.2,),
    (0.075, 0.225),
    (0.9777777777777777, -3.7333333333333334, 3.5555555555555554),
    (2.9525986892242035, -11.595793324188385, 9.822892851699436, -0.2908093278463649),
    (2.8462752525252526, -10.757575757575758, 8.906422717743473, 0.2784090909090909, -0.2735313036020583),
)
B = (  # weights
    0.09114583333333333,
    0.0,
    0.44923629829290207,
    0.6510416666666666,
    -0.322376179245283,
    0.13095238095238096,
)
E = (  # the fifth-order weights less the embedded fourth-order ones, the new state included
    0.0012326388888888888,
    0.0,
    -0.0042527702905061394,
    0.03697916666666667,
    -0.05086379716981132,
    0.0419047619047619,
    -0.025,
)

METHOD = tableau(5, C, A, B, (E,))
