"""Motions to compare with: scipy's DOP853 at 1e-12 on the same forces, which test_forces checks one by one."""

import numpy as np
from scipy.integrate import solve_ivp

from sim.springs import INTEGRATORS, Net
from sim.springs.points.acceleration import set_acceleration
from sim.springs.state import State, advance, velocities


def exact(net: Net, seconds: float, v0=None):
    """x and v (3, rows, cols) of `net` after `seconds` [s] from x0 at rest, or at v0."""
    p = net.kernel_view(1e-9)
    size = net.x0.size
    a = np.empty(size)

    def pins(t, x, v):
        for (i, j), path in net.pin_paths:
            c, s = np.array(path.coefficients), t - path.start
            at = np.arange(3) * net.shape[0] * net.shape[1] + i * net.shape[1] + j
            x[at] = c[0] + c[1] * s + c[2] * s**2 + c[3] * s**3
            v[at] = c[1] + 2 * c[2] * s + 3 * c[3] * s**2

    def slope(t, y):
        x, v = y[:size].copy(), y[size:].copy()
        pins(t, x, v)
        set_acceleration(x, v, t, p, a)
        return np.concatenate([v, a])

    y0 = np.concatenate([net.x0.ravel(), np.zeros(size) if v0 is None else v0.ravel()])
    y = solve_ivp(slope, (0.0, seconds), y0, "DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    x, v = y[:size].copy(), y[size:].copy()
    pins(seconds, x, v)
    return x.reshape(net.x0.shape), v.reshape(net.x0.shape)


def integrated(net: Net, name: str, seconds: float, steps: int, v0=None, *, with_account: bool = False) -> State:
    """`net` after `seconds` [s], in `steps` equal steps; velocities brought to the same time as positions."""
    state = State.at_rest(net)
    if v0 is not None:
        state.v[:] = v0
    advance(net, state, INTEGRATORS[name], seconds / steps, steps, with_account=with_account)
    v = velocities(net, state)
    state.v, state.lag = v, 0.0
    return state


def slope(steps, errors) -> float:
    """Observed order: minus the slope of log(error) over log(steps)."""
    return -float(np.polyfit(np.log(steps), np.log(errors), 1)[0])
