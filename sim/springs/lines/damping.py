"""All damping of lines for a time, for methods that split it off: links, drag, bed and bodies, each exact on its own.

A link's damping acts on two nodes, drag and bed on one, with the inverse masses at the place where the step is: so
damping limits no step. In reverse order the parts undo their order, as a symmetric composition asks.
"""

import math

import numpy as np

from sim.jit import kernel
from sim.springs.lines.arrays import BED_AREA, DECAY_PARTS, DECAY_RATES, DECAY_SHAPES, DRAG_ACROSS, DRAG_ALONG
from sim.springs.lines.forces import (
    damping_of,
    lines_scratch_size,
    matrix_times,
    over_mass,
    pushed_body,
    rate_of,
    set_carried,
    set_inverse_masses,
    set_six,
    six,
    span_of,
    submerged,
    tangent_at,
    water_at,
)


@kernel(allocates=False)
def push_node(v, p, f, j, fx, fy, fz):
    """An impulse [N s] at node j; a body takes it where it carries the node."""
    n = p.cols
    if p.inverse_masses[j] > 0.0:
        dx, dy, dz = over_mass(f, n, j, fx, fy, fz)
        v[j] += dx
        v[n + j] += dy
        v[2 * n + j] += dz
        return
    for i in range(p.carried.shape[0]):
        if p.carried[i, 0] != j:
            continue
        at = p.nodes + 2 * p.carried[i, 1]
        d, q = pushed_body(p, i, fx, fy, fz), six(v, n, at)
        set_six(v, n, at, (q[0] + d[0], q[1] + d[1], q[2] + d[2], q[3] + d[3], q[4] + d[4], q[5] + d[5]))
        set_carried(v, p)
        return


@kernel(inline=True)
def mobility(p, f, j, x, y, z):
    """e M^-1 e of node j along the unit vector (x, y, z) [1/kg]."""
    a, b, c = over_mass(f, p.cols, j, x, y, z)
    return a * x + b * y + c * z


@kernel(allocates=False)
def damp_link(x, v, s, p, f, q):
    """The damping of link q for a time s [s]: its two nodes' closing speed decays exponentially."""
    a, b = p.ends[q, 0], p.ends[q, 1]
    rx, ry, rz, length = span_of(x, p, q)
    damping, rate = damping_of(p, q, length), rate_of(v, p, q, rx, ry, rz, length)
    rx, ry, rz = rx / length, ry / length, rz / length
    both = mobility(p, f, a, rx, ry, rz) + mobility(p, f, b, rx, ry, rz)
    if both == 0.0 or damping == 0.0:
        return
    push = -math.expm1(-damping * both * s) / both * rate
    push_node(v, p, f, a, push * rx, push * ry, push * rz)
    push_node(v, p, f, b, -push * rx, -push * ry, -push * rz)


@kernel(allocates=False)
def drag_along(v, s, p, f, j, drag, x, y, z):
    """Quadratic drag against the relative velocity (x, y, z) of node j for a time s: |w| falls as w/(1 + D w s/m)."""
    speed = math.sqrt(x * x + y * y + z * z)
    if speed == 0.0 or drag == 0.0:
        return
    x, y, z = x / speed, y / speed, z / speed
    over = mobility(p, f, j, x, y, z)
    push = drag * speed * speed * s / (1.0 + drag * over * speed * s)
    push_node(v, p, f, j, push * x, push * y, push * z)


@kernel(allocates=False)
def damp_part(x, v, t, s, p, f, i, reverse):
    """Drag across and along part i."""
    n, j = p.cols, p.places[i, 0]
    qx, qy, qz = tangent_at(x, p, i)
    u, w, c, _, _, _, z = water_at(x, t, p, j)
    wet = submerged(p, i, z)
    for turn in range(2):
        rx, ry, rz = u - v[j], w - v[n + j], c - v[2 * n + j]
        along = rx * qx + ry * qy + rz * qz
        if (turn == 0) != reverse:
            drag_along(v, s, p, f, j, wet * p.parts[i, DRAG_ACROSS], rx - along * qx, ry - along * qy, rz - along * qz)
        else:
            drag_along(v, s, p, f, j, wet * p.parts[i, DRAG_ALONG], along * qx, along * qy, along * qz)


@kernel(allocates=False)
def damp_on_bed(x, v, s, p, f, i):
    """The bed's damping and friction on part i."""
    n, j = p.cols, p.places[i, 0]
    depth = p.bed - x[2 * n + j]
    if depth <= 0.0:
        return
    area = p.parts[i, BED_AREA]
    over = mobility(p, f, j, 0.0, 0.0, 1.0)
    if over > 0.0:
        push = math.expm1(-area * p.bed_damping * over * s) / over * v[2 * n + j]
        push_node(v, p, f, j, 0.0, 0.0, push)
    speed = math.sqrt(v[j] * v[j] + v[n + j] * v[n + j])
    if p.friction > 0.0 and speed > 0.0:
        ex, ey = v[j] / speed, v[n + j] / speed
        over = mobility(p, f, j, ex, ey, 0.0)
        if over > 0.0:
            push = min(p.friction * area * p.bed_stiffness * depth * s, speed / over)
            push_node(v, p, f, j, -push * ex, -push * ey, 0.0)


@kernel(allocates=False)
def damp_body(v, decay, p, b):
    """A body's linear damping: its six velocities times exp(-M^-1 B s), which row b of `decay` holds."""
    n, j = p.cols, p.nodes + 2 * b
    set_six(v, n, j, matrix_times(decay, b, 0, *six(v, n, j)))
    set_carried(v, p)


@kernel
def damp_lines(x, v, t, s, decay, p, reverse):
    """All damping for a time s [s], with decay = make_lines_decay(p, s); `reverse` runs through it backwards.

    Returns 0: there is no sphere to do work.
    """
    f = np.empty(lines_scratch_size(p))
    set_inverse_masses(x, p, f)
    links, parts, bodies = p.ends.shape[0], p.places.shape[0], p.bodies.shape[0]
    for turn in range(4):
        kind = 3 - turn if reverse else turn
        count = links if kind == 0 else bodies if kind == 3 else parts
        for step in range(count):
            i = count - 1 - step if reverse else step
            if kind == 0:
                damp_link(x, v, s, p, f, i)
            elif kind == 1:
                damp_part(x, v, t, s, p, f, i, reverse)
            elif kind == 2:
                damp_on_bed(x, v, s, p, f, i)
            else:
                damp_body(v, decay, p, i)
    return 0.0


@kernel
def make_lines_decay(p, s):
    """exp(-M^-1 B s) (bodies, 36) of each body. Of nodes nothing is known: masses in water change with the tangents."""
    found = np.zeros((p.bodies.shape[0], 36))
    for b in range(p.bodies.shape[0]):
        row = p.bodies[b]
        for k in range(6):
            keep = math.exp(-row[DECAY_RATES + k] * s)
            for i in range(6):
                for j in range(6):
                    found[b, 6 * i + j] += row[DECAY_SHAPES + 6 * i + k] * keep * row[DECAY_PARTS + 6 * k + j]
    return found
