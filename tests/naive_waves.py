"""Closed forms and slow references of nonlinear waves, written plainly."""

import math

import numpy as np
import scipy.linalg

from sim.ocean.nonlinear.starts.stokes import StokesWave


def second_order_pair(k1: np.ndarray, k2: np.ndarray, depth: float, gravity: float, sign: int) -> float:
    """Elevation of the bound wave of wavenumber k1 + sign k2, over the product of the amplitudes of two free waves.

    Waves a_i cos(theta_i) carry a1 a2 T cos(theta1 + sign theta2), T [1/m] (Longuet-Higgins 1962, J. Fluid Mech.
    12:321, for infinite depth; Sharma and Dean 1981; Dalzell 1999, Appl. Ocean Res. 21:105), here from the boundary
    conditions at second order: the potential of the bound wave solves

      phi_tt + g phi_z = -(|grad phi|^2)_t - eta (phi_ttz + g phi_zz)   at z = 0
    """
    k = [math.hypot(*k1), math.hypot(*k2)]
    q = [ki * (math.tanh(ki * depth) if math.isfinite(depth) else 1.0) for ki in k]
    w = [math.sqrt(gravity * qi) for qi in q]
    s, (w1, w2), dot = sign, w, float(np.dot(k1, k2))
    # phi_i = b_i f_i(z) sin(theta_i), b_i = g/w_i. Products of the pair, of phase theta1 + s theta2:
    b1, b2 = gravity / w1, gravity / w2
    W = w1 + s * w2
    total = np.asarray(k1) + s * np.asarray(k2)
    K = math.hypot(*total)
    Q = K * (math.tanh(K * depth) if math.isfinite(depth) else 1.0)
    # |grad phi|^2: 2 b1 b2 (k1.k2 cos cos + q1 q2 sin sin), of which cos(theta1 + s theta2) has 1/2 and -s/2.
    square = b1 * b2 * (dot - s * q[0] * q[1])
    # eta (phi_ttz + g phi_zz): eta1 = cos theta1 with phi2's b2 (-w2^2 q2 + g k2^2) sin theta2, and the reverse.
    c1, c2 = (b * (-(wi**2) * qi + gravity * ki**2) for b, wi, qi, ki in zip((b1, b2), w, q, k, strict=True))
    forcing = -(W * square) - 0.5 * (s * c2 + c1)  # of sin(theta1 + s theta2); d/dt cos = W sin
    B = forcing / (gravity * Q - W**2)
    # eta = -(phi_t + |grad phi|^2/2 + eta phi_tz)/g; phi_tz of wave i is -b_i w_i q_i cos(theta_i)
    return (W * B - 0.5 * square + 0.5 * (b1 * w1 * q[0] + b2 * w2 * q[1])) / gravity


def side_band_growth(
    wave: StokesWave, p: float, q: float = 0.0, count: int = 10
) -> tuple[float, np.ndarray, np.ndarray]:
    """Fastest growth [1/s] of disturbances e^(i (p x + q y)) times a series of the period of a wave, in its depth.

    Returns it with amplitudes (2 count + 1,) of elevation and surface potential of e^(i ((n + p) x + q y)), n from
    -count; p, q in wavenumbers of the wave, count at most about 10. Euler's equations linearised about the exact wave
    in its frame, by collocation on its surface (the problem of McLean 1982, J. Fluid Mech. 114:315, Sec. 2).
    """
    K, g, c = wave.wavenumber, wave.gravity, wave.speed
    m = 2 * count + 1
    x = np.arange(m) * wave.wavelength / m
    eta = wave.elevation(x)
    j = K * np.arange(1, len(wave.sines) + 1)
    C, S = heights_of(j, eta, wave.depth)
    cos, sin = np.cos(np.outer(x, j)), np.sin(np.outer(x, j))
    u, w = (C * cos) @ (j * wave.sines) - c, (S * sin) @ (j * wave.sines)
    uz, wz = (S * cos) @ (j**2 * wave.sines), (C * sin) @ (j**2 * wave.sines)
    slope = w / u  # a streamline
    n = np.arange(-count, count + 1)
    kx = K * (n + p)
    k = np.hypot(kx, K * q)
    wave_x = np.exp(1j * np.outer(x, kx))
    F, Fz = (wave_x * part for part in heights_of(k, eta, wave.depth))  # phi' on the surface, and phi'_z over k
    # eta'_t = -u eta'_x - uz eta_x eta' + wz eta' + phi'_z - eta_x phi'_x
    A11 = -u[:, None] * 1j * kx * wave_x + (wz - uz * slope)[:, None] * wave_x
    A12 = k * Fz - 1j * kx * slope[:, None] * F
    # phi'_t = -(u u_z + w w_z + g) eta' - u phi'_x - w phi'_z
    A21 = -(u * uz + w * wz + g)[:, None] * wave_x
    A22 = -(u[:, None] * 1j * kx * F + w[:, None] * k * Fz)
    zero = np.zeros_like(F)
    values, vectors = scipy.linalg.eig(np.block([[A11, A12], [A21, A22]]), np.block([[wave_x, zero], [zero, F]]))
    found = np.where(np.isfinite(values), values.real, -np.inf)
    best = int(np.argmax(found))
    a, b = vectors[:m, best], vectors[m:, best]
    # Surface potential: psi' = phi' + W eta', W the vertical velocity of the wave
    surface = F @ b + w * (wave_x @ a)
    return float(found[best]), a, np.linalg.solve(wave_x, surface)


def heights_of(k: np.ndarray, z: np.ndarray, depth: float) -> tuple[np.ndarray, np.ndarray]:
    """cosh k(z + h) and sinh k(z + h) over cosh kh, (heights, waves)."""
    near = np.exp(np.outer(z, k))
    far = 0.0 * near if math.isinf(depth) else np.exp(-np.outer(z + 2.0 * depth, k))
    scale = 1.0 if math.isinf(depth) else 1.0 + np.exp(-2.0 * k * depth)
    return (near + far) / scale, (near - far) / scale
