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
    return {
        "height": f["height"],
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
