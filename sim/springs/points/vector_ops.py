"""Whole-state updates, loops short enough that each vectorises."""

from sim.jit import kernel


@kernel(noalias=True, inline=True)
def add_scaled(y, a, x):
    """y += a x."""
    for j in range(y.shape[0]):
        y[j] += a * x[j]


@kernel(noalias=True, inline=True)
def set_sum(out, y, a, x):
    """out = y + a x."""
    for j in range(y.shape[0]):
        out[j] = y[j] + a * x[j]
