"""The points of lines under water: masses in water, and nodes that bodies carry.

Of nets a mass is a number. A node moves the water around it, differently along and across its line, so that its mass is
a matrix:

  m + m_w [C_an (1 - q q^T) + C_at q q^T] over the parts of the node, q their unit tangents

with m_w the mass of the water that a part displaces. A node that a body carries follows the six motions of the body.
"""

import math

from sim.jit import kernel
from sim.springs.pins import set_paths
from sim.springs.points.arrays import span
from sim.springs.points.each_link import TINY
from sim.springs.points.line_arrays import INVERSE_MASS, INVERSE_ROOT, MASS_ROOT, PLACE


@kernel(inline=True)
def six(y, n, j):
    """Displacement and rotation of the body with its two points from j on."""
    k = j + 1
    return y[j], y[n + j], y[2 * n + j], y[k], y[n + k], y[2 * n + k]


@kernel(inline=True)
def set_six(y, n, j, q):
    """Set the six numbers of the body with its two points from j on."""
    k = j + 1
    y[j], y[n + j], y[2 * n + j], y[k], y[n + k], y[2 * n + k] = q


@kernel(inline=True)
def add_six(y, n, j, d):
    """Add to the six numbers of the body with its two points from j on."""
    q = six(y, n, j)
    set_six(y, n, j, (q[0] + d[0], q[1] + d[1], q[2] + d[2], q[3] + d[3], q[4] + d[4], q[5] + d[5]))


@kernel(allocates=False)
def matrix_times(m, body, start, q):
    """A (6, 6) matrix of a body's row in m, from column `start`, times six numbers."""
    s0 = s1 = s2 = s3 = s4 = s5 = 0.0
    for k in range(6):
        u = q[k]
        s0 += m[body, start + k] * u
        s1 += m[body, start + 6 + k] * u
        s2 += m[body, start + 12 + k] * u
        s3 += m[body, start + 18 + k] * u
        s4 += m[body, start + 24 + k] * u
        s5 += m[body, start + 30 + k] * u
    return s0, s1, s2, s3, s4, s5


@kernel(inline=True)
def half_form(p, b, start, q):
    """1/2 q M q of a body's matrix."""
    m = matrix_times(p.bodies, b, start, q)
    return 0.5 * (q[0] * m[0] + q[1] * m[1] + q[2] * m[2] + q[3] * m[3] + q[4] * m[4] + q[5] * m[5])


@kernel(inline=True)
def carried_motion(p, i, q):
    """Motion of fairlead i by its body's displacement (x, y, z) and small rotation (a, b, c): r + theta x arm."""
    x, y, z, a, b, c = q
    ax, ay, az = p.arms[i, 0], p.arms[i, 1], p.arms[i, 2]
    return x + b * az - c * ay, y + c * ax - a * az, z + a * ay - b * ax


@kernel(inline=True)
def moment_of(p, i, fx, fy, fz):
    """Moment [N m] of a force at fairlead i about its body's reference point."""
    ax, ay, az = p.arms[i, 0], p.arms[i, 1], p.arms[i, 2]
    return ay * fz - az * fy, az * fx - ax * fz, ax * fy - ay * fx


@kernel(inline=True)
def pushed_body(p, i, fx, fy, fz):
    """The six accelerations of a body by a force at its fairlead i."""
    mx, my, mz = moment_of(p, i, fx, fy, fz)
    return matrix_times(p.bodies, p.carried[i, 1], INVERSE_MASS, (fx, fy, fz, mx, my, mz))


@kernel(inline=True)
def set_carried(y, p):
    """Set the rows of y (3 n,), velocities or accelerations, of points that bodies carry."""
    n = p.cols
    for i in range(p.carried.shape[0]):
        j = p.carried[i, 0]
        y[j], y[n + j], y[2 * n + j] = carried_motion(p, i, six(y, n, p.nodes + 2 * p.carried[i, 1]))


@kernel(inline=True)
def tangent_at(x, p, i):
    """Unit vector along the line at part i, zero where its neighbours coincide."""
    rx, ry, rz = span(x, p.cols, p.places[i, 1], p.places[i, 2])
    over = 1.0 / math.sqrt(rx * rx + ry * ry + rz * rz + TINY)
    return over * rx, over * ry, over * rz


