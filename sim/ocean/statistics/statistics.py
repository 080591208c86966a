"""Statistics of a sea: Hs, Tp, mean square slope and direction, in theory and on a drawn field, with their scatter.

One tile is a sample: even a perfect one differs from its spectrum. `height_scatter` is the expected deviation.
"""

import functools
import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from sim.numerics.angles import direction_of, within_turn
from sim.ocean.radial.gerstner import energy_range
from sim.ocean.spectra import Conditions, Spectrum
from sim.validation import argument_error, check_number

if TYPE_CHECKING:
    from sim.ocean.tile.sea import Sea

BREAKING_HEIGHT = 0.6  # Hs over the depth above which the waves of a sea break on the bottom
# Lower bounds of forces 1 to 12 [m/s] (WMO No. 306) and the names of 0 to 12.
BEAUFORT_FROM = (0.3, 1.6, 3.4, 5.5, 8.0, 10.8, 13.9, 17.2, 20.8, 24.5, 28.5, 32.7)
BEAUFORT_NAMES = (
    "calm", "light air", "light breeze", "gentle breeze", "moderate breeze", "fresh breeze", "strong breeze",
    "near gale", "gale", "strong gale", "storm", "violent storm", "hurricane force",
)  # fmt: skip


class Statistics(NamedTuple):
    """Statistics of a sea. nan if it is flat; the direction is nan if only one snapshot is known."""

    significant_height: float  # [m] 4 sqrt(m0)
    peak_period: float  # [s]
    mean_square_slope: float
    direction: float  # [rad] where the energy goes to


def beaufort(wind_speed: float) -> tuple[int, str]:
    """Beaufort force 0 to 12 and its name, of U10 [m/s]. Raises ValueError for a negative or non-finite speed.

    >>> beaufort(15.0)
    (7, 'near gale')
    """
    force = int(np.searchsorted(BEAUFORT_FROM, check_number("wind_speed", wind_speed, "m/s", 0.0), side="right"))
    return force, BEAUFORT_NAMES[force]


def theory(spectrum: Spectrum[Any], conditions: Conditions, k_max: float = 1e4, k_min: float = 1e-6) -> Statistics:
    """Statistics of the spectrum itself between two wavenumbers [rad/m], by a sum over log k and direction."""
    k, cells, theta = _polar_cells(spectrum, conditions, k_max, k_min)
    along = cells.sum(axis=1)
    if not along.any():
        return Statistics(0.0, math.nan, 0.0, math.nan)
    # S(omega) = S(log k) dlog(k)/domega = S(log k)/(k cg)
    omega = conditions.omega(k)
    peak = omega[np.argmax(along / (k * conditions.group_speed(k)))]
    east, north = (cells * np.cos(theta)).sum(), (cells * np.sin(theta)).sum()
    return Statistics(
        4.0 * math.sqrt(along.sum()),
        2.0 * math.pi / peak,
        float((along * k**2).sum()),
        direction_of(east, north, along.sum()),
    )


@functools.lru_cache(maxsize=64)
def open_sea_height(spectrum: Spectrum[Any], conditions: Conditions) -> float:
    """Hs [m] of an endless sea under these conditions: the closed form if one exists, or the integral."""
    if spectrum.is_level(conditions):
        closed = 0.0
    else:
        closed = math.nan if spectrum.significant_height is None else spectrum.significant_height(conditions)
    if math.isfinite(closed) and conditions.low_pass == 0.0:
        return math.hypot(closed, conditions.second_height)
    k_min, k_max = energy_range(spectrum, conditions)
    return theory(spectrum, conditions, k_max, k_min).significant_height


def energy_by_wavenumber(
    spectrum: Spectrum[Any], conditions: Conditions, k_max: float = 1e4, k_min: float = 1e-6
) -> tuple[np.ndarray, np.ndarray]:
    """(k [rad/m], energy [m2]), (n,) each: the spectrum's energy in n cells of log k; their sum is m0."""
    k, cells, _ = _polar_cells(spectrum, conditions, k_max, k_min)
    return k, cells.sum(axis=1)


