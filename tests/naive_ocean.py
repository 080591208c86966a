"""Slow, obvious references for the ocean: sums over all waves, determinants, roots of polynomials, integrals."""

import numpy as np
from scipy.special import j0

from sim.ocean import Sea


def sum_of_waves(sea: Sea, t: float, x: np.ndarray, y: np.ndarray) -> dict[str, np.ndarray]:
    """Fields of the sea at labels x, y (n,) [m] by adding its waves one by one: Re sum 2 h0 e^(i(k.x - omega t))."""
    h0, omega, decay = sea.amplitudes_at(0.0), sea.frequencies, sea.decay_rates
    names = ("height", "Dx", "Dy", "sx", "sy", "Dxx", "Dyy", "Dxy")
    total = {name: np.zeros(len(x)) for name in names}
    for i, kx in enumerate(sea.k):
        for j, ky in enumerate(sea.k):
            k = np.hypot(kx, ky)
            if k == 0.0 or h0[i, j] == 0.0:
                continue
            wave = 2.0 * h0[i, j] * np.exp(1j * (kx * x + ky * y - omega[i, j] * t) - decay[i, j] * t)
            c = sea.choppiness
            parts = (1, 1j * c * kx / k, 1j * c * ky / k, 1j * kx, 1j * ky)
            for name, factor in zip(names, (*parts, -c * kx * kx / k, -c * ky * ky / k, -c * kx * ky / k), strict=True):
                total[name] += (factor * wave).real
    return total


def grid_fields(sea: Sea, t: float) -> dict[str, np.ndarray]:
    """The same on the sea's grid, in the shapes of `Surface`."""
    x = np.arange(sea.size) * sea.length / sea.size
    X, Y = np.meshgrid(x, x, indexing="ij")
    f = {name: values.reshape(X.shape) for name, values in sum_of_waves(sea, t, X.ravel(), Y.ravel()).items()}
    gathered = (f["height"] * (f["Dxx"] + f["Dyy"])).mean()  # by how much a fixed place sees the waves too low
    return {
        "height": f["height"] - gathered,
        "displacement": np.stack([f["Dx"], f["Dy"]], axis=-1),
        "slope": np.stack([f["sx"], f["sy"]], axis=-1),
        "jacobian": (1.0 + f["Dxx"]) * (1.0 + f["Dyy"]) - f["Dxy"] ** 2,
    }


def two_layer_determinant(w: float, k: float, rho1: float, d: float, rho2: float, g: float, h2: float) -> float:
    """Determinant of the boundary conditions of two layers without tension, for phi1 = A cosh kz + B sinh kz.

    Unknowns A, B and C, where phi2 = C cosh k(z + d + h2)/sinh(k h2). Rows: pressure at the surface, vertical speed
    and pressure at the interface. 0 at a mode. Scaled by its largest product.
    """
    ch, sh, T = np.cosh(k * d), np.sinh(k * d), 1.0 / np.tanh(k * h2)
    matrix = np.array(
        [
            [-(w**2), g * k, 0.0],
            [-k * sh, k * ch, -k],
            [rho1 * (-(w**2) * ch), rho1 * (w**2) * sh, -(rho2 * (g * k - w**2 * T) - rho1 * g * k)],
        ]
    )
    return float(np.linalg.det(matrix) / np.prod(np.abs(matrix).max(axis=1)))


def viscous_roots(theta: float) -> np.ndarray:
    """All s/omega0 with Re m > 0 of Lamb's Art. 349, by the roots of (m^2 + 1)^2 - 4 m + 1/theta^2."""
    m = np.roots([1.0, 0.0, 2.0, -4.0, 1.0 + 1.0 / theta**2])
    return theta * (m[m.real > 0.0] ** 2 - 1.0)


