"""The forces that keep an implicit midpoint step's energy: each link's tension is the mean of all its lengths.

Taken at the midpoint positions, a stiff link that turns by an angle in a step is pressed, cos(angle/2) of its length,
and the work that its force does is not what its spring takes up: energy grows without bound, however exactly the step
is solved (Gonzalez & Simo 1996). With its energy U and its lengths l0 before and l1 after, the force

    F = (U(l1) - U(l0))/(l1 - l0) r_m/l,  l = (l0 + l1)/2,

does the work U(l1) - U(l0) exactly, as r_m is half the sum of r before and after (LaBudde & Greenspan 1976). Of a
spring the first factor is the tension at l, and where it does not turn F is the force at the midpoint.
"""

import math

from sim.jit import kernel
from sim.springs.integrators.implicit.blocks import least_across, set_link_blocks
from sim.springs.laws import force_density, over_step
from sim.springs.points.arrays import by_net, push
from sim.springs.points.each_link import TINY, acting_damping, each_link, stretch


@kernel(inline=True)
def before_and_after(x0, x, p, link):
    """Lengths of a link before and after, and its direction after, from its start x0 and its middle x."""
    rx, ry, rz, _ = stretch(x, p, link)
    sx, sy, sz, before = stretch(x0, p, link)
    ex, ey, ez = 2.0 * rx - sx, 2.0 * ry - sy, 2.0 * rz - sz
    after = math.sqrt(ex * ex + ey * ey + ez * ez + TINY)
    return before, after, ex / after, ey / after, ez / after


@each_link(noalias=True)
def add_mean_lengths(link, x0, x, p, a):
    """a += change of the accelerations by the mean lengths at the midpoint x of a step from x0."""
    rx, ry, rz, length = stretch(x, p, link)
    before, after, _, _, _ = before_and_after(x0, x, p, link)
    s = over_step(link.law, link.stiffness, link.rest, before, after)[0]
    s -= force_density(link.law, link.stiffness, link.rest, length)
    push(p, a, link.a, s * rx, s * ry, s * rz)
    push(p, a, link.b, -s * rx, -s * ry, -s * rz)


@each_link(noalias=True)
def set_rope_mean_blocks(link, x0, x, g, p, links):
    """H = g b (I or n n^T) + g^2 [S I + 2 dS/dl1 r_m n1^T] of every link, F = S r_m and n1 its direction at the end."""
    n, j = p.cols, link.number
    rx, ry, rz, length = stretch(x, p, link)
    before, after, ex, ey, ez = before_and_after(x0, x, p, link)
    rx, ry, rz = rx / length, ry / length, rz / length
    pull, rise = over_step(link.law, link.stiffness, link.rest, before, after)
    whole, damping = g * g * pull, g * acting_damping(link, length, 0.0)
    across = max(whole, least_across(p, link.a, link.b))
    # Along the link nothing is cut off.
    along = whole - across
    if p.axial:
        along += damping
    else:
        across += damping
    s = g * g * rise * length
    links[j] = across
    links[j + n], links[j + 2 * n], links[j + 3 * n] = s * ex + along * rx, s * ey + along * ry, s * ez + along * rz
    links[j + 4 * n], links[j + 5 * n], links[j + 6 * n] = rx, ry, rz


# A net takes the symmetric blocks of the tension at the midpoint: its quasi-Newton method learns the rest.
set_net_blocks = kernel(lambda x0, x, g, p, links: set_link_blocks(x, g, p, links), inline=True)
set_mean_blocks = by_net(rope=set_rope_mean_blocks, grid=set_net_blocks)
