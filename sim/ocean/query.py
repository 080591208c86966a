"""Height of the displaced surface above a point: which label x has x + D(x) = X, and what height it carries.

Fixed-point steps x <- X - D(x) bring the label near (they contract only where |grad D| < 1), then Newton steps with
halving finish. Between grid points fields are bicubic (Catmull-Rom), exact at grid points; `exact` sums all waves.
"""

from typing import TYPE_CHECKING

import numpy as np

from sim.jit import kernel

if TYPE_CHECKING:
    from sim.ocean.surface import Surface

TOLERANCE = 1e-9  # share of a cell at which a label counts as found
FIXED_POINT_STEPS, NEWTON_STEPS, HALVINGS = 3, 40, 8


def query(surface: "Surface", points: np.ndarray, exact: bool) -> tuple[np.ndarray, np.ndarray]:
    """(height, residual), each (n,) [m], of the surface above points (n, 2) float64 [m]."""
    sea = surface.sea
    height, residual = np.empty(len(points)), np.empty(len(points))
    cell = sea.length / sea.size
    if exact:
        spectrum = sea.heights_spectrum(surface.t)
        find_exact(points, spectrum, 2.0 * np.pi / sea.length, surface.choppiness, cell, height, residual)
    elif surface.choppiness == 0.0:
        sample(points, surface.height, cell, height)
        residual[:] = 0.0
    else:
        D = surface.displacement
        find(points, surface.height, D[..., 0], D[..., 1], cell, height, residual)
    return height, residual


@kernel
def weights(f):
    """Catmull-Rom weights of the four neighbours at fraction f, and their derivatives."""
    w = (
        f * (-0.5 + f * (1.0 - 0.5 * f)),
        1.0 + f * f * (-2.5 + 1.5 * f),
        f * (0.5 + f * (2.0 - 1.5 * f)),
        f * f * (-0.5 + 0.5 * f),
    )
    d = (
        -0.5 + f * (2.0 - 1.5 * f),
        f * (-5.0 + 4.5 * f),
        0.5 + f * (4.0 - 4.5 * f),
        f * (-1.0 + 1.5 * f),
    )
    return w, d


@kernel
def bicubic(field, u, v):
    """(value, d/du, d/dv) of a periodic field at u, v in cells."""
    n = field.shape[0]
    i, j = int(np.floor(u)), int(np.floor(v))
    wu, du = weights(u - i)
    wv, dv = weights(v - j)
    value, by_u, by_v = 0.0, 0.0, 0.0
    for a in range(4):
        row = (i + a - 1) % n
        line, slope = 0.0, 0.0
        for b in range(4):
            f = field[row, (j + b - 1) % n]
            line += wv[b] * f
            slope += dv[b] * f
        value += wu[a] * line
        by_u += du[a] * line
        by_v += wu[a] * slope
    return value, by_u, by_v


@kernel
def sample(points, field, cell, out):
    """The field at points [m]."""
    for p in range(points.shape[0]):
        out[p] = bicubic(field, points[p, 0] / cell, points[p, 1] / cell)[0]


@kernel
def find(points, h, dx, dy, cell, height, residual):
    """Heights and residuals of all points with bicubic fields."""
    for p in range(points.shape[0]):
        X, Y = points[p, 0], points[p, 1]
        x, y = X, Y
        for _ in range(FIXED_POINT_STEPS):
            ex, ey = bicubic(dx, x / cell, y / cell)[0], bicubic(dy, x / cell, y / cell)[0]
            x, y = X - ex, Y - ey
        a, axx, axy = bicubic(dx, x / cell, y / cell)
        b, byx, byy = bicubic(dy, x / cell, y / cell)
        fx, fy = x + a - X, y + b - Y
        miss = np.hypot(fx, fy)
        for _ in range(NEWTON_STEPS):
            if miss <= TOLERANCE * cell:
                break
            sx, sy = newton_step(fx, fy, axx / cell, axy / cell, byx / cell, byy / cell)
            better = False
            for _ in range(HALVINGS):
                tx, ty = x + sx, y + sy
                a, pxx, pxy = bicubic(dx, tx / cell, ty / cell)
                b, pyx, pyy = bicubic(dy, tx / cell, ty / cell)
                gx, gy = tx + a - X, ty + b - Y
                if np.hypot(gx, gy) < miss:
                    better = True
                    break
                sx, sy = 0.5 * sx, 0.5 * sy
            if not better:
                break
            x, y, fx, fy, axx, axy, byx, byy = tx, ty, gx, gy, pxx, pxy, pyx, pyy
            miss = np.hypot(fx, fy)
        height[p] = bicubic(h, x / cell, y / cell)[0]
        residual[p] = miss