@kernel(noalias=True, allocates=False)
def set_inverse_masses(x, p):
    """Set `p.inertia`, the inverse mass matrix of every node with that of the water; 0 where prescribed.

    A node that a body carries has J M^-1 J^T of the body, with J its motion by the body's.
    """
    n, w = p.cols, p.inertia
    for j in range(n):
        w[j] = w[3 * n + j] = w[5 * n + j] = p.mass[j]
        w[n + j] = w[2 * n + j] = w[4 * n + j] = 0.0
    for i in range(p.places.shape[0]):
        j = p.places[i, 0]
        qx, qy, qz = tangent_at(x, p, i)
        across = p.parts[i].displaced * p.parts[i].added_across
        s = p.parts[i].displaced * p.parts[i].added_along - across
        w[j] += across + s * qx * qx
        w[n + j] += s * qx * qy
        w[2 * n + j] += s * qx * qz
        w[3 * n + j] += across + s * qy * qy
        w[4 * n + j] += s * qy * qz
        w[5 * n + j] += across + s * qz * qz
    for j in range(p.nodes):
        if p.inverse_masses[j] == 0.0:
            for e in range(6):
                w[e * n + j] = 0.0
            continue
        xx, xy, xz = w[j], w[n + j], w[2 * n + j]
        yy, yz, zz = w[3 * n + j], w[4 * n + j], w[5 * n + j]
        a, b, c = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
        over = 1.0 / (xx * a + xy * b + xz * c)
        w[j], w[n + j], w[2 * n + j] = over * a, over * b, over * c
        w[3 * n + j], w[4 * n + j] = over * (xx * zz - xz * xz), over * (xy * xz - xx * yz)
        w[5 * n + j] = over * (xx * yy - xy * xy)
    for i in range(p.carried.shape[0]):
        set_carried_mass(p, i)


@kernel(allocates=False)
def set_carried_mass(p, i):
    """Set the inverse mass matrix of the node of fairlead i."""
    n, j = p.cols, p.carried[i, 0]
    row = 0
    for e in range(3):
        # M^-1 J^T of a unit force along axis e, then J of it.
        ux, uy, uz = 1.0 if e == 0 else 0.0, 1.0 if e == 1 else 0.0, 1.0 if e == 2 else 0.0
        moved = carried_motion(p, i, pushed_body(p, i, ux, uy, uz))
        for d in range(e, 3):
            p.inertia[row * n + j] = moved[d]
            row += 1


@kernel(inline=True)
def symmetric_times(m, n, j, x, y, z):
    """The symmetric matrix of point j, six numbers in m (6 n,), times (x, y, z)."""
    xy, xz, yz = m[n + j], m[2 * n + j], m[4 * n + j]
    return m[j] * x + xy * y + xz * z, xy * x + m[3 * n + j] * y + yz * z, xz * x + yz * y + m[5 * n + j] * z


@kernel(inline=True)
def over_mass(p, j, x, y, z):
    """M^-1 (x, y, z) of node j, by `p.inertia`."""
    return symmetric_times(p.inertia, p.cols, j, x, y, z)


@kernel(inline=True)
def mobility(p, j, x, y, z):
    """e M^-1 e of node j along the unit vector (x, y, z) [1/kg]."""
    a, b, c = over_mass(p, j, x, y, z)
    return a * x + b * y + c * z


@kernel(allocates=False)
def kick(p, v, j, fx, fy, fz):
    """Change the velocities by an impulse [N s] at node j; if a body carries the node, it acts on the body."""
    n = p.cols
    if p.inverse_masses[j] > 0.0:
        dx, dy, dz = over_mass(p, j, fx, fy, fz)
        v[j] += dx
        v[n + j] += dy
        v[2 * n + j] += dz
        return
    for i in range(p.carried.shape[0]):
        if p.carried[i, 0] == j:
            at = p.nodes + 2 * p.carried[i, 1]
            add_six(v, n, at, pushed_body(p, i, fx, fy, fz))
            set_carried(v, p)
            return


