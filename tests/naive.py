"""Slow, obvious references: the forces of a net, particle by particle and link by link, straight from the formulas."""

import itertools
import math

import numpy as np

from sim.springs.laws.slack import Slack
from sim.springs.laws.stiffening import Stiffening
from sim.springs.points.cells import faces


def neighbours(net):
    """((i, j), (i', j'), family) of every link; those along a side have their part of the family's numbers."""
    rows, cols = net.shape
    for family in net.families:
        for i in range(rows):
            for j in range(cols):
                a, b = i + family.di, j + family.dj
                if 0 <= a < rows and 0 <= b < cols:
                    on_side = (i == a and i in (0, rows - 1)) or (j == b and j in (0, cols - 1))
                    ratio = net.side_ratio if on_side else 1.0
                    own = family._replace(stiffness=ratio * family.stiffness, damping=ratio * family.damping)
                    yield (i, j), (a, b), own


def tension(net, family, length):
    """[N] of a link of a length [m]."""
    stretch = length - family.rest
    if isinstance(net.law, Slack):
        stretch = max(0.0, stretch)
    cubic = net.law.cubic * (stretch / family.rest) ** 2 if isinstance(net.law, Stiffening) else 0.0
    return family.stiffness * stretch * (1.0 + cubic)


def link_force(net, family, r, vr):
    """Force [N] on the first end of a link that spans r [m] and opens at vr [m/s]: lab eq. 4."""
    length = math.sqrt(r @ r)
    n = r / length
    if net.damping_model == "axial":
        vr = (vr @ n) * n
    damping, pull, rate = family.damping, tension(net, family, length), vr @ n
    if isinstance(net.law, Slack):
        if length <= family.rest:
            damping = 0.0
        elif pull + damping * rate < 0.0:
            damping = pull / -rate
    return pull * n + damping * vr


def surfaces(net, x, t):
    """(depth, normal, surface velocity, is the sphere) of every surface that a point at x touches by itself."""
    if net.floor is not None and x[2] < net.floor + net.radius:
        yield net.floor + net.radius - x[2], np.array([0.0, 0.0, 1.0]), np.zeros(3), False
    if net.sphere is not None and not net.links_touch:
        yield from on_sphere(net, x, t)


def on_sphere(net, x, t):
    """The same for the sphere alone, of any place x."""
    velocity = np.array(net.sphere_velocity)
    offset = x - (np.array(net.sphere[:3]) + (t - net.epoch) * velocity)
    distance = math.sqrt(offset @ offset)
    if distance < net.sphere[3] + net.radius:
        yield net.sphere[3] + net.radius - distance, offset / distance, velocity, True


def nearest_part(a, b, centre):
    """Part of the link from a to b before its place that is nearest to the centre."""
    r = b - a
    return min(1.0, max(0.0, (centre - a) @ r / (r @ r)))


def link_touches(net, xs, vs, t):
    """(a, b, s, force, elastic force, slip) of every link that touches the sphere a part s of it from a."""
    if not net.links_touch:
        return
    centre = np.array(net.sphere[:3]) + (t - net.epoch) * np.array(net.sphere_velocity)
    for a, b, _ in neighbours(net):
        s = nearest_part(xs[a], xs[b], centre)
        for depth, normal, velocity, _ in on_sphere(net, (1.0 - s) * xs[a] + s * xs[b], t):
            slip = (1.0 - s) * vs[a] + s * vs[b] - velocity
            yield a, b, s, contact_force(net, depth, normal, slip, True), net.contact.stiffness * depth * normal, slip


def nearest_on_face(corners, centre):
    """Parts (3,) of the place of a triangle that is nearest to the centre: on its plane, if inside, or on a side."""
    first, *others = corners
    sides = np.column_stack([one - first for one in others])
    inner = np.linalg.lstsq(sides, centre - first)[0]
    if (inner >= 0.0).all() and inner.sum() <= 1.0:
        return np.array([1.0 - inner.sum(), *inner])
    found = []
    for i, j in ((0, 1), (1, 2), (2, 0)):
        s = nearest_part(corners[i], corners[j], centre)
        parts = np.zeros(3)
        parts[i], parts[j] = 1.0 - s, s
        found.append(parts)
    return min(found, key=lambda parts: np.linalg.norm(parts @ corners - centre))