def film_roots(theta: float) -> np.ndarray:
    """All s/omega0 with Re m > 0 under a film, by the roots of theta^2 (m^2 - 1)^2 = 1/m - 1."""
    m = np.roots([1.0, 0.0, -2.0, 0.0, 1.0 + 1.0 / theta**2, -1.0 / theta**2])
    return theta * (m[(m.real > 0.0) & (np.abs(m - 1.0) > 1e-9)] ** 2 - 1.0)


def dropped_gaussian(r: float, t: float, width: float, gravity: float = 9.81) -> float:
    """Height [m] at r [m], t [s] after a unit volume was dropped on deep water as a Gaussian: the Hankel integral."""
    k = np.linspace(0.0, 9.0 / width, 400001)
    integrand = k * j0(k * r) * np.cos(np.sqrt(gravity * k) * t) * np.exp(-0.5 * (width * k) ** 2)
    return float(np.trapezoid(integrand, k) / (2.0 * np.pi))


def pushed_gaussian(r: float, t: float, width: float, density: float, gravity: float = 9.81) -> float:
    """The same after a unit downward impulse on level water: eta(k) = -(k/(rho omega)) sin(omega t)."""
    k = np.linspace(1e-9, 9.0 / width, 400001)
    w = np.sqrt(gravity * k)
    integrand = -(k**2) * j0(k * r) * np.sin(w * t) / (density * w) * np.exp(-0.5 * (width * k) ** 2)
    return float(np.trapezoid(integrand, k) / (2.0 * np.pi))


def plane_integral(spectrum, conditions, weight: float = 0.0, k_max: float = 2e3) -> float:
    """Integral of |k|^weight S over the wavenumber plane."""
    log_k, step = np.linspace(np.log(1e-5), np.log(k_max), 4000, retstep=True)
    theta = (np.arange(360) + 0.5) * (2.0 * np.pi / 360)
    k = np.exp(log_k)[:, None]
    S = spectrum(k * np.cos(theta), k * np.sin(theta), conditions)
    return float((S * k ** (2.0 + weight)).sum() * step * 2.0 * np.pi / 360)


def layer_determinant(
    s: np.ndarray, k: np.ndarray, d: np.ndarray, rho: tuple, mu: tuple, gravity: float, tension: tuple
) -> np.ndarray:
    """(n,) determinants, over their largest products, of the six conditions of two viscous layers, in long doubles.

    Unknowns: the factors of e^(kz), e^(-k(z + d)), e^(mz), e^(-m(z + d)) of the vertical velocity above the interface
    z = -d, and of e^(k(z + d)), e^(m(z + d)) below it, in time e^(st). rho [kg/m3], mu [Pa s], tension [N/m]: (above,
    below), each (n,). Rows: shear and normal stress at z = 0; both velocities, shear and normal stress at z = -d.
    """
    n = len(k)
    m = [np.sqrt(k**2 + s * r / v) for r, v in zip(rho, mu, strict=True)]
    e, E = np.exp(-k * d), np.exp(-m[0] * d)
    one, zero = np.ones(n, np.clongdouble), np.zeros(n, np.clongdouble)
    rates = [k, -k, m[0], -m[0], k, m[1]]
    potential = [1, 1, 0, 0, 1, 0]
    top, bottom = [one, e, one, E, zero, zero], [e, one, E, one, one, one]
    M = np.zeros((n, 6, 6), np.clongdouble)
    for j in range(6):
        layer = 0 if j < 4 else 1
        q, P = rates[j], potential[j]
        # i times what the names say, where that makes them real: u = i w'/k, shear = i mu (w'' + k^2 w)/k
        shear = mu[layer] * (q**2 + k**2) / k
        normal = -P * rho[layer] * s * q / k**2 - 2 * mu[layer] * q  # pressure less viscous stress
        sign = 1 if layer == 0 else -1
        M[:, 0, j] = shear * top[j]
        M[:, 1, j] = (normal * s - (rho[0] * gravity + tension[0] * k**2)) * top[j]
        M[:, 2, j] = sign * bottom[j]
        M[:, 3, j] = sign * q / k * bottom[j]
        M[:, 4, j] = sign * shear * bottom[j]
        M[:, 5, j] = sign * normal * s * bottom[j]
        if layer == 0:
            M[:, 5, j] += ((rho[1] - rho[0]) * gravity + tension[1] * k**2) * bottom[j]
    M /= np.abs(M).max(axis=2, keepdims=True)
    determinant = one.copy()
    for j in range(6):  # Gauss with pivots: numpy's own knows no long doubles
        pivot = j + np.abs(M[:, j:, j]).argmax(axis=1)
        swapped = pivot != j
        rows = np.arange(n)
        M[rows, j], M[rows, pivot] = M[rows, pivot].copy(), M[rows, j].copy()
        determinant = determinant * np.where(swapped, -1, 1) * M[:, j, j]
        M[:, j + 1 :] -= M[:, j + 1 :, j, None] / M[:, j, j][:, None, None] * M[:, j, None, :]
    return determinant


