"""Prescribed motion of pins."""

from sim.jit import kernel


@kernel(inline=True)
def set_paths(x, v, t, p):
    """Put moved pins where their paths are at time t, with their paths' velocity."""
    n = p.rows * p.cols
    for q in range(p.pins.shape[0]):
        s = t - p.paths[q, 4, 0]
        for e in range(3):
            c0, c1, c2, c3 = p.paths[q, 0, e], p.paths[q, 1, e], p.paths[q, 2, e], p.paths[q, 3, e]
            x[e * n + p.pins[q]] = c0 + s * (c1 + s * (c2 + s * c3))
            v[e * n + p.pins[q]] = c1 + s * (2.0 * c2 + s * 3.0 * c3)
