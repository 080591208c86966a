"""Rest state of a net, floor and sphere included, found by letting it fall."""

import dataclasses

import numpy as np
from numpy.typing import NDArray

from sim.springs.integrators.leapfrog import RECORD as LEAPFROG
from sim.springs.laws import largest_stiffness
from sim.springs.net import Net
from sim.springs.stability import gershgorin
from sim.springs.state import State, advance, energy
from sim.springs.statics import hanging_chain
from sim.validation import ConvergenceError

LOOKS, STEPS = 20_000, 20  # most looks, and steps between two
REST_ENERGY_SHARE = 1e-16  # kinetic energy of a peak, over the potential's, at which it rests


def find_rest_positions(net: Net, x: NDArray[np.float64] | None = None) -> NDArray[np.float64]:
    """Positions (3, rows, cols) [m] of `net` at rest, from x (None: x0), its pins, sphere and hands held still.

    Dynamic relaxation with kinetic damping: whenever the kinetic energy has passed a peak, a minimum of the potential
    is near, and everything stops there (Cundall 1976; Barnes 1988). Undamped, so that there is only a step to choose.
    A rope that hangs free is where `hanging_chain` says, exactly. Raises ConvergenceError.
    """
    if net.is_rope and net.sphere is None and net.pinned == {(0, 0)}:
        hanging = hanging_chain(net).x
        if net.floor is None or hanging[:, 2].min() > net.floor + net.radius:
            return np.ascontiguousarray(hanging.T[:, None, :])
    still = dataclasses.replace(
        net,
        families=tuple(f._replace(damping=0.0) for f in net.families),
        drag=0.0,
        contact=net.contact._replace(damping=0.0, friction=0.0),
        sphere_velocity=(0.0, 0.0, 0.0),
        pin_paths=(),
        grab=None,
    )
    state = State.at_rest(still)
    state.x[:] = net.x0 if x is None else x
    fastest, _ = gershgorin(still)
    if fastest == 0.0:
        return state.x
    h, before = 1.0 / fastest, 0.0
    stiffens = largest_stiffness(net.law, -0.5, 1.0) > largest_stiffness(net.law, 0.0, 0.0)
    for _ in range(LOOKS):
        last = state.copy()
        advance(still, state, LEAPFROG, h, STEPS)
        if stiffens:
            with np.errstate(over="ignore", invalid="ignore"):
                longest = 1.0 / gershgorin(still, state.x)[0]
            # Where links became too stiff for the step on the way, the same again in shorter ones.
            if not (state.is_bounded and h < 2.0 * longest):
                state, h = last, 0.5 * h
                continue
            # A step that changes at each look does not keep the energy.
            if not 0.5 * longest < h < 1.25 * longest:
                h = longest
        now = energy(still, state)
        if now.kinetic < before:
            state = last  # nearer to the peak
            if before < REST_ENERGY_SHARE * max(abs(now.gravity), now.elastic, 1e-12):
                break
            state.v[:], before = 0.0, 0.0
        else:
            before = now.kinetic
    else:
        raise ConvergenceError("a state of rest", f"{max(before, energy(still, state).kinetic):.2g} J of motion", LOOKS)
    return state.x