def face_touches(net, xs, vs, t):
    """(corners, parts, force, elastic force, slip) of every face of a cloth that touches the sphere.

    Faces touch one that is smaller by a twentieth of the radius, half as stiff as a point.
    """
    if not net.faces_touch:
        return
    rows, cols = net.shape
    centre = np.array(net.sphere[:3]) + (t - net.epoch) * np.array(net.sphere_velocity)
    for corners in faces(rows, cols):
        corners = [divmod(int(corner), cols) for corner in corners]
        parts = nearest_on_face(np.array([xs[corner] for corner in corners]), centre)
        place, motion = (sum(s * y[c] for s, c in zip(parts, corners, strict=True)) for y in (xs, vs))
        for depth, normal, velocity, _ in on_sphere(net, place, t):
            depth -= 0.05 * (net.sphere[3] + net.radius)
            if depth > 0.0:
                force = 0.5 * contact_force(net, depth, normal, motion - velocity, True)
                yield corners, parts, force, 0.5 * net.contact.stiffness * depth * normal, motion - velocity


def contact_force(net, depth, normal, vr, on_sphere):
    """Force [N] on a touching point that moves at vr relative to the surface, without friction."""
    law = net.contact
    if law.law == "lab":
        return law.stiffness * depth * normal - law.damping * (depth if on_sphere else 1.0) * vr
    vn = vr @ normal
    return max(0.0, law.stiffness * depth - law.damping * vn) * normal


def loads(net, xs, vs, t):
    """{(i, j): [(force, surface velocity)]} of the points that floor and sphere press, by their links or faces too."""
    found = {}
    for i, j in itertools.product(*map(range, net.shape)):
        found[i, j] = [
            (contact_force(net, depth, normal, vs[i, j] - velocity, on_sphere), velocity)
            for depth, normal, velocity, on_sphere in surfaces(net, xs[i, j], t)
            if not (on_sphere and net.faces_touch)
        ]
    shares = {}
    for a, b, s, force, _, _ in link_touches(net, xs, vs, t):
        for end, share in ((a, 1.0 - s), (b, s)):
            shares[end] = shares.get(end, 0.0) + share * force
    for corners, parts, force, _, _ in face_touches(net, xs, vs, t):
        for corner, part in zip(corners, parts, strict=True):
            if part > 1e-14:
                shares[corner] = shares.get(corner, 0.0) + part * force
    if net.faces_touch:  # one force of the sphere on a point, with its own
        for i, j in itertools.product(*map(range, net.shape)):
            for depth, normal, velocity, _ in on_sphere(net, xs[i, j], t):
                own = contact_force(net, depth, normal, vs[i, j] - velocity, True)
                shares[i, j] = shares.get((i, j), 0.0) + own
    for end, force in shares.items():
        found[end].append((force, np.array(net.sphere_velocity)))
    return found


def friction(net, mass, force, vr, others, h):
    """Friction [N] on a point at vr relative to a surface that presses it, under the sum of all other forces [N].

    It stops the point within a step of h [s] if mu N is enough. It acts along the velocity of a point that it cannot
    stop within two steps, with a continuous change between.
    """
    if net.contact.law == "lab" or net.contact.friction == 0.0:
        return np.zeros(3)
    push = np.linalg.norm(force)
    if push == 0.0:
        return np.zeros(3)
    most, normal = net.contact.friction * push, force / push
    across = np.eye(3) - np.outer(normal, normal)
    slide, pull = mass / h * across @ vr, across @ others
    needed = slide + min(1.0, max(0.0, 2.0 - np.linalg.norm(slide) / most)) * pull
    return -needed * min(1.0, most / max(np.linalg.norm(needed), 1e-300))


def grab_force(grab, x, v):
    pull = np.array(grab.target) - x
    distance = math.sqrt(pull @ pull)
    spring = min(grab.stiffness * distance, grab.max_force)
    return (spring / distance) * pull - grab.damping * v if distance > 0.0 else -grab.damping * v


def own_contacts(net, xs, vs):
    """(a, b, force on b) of particles nearer than the thickness; those up to two rows and columns apart never
    push, and those with less than half a circle of cloth between them."""
    if net.is_chain:
        return
    rows, cols = net.shape
    row, col = (next((f.rest for f in net.families if f[:2] == link), math.inf) for link in ((1, 0), (0, 1)))
    particles = [(i, j) for i in range(rows) for j in range(cols)]
    for a, b in itertools.combinations(particles, 2):
        r = xs[b] - xs[a]
        distance = math.sqrt(r @ r)
        down, across = abs(a[0] - b[0]), abs(a[1] - b[1])
        cloth = math.hypot(down and down * row, across and across * col)
        if (down > 2 or across > 2) and cloth >= math.pi / 2 * net.thickness and distance < net.thickness:
            n = r / distance
            depth, opening = net.thickness - distance, (vs[b] - vs[a]) @ n
            yield a, b, max(0.0, net.contact.stiffness * depth - net.contact.damping * opening) * n