@kernel
def newton_step(fx, fy, axx, axy, byx, byy):
    """Solve (1 + grad D) s = -f; the plain fixed-point step -f where the matrix cannot be inverted."""
    det = (1.0 + axx) * (1.0 + byy) - axy * byx
    if abs(det) < 1e-6:
        return -fx, -fy
    return -((1.0 + byy) * fx - axy * fy) / det, -((1.0 + axx) * fy - byx * fx) / det


@kernel
def sum_waves(h, dk, choppiness, x, y):
    """(height, Dx, Dy, Dxx, Dyy, Dxy) at x, y [m] by the sum over the half plane; ky > 0 counts twice."""
    n, half = h.shape[0], h.shape[1] // 2 - 1
    height = h[0, 0]
    Dx, Dy, Dxx, Dyy, Dxy = 0.0, 0.0, 0.0, 0.0, 0.0
    stepc, steps = np.cos(dk * y), np.sin(dk * y)
    for i in range(n):
        m = i if i < half else i - n
        kx = m * dk
        c, s = np.cos(kx * x), np.sin(kx * x)
        for j in range(half):
            if m != -half and (i > 0 or j > 0):
                ky = j * dk
                k = np.hypot(kx, ky)
                twice = 2.0 if j > 0 else 1.0
                re = twice * (h[i, 2 * j] * c - h[i, 2 * j + 1] * s)
                im = twice * (h[i, 2 * j] * s + h[i, 2 * j + 1] * c)
                height += re
                # Re(-i h e) = Im(h e); d/dx of it is kx Re(h e)
                Dx += kx / k * im
                Dy += ky / k * im
                Dxx += kx * kx / k * re
                Dyy += ky * ky / k * re
                Dxy += kx * ky / k * re
            c, s = c * stepc - s * steps, s * stepc + c * steps
    g = choppiness
    return height, g * Dx, g * Dy, g * Dxx, g * Dyy, g * Dxy


@kernel
def find_exact(points, h, dk, choppiness, cell, height, residual):
    """Heights and residuals of all points by the sum over all waves."""
    for p in range(points.shape[0]):
        X, Y = points[p, 0], points[p, 1]
        x, y = X, Y
        for _ in range(FIXED_POINT_STEPS):
            _, a, b, _, _, _ = sum_waves(h, dk, choppiness, x, y)
            x, y = X - a, Y - b
        z, a, b, xx, yy, xy = sum_waves(h, dk, choppiness, x, y)
        fx, fy = x + a - X, y + b - Y
        miss = np.hypot(fx, fy)
        for _ in range(NEWTON_STEPS):
            if miss <= TOLERANCE * cell:
                break
            sx, sy = newton_step(fx, fy, xx, xy, xy, yy)
            better = False
            for _ in range(HALVINGS):
                tx, ty = x + sx, y + sy
                tz, a, b, txx, tyy, txy = sum_waves(h, dk, choppiness, tx, ty)
                gx, gy = tx + a - X, ty + b - Y
                if np.hypot(gx, gy) < miss:
                    better = True
                    break
                sx, sy = 0.5 * sx, 0.5 * sy
            if not better:
                break
            x, y, z, fx, fy, xx, yy, xy = tx, ty, tz, gx, gy, txx, tyy, txy
            miss = np.hypot(fx, fy)
        height[p], residual[p] = z, miss