def _polar_cells(
    spectrum: Spectrum[Any], conditions: Conditions, k_max: float, k_min: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """k (n,) [rad/m], energy (n, m) [m2] of cells of log k and direction, and theta (m,) [rad]."""
    log_k, step = np.linspace(math.log(k_min), math.log(k_max), 3000, retstep=True)
    theta = np.arange(180) * (2.0 * math.pi / 180)
    k = np.exp(log_k)
    S = spectrum(k[:, None] * np.cos(theta), k[:, None] * np.sin(theta), conditions)
    cells = S * k[:, None] ** 2 * (step * 2.0 * math.pi / theta.size)  # S k dk dtheta = S k^2 dlog(k) dtheta
    if spectrum.line is not None:
        kx, ky, m0 = spectrum.line(conditions)
        row = int(np.argmin(np.abs(log_k - math.log(math.hypot(kx, ky)))))
        # to the two cells beside its direction, so that none is chosen by a rounding
        place = float(within_turn(math.atan2(ky, kx))) / (2.0 * math.pi) * theta.size
        column, share = int(place), place % 1.0
        cells[row, column] += (1.0 - share) * m0
        cells[row, (column + 1) % theta.size] += share * m0
    return k, cells, theta


def expected(sea: "Sea", t: float | None = None) -> Statistics:
    """Statistics of the spectrum as the tile resolves it: sums of S dk^2 over its waves at time t [s].

    By default that is the sea's own time. Raises ValueError for a time that the sea does not take.
    """
    return _of_energy(sea, sea.energy_at(sea.time if t is None else t))


def drawn(sea: "Sea", t: float | None = None) -> Statistics:
    """Statistics of the amplitudes as drawn: sums of 2 |h0|^2 over the tile's waves. t and errors as for `expected`."""
    return _of_energy(sea, 2.0 * np.abs(sea.amplitudes_at(sea.time if t is None else t)) ** 2)


def measured(
    height: np.ndarray,
    length: float,
    conditions: Conditions,
    earlier: np.ndarray | None = None,
    interval: float = 0.0,
) -> Statistics:
    """Statistics of a drawn field: height (n, n) [m] on a tile of length [m], by its FFT.

    earlier: the field `interval` [s] before; tells the direction, of the waves that turn by less than a quarter of
    their period in between. Where those about the peak turn farther, it is nan: the waves are not resolved in time.
    Raises ValueError if the fields do not fit.
    """
    if height.ndim != 2 or height.shape[0] != height.shape[1]:
        raise argument_error("height", height.shape, "a square field")
    n = height.shape[0]
    kx, ky, k, omega, twice, bins = _half_plane(n, length, conditions)
    h = np.fft.rfft2(np.asarray(height, np.float64)) / n**2
    energy = twice * (h.real**2 + h.imag**2)
    energy[0, 0] = 0.0
    direction, peak_period = math.nan, _peak_period(omega, energy, bins)
    if earlier is not None:
        if earlier.shape != height.shape:
            raise argument_error("earlier", earlier.shape, f"a field of shape {height.shape}")
        # h = P e^(-i omega t) + Q e^(i omega t): the phase of h falls where the wave runs along k, rises against it.
        before = np.fft.rfft2(np.asarray(earlier, np.float64)) / n**2
        # Im(before conj(h)) = (|P|^2 - |Q|^2) sin(omega interval), here over k as well, for the unit vector
        angle = omega * interval
        scale = k * np.sin(angle)
        some = (angle < 0.5 * math.pi) & (scale > 0.0)
        turned = twice * (before.imag * h.real - before.real * h.imag)
        turned = np.divide(turned, scale, out=np.zeros_like(turned), where=some)
        if resolved_in_time(peak_period, interval):
            direction = direction_of(*(float((turned * one).sum()) for one in (kx, ky, k * np.sign(turned))))
    return Statistics(
        4.0 * math.sqrt(energy.sum()),
        peak_period,
        float((energy * k**2).sum()),
        direction,
    )


@functools.lru_cache(maxsize=2)
def _half_plane(
    n: int, length: float, conditions: Conditions
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, "_Bins | None"]:
    """kx, ky, k [rad/m] and omega [rad/s] of the waves of a real transform, how many waves each stands for, and the
    bins of all that run."""
    k1 = np.fft.fftfreq(n, length / n) * 2.0 * math.pi
    kx, ky = k1[:, None], k1[None, : n // 2 + 1]
    k = np.hypot(kx, ky)
    twice = np.full(k.shape, 2.0)
    twice[:, 0] = 1.0
    if n % 2 == 0:
        twice[:, -1] = 1.0
    omega = conditions.omega(k)
    return kx, ky, k, omega, twice, _bins(omega, omega > 0.0)


def resolved_in_time(period: float, interval: float) -> bool:
    """True if two fields `interval` [s] apart show the direction of waves of this period [s]."""
    return 4.0 * interval < period


def height_scatter(sea: "Sea", t: float | None = None) -> float:
    """Relative standard deviation of the Hs of one snapshot of this tile, over seeds. t and errors as for `expected`.

    m0 of a snapshot is sum |h(k)|^2. Random amplitudes: each |h|^2 of a pair +-k is exponential with mean
    s = (S(k) + S(-k)) dk^2/2, so Var m0 = 2 sum s^2. Fixed ones: only the beat of S(k) with S(-k), Var = sum S S' dk^4.
    """
    energy = sea.energy_at(sea.time if t is None else t)
    opposite = np.roll(energy[::-1, ::-1], 1, axis=(0, 1))
    if not energy.any():
        return 0.0
    variance = 0.5 * ((energy + opposite) ** 2).sum() if sea.amplitudes == "random" else (energy * opposite).sum()
    return 0.5 * math.sqrt(variance) / float(energy.sum())


def _of_energy(sea: "Sea", energy: np.ndarray) -> Statistics:
    kx, ky = sea.k[:, None], sea.k[None, :]
    k = np.hypot(kx, ky)
    inverse = np.divide(1.0, k, out=np.zeros_like(k), where=k > 0.0)
    return Statistics(
        4.0 * math.sqrt(energy.sum()),
        _peak_period(sea.frequencies, energy),
        float((energy * k**2).sum()),
        direction_of((energy * kx * inverse).sum(), (energy * ky * inverse).sum(), energy.sum()),
    )


class _Bins(NamedTuple):
    """Waves in bins of their frequency."""

    waves: np.ndarray  # which waves, of all
    number: np.ndarray  # of the bin of each of these
    edges: np.ndarray  # [rad/s] of the bins


def _bins(omega: np.ndarray, waves: np.ndarray) -> _Bins | None:
    """Bins 6 % wide over the frequencies [rad/s] of these waves; None without waves."""
    if not waves.any():
        return None
    running = omega[waves]
    low, high = running.min(), running.max()
    edges = np.geomspace(0.98 * low, 1.02 * high, max(int(math.log(high / low + 1.0) / 0.06), 4))
    return _Bins(waves, np.searchsorted(edges, running, side="right") - 1, edges)


def _peak_period(omega: np.ndarray, energy: np.ndarray, all_bins: _Bins | None = None) -> float:
    """2 pi/omega_p with omega_p = sum omega S^4/sum S^4 (Young 1995, Ocean Eng. 22:669), S in bins 6 % wide.

    all_bins: those of all waves that run, if known; they are used where none of these waves is without
    energy.
    """
    bins = all_bins if all_bins is not None and (energy[all_bins.waves] > 0.0).all() else None
    if bins is None:
        bins = _bins(omega, (energy > 0.0) & (omega > 0.0))
    if bins is None:
        return math.nan
    waves, number, edges = bins
    held = np.bincount(number, energy[waves], len(edges) - 1)
    density = held / np.diff(edges)
    weight = (density / density.max()) ** 4 * np.diff(edges)
    return 2.0 * math.pi * float(weight.sum() / (weight * np.sqrt(edges[1:] * edges[:-1])).sum())