def nearest_places(a, b, c, d):
    """Parts (s, t) of the links from a to b and from c to d before their places that are nearest to each other.

    The least distance is between two inner places, or an end of a link and the nearest place on the other.
    """
    found = [(s, nearest_part(c, d, a + s * (b - a))) for s in (0.0, 1.0)]
    found += [(nearest_part(a, b, c + t * (d - c)), t) for t in (0.0, 1.0)]
    inner = np.linalg.lstsq(np.column_stack([b - a, c - d]), c - a)[0]
    found += [tuple(inner)] if (inner >= 0.0).all() and (inner <= 1.0).all() else []
    return min(found, key=lambda parts: np.linalg.norm(c + parts[1] * (d - c) - a - parts[0] * (b - a)))


def strand_touches(net, xs, vs):
    """({particle: share of the force}, force) of two links of a chain that are nearer than the thickness, but for those
    with less than half a circle of rope between them."""
    if not net.is_chain or net.thickness == 0.0:
        return
    points = sorted(itertools.product(*map(range, net.shape)))
    for i, j in itertools.combinations(range(len(points) - 1), 2):
        if j - i < 2 or (j - i - 1) * net.families[0].rest < math.pi / 2 * net.thickness:
            continue
        a, b, c, d = points[i], points[i + 1], points[j], points[j + 1]
        s, t = nearest_places(xs[a], xs[b], xs[c], xs[d])
        shares = {a: s - 1.0, b: -s, c: 1.0 - t, d: t}
        r = np.sum([share * xs[point] for point, share in shares.items()], axis=0)
        depth = net.thickness - np.linalg.norm(r)
        if depth > 0.0:
            n = r / np.linalg.norm(r)
            opening = np.sum([share * vs[point] for point, share in shares.items()], axis=0) @ n
            yield shares, max(0.0, net.contact.stiffness * depth - net.contact.damping * opening) * n


def acceleration(net, x, v, t=0.0, h=1.0):
    """Accelerations (3, rows, cols) [m/s^2]; h [s] is the step of friction."""
    rows, cols = net.shape
    force = np.zeros((rows, cols, 3))
    xs, vs = np.moveaxis(x, 0, -1), np.moveaxis(v, 0, -1)
    for a, b, family in neighbours(net):
        f = link_force(net, family, xs[b] - xs[a], vs[b] - vs[a])
        force[a] += f
        force[b] -= f
    for a, b, f in own_contacts(net, xs, vs):
        force[a] -= f
        force[b] += f
    for shares, f in strand_touches(net, xs, vs):
        for point, share in shares.items():
            force[point] += share * f
    pressed = loads(net, xs, vs, t)
    for i in range(rows):
        for j in range(cols):
            force[i, j] += net.masses[i, j] * np.array(net.gravity) - net.drag * vs[i, j]
            for load, _ in pressed[i, j]:
                force[i, j] += load
            if net.grab is not None and (i, j) == (net.grab.row, net.grab.col):
                force[i, j] += grab_force(net.grab, xs[i, j], vs[i, j])
            for load, velocity in pressed[i, j]:
                force[i, j] += friction(net, net.masses[i, j], load, vs[i, j] - velocity, force[i, j], h)
            if (i, j) in net.pinned:
                force[i, j] = 0.0
    return np.moveaxis(force / net.masses[..., None], -1, 0)


def tangent(net, x, t=0.0):
    """M^-1/2 K M^-1/2 and the same of D, (3 rows cols, 3 rows cols), about x at rest, by central differences."""
    size = x.size
    stiffness, damping = np.zeros((2, size, size))
    still = np.zeros_like(x)
    for j in range(size):
        _, row, col = np.unravel_index(j, x.shape)
        if (int(row), int(col)) in net.pinned:
            continue
        e = np.zeros(size)
        e[j] = 1e-6
        e = e.reshape(x.shape)
        stiffness[:, j] = (acceleration(net, x - e, still, t) - acceleration(net, x + e, still, t)).ravel() / 2e-6
        damping[:, j] = (acceleration(net, x, still - e, t) - acceleration(net, x, still + e, t)).ravel() / 2e-6
    root = np.sqrt(np.tile(net.masses.ravel(), 3))
    scale = root[:, None] / root
    return stiffness * scale, damping * scale
