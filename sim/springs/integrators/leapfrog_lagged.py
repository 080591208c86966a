"""Leapfrog as the lab's eq. 8 reads: v_{n+1/2} = v_{n-1/2} + h a(x_n, v_{n-1/2}), x_{n+1} = x_n + h v_{n+1/2}.

The stored velocity lags the position by half a step. Damping is taken with that old velocity, so with damping it is
first order, and its limit shrinks; without, it is the second-order leapfrog.
The step is symplectic Euler's; only the half-step start differs.
"""

from sim.springs.integrators import Integrator
from sim.springs.integrators.symplectic_euler import advance, changes, stable_step

RECORD = Integrator(
    "leapfrog_lagged", 1, True, 1, stable_step, advance,
    "To compare: the lab text read literally, first order once damped.", changes,
    lag=0.5, undamped_order=2,
)  # fmt: skip
