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
def neighbours(i, n):
    """i - 2, i - 1, i + 1, i + 2 on a circle of n."""
    a, b, c, d = i - 2, i - 1, i + 1, i + 2
    return a + n if a < 0 else a, b + n if b < 0 else b, c - n if c >= n else c, d - n if d >= n else d


@kernel(noalias=True)
def set_mesh(height, dx, dy, choppy, scale, stride, cell, threshold, soft, fade, vertices, slopes, foam):
    """Set the mesh and fade its foam; returns (share of the mesh that is foam, rms of J - 1).

    height, dx, dy: (n, n) [m], dx and dy unread unless `choppy`; scale: factor on the height; cell [m] of the grid.
    foam: (n/stride, n/stride), 0 to 1, kept from the last frame: times `fade`, and at least (threshold - J)/soft.
    Differences are (8 (f1 - f-1) - (f2 - f-2))/12 per cell.
    """
    inverse, n = 1.0 / (12.0 * cell), height.shape[0]
    foamy, strain = 0.0, 0.0
    for i in range(vertices.shape[0]):
        p = i * stride
        p_2, p_1, p1, p2 = neighbours(p, n)
        for j in range(vertices.shape[1]):
            q = j * stride
            q_2, q_1, q1, q2 = neighbours(q, n)
            h = height
            z = scale * h[p, q]
            zx = scale * inverse * (8.0 * (h[p1, q] - h[p_1, q]) - (h[p2, q] - h[p_2, q]))
            zy = scale * inverse * (8.0 * (h[p, q1] - h[p, q_1]) - (h[p, q2] - h[p, q_2]))
            x, y, J = p * cell, q * cell, 1.0
            if choppy:
                x += dx[p, q]
                y += dy[p, q]
                a = 1.0 + inverse * (8.0 * (dx[p1, q] - dx[p_1, q]) - (dx[p2, q] - dx[p_2, q]))
                b = inverse * (8.0 * (dx[p, q1] - dx[p, q_1]) - (dx[p, q2] - dx[p, q_2]))
                d = 1.0 + inverse * (8.0 * (dy[p, q1] - dy[p, q_1]) - (dy[p, q2] - dy[p, q_2]))
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
