"""From the fields of a sea to the mesh that is drawn: positions, slopes and foam at every stride-th grid point.

Slopes and the Jacobian are fourth-order differences of the displaced grid, so that a frame costs the three transforms
of its positions, or one without choppiness, where exact derivatives would cost five more. A wave of eight cells is
1 % too flat in them, one of four 15 %.
"""

import numpy as np

from sim.jit import kernel

LEAST_STRETCH = 0.15  # Jacobian below which slopes are those at this value: a folded surface has no slope
STEEPEST = 1.5  # largest slope drawn, in magnitude


@kernel
def difference(field, i, j, di, dj):
    """Fourth-order central difference of a periodic field along (di, dj), per cell."""
    n = field.shape[0]
    a, b = (i + di) % n, (j + dj) % n
    c, d = (i - di) % n, (j - dj) % n
    e, f = (i + 2 * di) % n, (j + 2 * dj) % n
    g, h = (i - 2 * di) % n, (j - 2 * dj) % n
    return (8.0 * (field[a, b] - field[c, d]) - (field[e, f] - field[g, h])) / 12.0


@kernel
def set_mesh(height, dx, dy, choppy, scale, stride, cell, threshold, soft, fade, vertices, slopes, foam):
    """Set the mesh and fade its foam; returns (share of the mesh that is foam, rms of J - 1).

    height, dx, dy: (n, n) [m], dx and dy unread unless `choppy`; scale: factor on the height; cell [m] of the grid.
    foam: (n/stride, n/stride), 0 to 1, kept from the last frame: times `fade`, and at least (threshold - J)/soft.
    """
    inverse = 1.0 / cell
    foamy, strain = 0.0, 0.0
    for i in range(vertices.shape[0]):
        for j in range(vertices.shape[1]):
            m, n = i * stride, j * stride
            z = scale * height[m, n]
            zx = scale * inverse * difference(height, m, n, 1, 0)
            zy = scale * inverse * difference(height, m, n, 0, 1)
            x, y, J = m * cell, n * cell, 1.0
            if choppy:
                x += dx[m, n]
                y += dy[m, n]
                a = 1.0 + inverse * difference(dx, m, n, 1, 0)
                d = 1.0 + inverse * difference(dy, m, n, 0, 1)
                b = inverse * difference(dx, m, n, 0, 1)
                J = a * d - b * b
                # The slope by place: (zx, zy) by label, times the inverse of the displacement's gradient.
                J_safe = max(J, LEAST_STRETCH)
                zx, zy = (d * zx - b * zy) / J_safe, (a * zy - b * zx) / J_safe
            steep = np.sqrt(zx * zx + zy * zy)
            if steep > STEEPEST:
                zx *= STEEPEST / steep
                zy *= STEEPEST / steep
            vertices[i, j, 0], vertices[i, j, 1], vertices[i, j, 2] = x, y, z
            slopes[i, j, 0], slopes[i, j, 1] = zx, zy
            white = min(max((threshold - J) / soft, 0.0), 1.0)
            foam[i, j] = max(foam[i, j] * fade, white)
            foamy += foam[i, j]
            strain += (J - 1.0) * (J - 1.0)
    count = vertices.shape[0] * vertices.shape[1]
    return foamy / count, np.sqrt(strain / count)