def layer_roots(k, d, rho, mu, gravity: float, tension, steps: int = 60) -> np.ndarray:
    """(n,) roots s of the surface wave, followed by Newton's method from that without viscosity as both viscosities
    grow by equal factors. All arguments but gravity: arrays (n,), or pairs of them."""
    wide = np.longdouble
    k, d = np.asarray(k, wide), np.asarray(d, wide)
    rho, mu, tension = (
        tuple(np.broadcast_to(np.asarray(x, wide), k.shape) for x in pair) for pair in (rho, mu, tension)
    )
    G1, G2 = gravity + tension[0] * k**2 / rho[0], (rho[1] - rho[0]) * gravity + tension[1] * k**2
    th = np.tanh(k * d)
    A, B, C = rho[1] + rho[0] * th, k * (rho[1] * G1 * th + rho[0] * G1 + G2), k**2 * G1 * G2 * th
    s = 1j * np.sqrt((B + np.sqrt(B * B - 4 * A * C)) / (2 * A)).astype(np.clongdouble)
    for share in np.geomspace(1e-6, 1.0, steps):
        thin = tuple(wide(share) * v for v in mu)
        for _ in range(12):
            h = 1e-7 * np.abs(s)
            f, up, down = (layer_determinant(x, k, d, rho, thin, gravity, tension) for x in (s, s + h, s - h))
            # Each determinant is scaled by its own rows, and these change with s too slowly to matter to the root.
            change = f * 2 * h / (up - down)
            s = s - change
            if (np.abs(change) < 1e-17 * np.abs(s)).all():
                break
    return s


def flow_of_waves(waves, points: np.ndarray, t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Velocity, acceleration and pressure at points (n, 3) of `Waves`, one wave after another, from the potential
    phi = a omega/k cosh k(z + h)/sinh kh sin(k.x - omega t + phase), h at most 300/k."""
    velocity, acceleration, pressure = np.zeros((len(points), 3)), np.zeros((len(points), 3)), np.zeros(len(points))
    x, y, z = points.T
    for kx, ky, a, omega, phase in zip(waves.kx, waves.ky, waves.amplitude, waves.omega, waves.phase, strict=True):
        k = np.hypot(kx, ky)
        h = min(waves.water.depth, 300.0 / k)
        theta = kx * x + ky * y - omega * t + phase
        C, S = np.cosh(k * (z + h)) / np.sinh(k * h), np.sinh(k * (z + h)) / np.sinh(k * h)
        gradient = np.stack([kx * C * np.cos(theta), ky * C * np.cos(theta), k * S * np.sin(theta)], axis=1)
        rates = np.stack([kx * C * np.sin(theta), ky * C * np.sin(theta), -k * S * np.cos(theta)], axis=1)
        velocity += a * omega / k * gradient
        acceleration += a * omega**2 / k * rates
        pressure += waves.water.density * a * omega**2 / k * C * np.cos(theta)
    return velocity, acceleration, pressure