@kernel(noalias=True, allocates=False)
def add_carried(f, p):
    """Add the forces [N] on the nodes that bodies carry to the forces and moments on the bodies."""
    n = p.cols
    for i in range(p.carried.shape[0]):
        c = p.carried[i, 0]
        fx, fy, fz = f[c], f[n + c], f[2 * n + c]
        mx, my, mz = moment_of(p, i, fx, fy, fz)
        add_six(f, n, p.nodes + 2 * p.carried[i, 1], (fx, fy, fz, mx, my, mz))


@kernel(noalias=True, allocates=False)
def accelerate_masses(p, a):
    """Turn the forces a (3 n,) [N] into accelerations, 0 where prescribed, by the masses of `set_inverse_masses`."""
    n = p.cols
    add_carried(a, p)
    for j in range(p.nodes):
        a[j], a[n + j], a[2 * n + j] = over_mass(p, j, a[j], a[n + j], a[2 * n + j])
    for b in range(p.bodies.shape[0]):
        j = p.nodes + 2 * b
        set_six(a, n, j, matrix_times(p.bodies, b, INVERSE_MASS, six(a, n, j)))
    set_carried(a, p)


@kernel(inline=True)
def root_of_mobility(p, j):
    """The lower triangle L with L L^T = M^-1 of node j, by `p.inertia`; zeros where the motion is prescribed."""
    n, w = p.cols, p.inertia
    if p.inverse_masses[j] == 0.0:  # the node of a fairlead has the mobility of its body there
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    xx = math.sqrt(w[j])
    xy, xz = w[n + j] / xx, w[2 * n + j] / xx
    yy = math.sqrt(w[3 * n + j] - xy * xy)
    yz = (w[4 * n + j] - xy * xz) / yy
    return xx, xy, xz, yy, yz, math.sqrt(w[5 * n + j] - xz * xz - yz * yz)


@kernel(noalias=True, allocates=False)
def set_root_motion(y, p, out):
    """out = L y (3 n,) with L L^T = M^-1: motions of unit mass as those of nodes and bodies, carried nodes included."""
    n = p.cols
    for j in range(p.nodes):
        xx, xy, xz, yy, yz, zz = root_of_mobility(p, j)
        a, b, c = y[j], y[n + j], y[2 * n + j]
        out[j], out[n + j], out[2 * n + j] = xx * a, xy * a + yy * b, xz * a + yz * b + zz * c
    for b in range(p.bodies.shape[0]):
        j = p.nodes + 2 * b
        set_six(out, n, j, matrix_times(p.bodies, b, MASS_ROOT, six(y, n, j)))
    set_carried(out, p)


@kernel(noalias=True, allocates=False)
def turn_to_root_forces(f, p):
    """f = L^T f (3 n,) of forces, with the L of `set_root_motion`."""
    n = p.cols
    add_carried(f, p)
    for j in range(p.nodes):
        xx, xy, xz, yy, yz, zz = root_of_mobility(p, j)
        a, b, c = f[j], f[n + j], f[2 * n + j]
        f[j], f[n + j], f[2 * n + j] = xx * a + xy * b + xz * c, yy * b + yz * c, zz * c
    for b in range(p.bodies.shape[0]):
        j = p.nodes + 2 * b
        moved = matrix_times(p.bodies, b, INVERSE_MASS, six(f, n, j))
        set_six(f, n, j, matrix_times(p.bodies, b, INVERSE_ROOT, moved))


@kernel(inline=True)
def set_line_pins(x, v, t, p):
    """Put moved nodes where their paths are at time t, and carried ones where their body is."""
    set_paths(x, v, t, p)
    n = p.cols
    for i in range(p.carried.shape[0]):
        j, b = p.carried[i, 0], p.carried[i, 1]
        dx, dy, dz = carried_motion(p, i, six(x, n, p.nodes + 2 * b))
        x[j] = p.bodies[b, PLACE] + p.arms[i, 0] + dx
        x[n + j] = p.bodies[b, PLACE + 1] + p.arms[i, 1] + dy
        x[2 * n + j] = p.bodies[b, PLACE + 2] + p.arms[i, 2] + dz
    set_carried(v, p)
