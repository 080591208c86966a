"""Waves of a buoy's record: a sea of long crests that passes one point as recorded there.

    >>> import numpy as np
    >>> from sim.ocean import RadialSea
    >>> t = np.arange(0.0, 120.0, 0.5)
    >>> eta = 0.8 * np.sin(2 * np.pi * t / 8.0) + 0.3 * np.cos(2 * np.pi * t / 5.0)
    >>> sea = RadialSea(recorded_waves(t, eta, direction=0.5), choppiness=0.0)
    >>> bool(abs(sea.at([[0.0, 0.0]], t=33.0).height[0] - np.interp(33.0, t, eta)) < 1e-2)
    True

The record is the sum of its Fourier components, and each becomes one wave. It restarts after its length, so
that its ends meet there. Of linear waves this is the only sea whose crests are all at right angles to the direction.
"""

import math

import numpy as np
from numpy.typing import ArrayLike

from sim.numerics.angles import within_half_turn
from sim.numerics.root import narrowed
from sim.ocean.fluids.fluid_column import FluidColumn
from sim.ocean.radial.gerstner import MAX_WAVES
from sim.ocean.spectra import Conditions
from sim.validation import argument_error, as_array, check_angle, check_kind, check_number, check_vector
from sim.water import Water
from sim.waves import Waves

CLEAN = FluidColumn()
MIN_SAMPLES = 8
UNEVEN = 1e-3  # of the spacing of samples, their largest deviation from it
HIGHEST = 10.0  # [Hz]: above, there are no gravity waves
BRACKET = (0.05, 20.0)  # of omega^2/g, around the wavenumber


def recorded_waves(
    t: ArrayLike,
    height: ArrayLike,
    direction: float = 0.0,
    place: tuple[float, float] = (0.0, 0.0),
    water: FluidColumn | Conditions = CLEAN,
    error: float = 0.005,
) -> Waves:
    """The waves that run along a direction [rad] and pass a place (x, y) [m] as heights (n,) [m] at times (n,) [s].

    The mean height is that of still water. water: the column of their `RadialSea`, or the conditions
    of water of any depth. error: root mean square of the height that may be left
    out, over Hs; the smallest waves are left out first. Only a sea with choppiness 0 passes the place exactly so.

    Raises ValueError for times that are not equally spaced, values that are not finite, a level record, and one that
    needs more than 4096 waves.
    """
    times, heights = as_array("t", t, "numbers [s]"), as_array("height", height, "numbers [m]")
    allowed = f"at least {MIN_SAMPLES} finite times [s], equally spaced and rising, shape (n,)"
    if times.ndim != 1 or len(times) < MIN_SAMPLES or not np.isfinite(times).all():
        raise argument_error("t", times.shape if times.ndim != 1 or len(times) < MIN_SAMPLES else times, allowed)
    n, step = len(times), float(times[-1] - times[0]) / (len(times) - 1)
    if not step > 0.0 or np.abs(times - times[0] - step * np.arange(n)).max() > UNEVEN * step:
        gap = int(np.argmax(np.diff(times)))
        description = f"times with a step of {float(np.median(np.diff(times))):.4g} s, and one of"
        raise argument_error(
            "t", f"{description} {times[gap + 1] - times[gap]:.4g} s after t = {times[gap]:g} s", allowed
        )
    if heights.shape != times.shape:
        raise argument_error("height", heights.shape, f"finite heights, one for each of {n} times")
    bad = ~np.isfinite(heights)
    if bad.any():
        i = int(bad.argmax())
        description = f"{heights[i]:g} at t = {times[i]:g} s, {int(bad.sum())} such heights in all"
        raise argument_error("height", description, "finite heights")
    direction, error = check_angle("direction", direction), check_number("error", error, "", 0.0, 0.5)
    x, y = check_vector("place", place, "m", 2)
    check_kind("water", water, FluidColumn | Conditions, "a FluidColumn or Conditions")
    X = np.fft.rfft(heights - heights.mean())[1:] / n
    f = np.arange(1, len(X) + 1) / (n * step)
    amplitude = 2.0 * np.abs(X)
    if n % 2 == 0:  # half the rate of the samples: a transform has its whole amplitude
        amplitude[-1] *= 0.5
    energy = 0.5 * amplitude**2
    if not energy.sum() > 0.0:
        raise argument_error("height", f"{n} equal heights", "a record with waves")
    order = np.argsort(-energy, kind="stable")
    left = energy.sum() - np.cumsum(energy[order])  # with 1, 2, ... waves
    count = int(np.searchsorted(-left, -16.0 * error**2 * energy.sum())) + 1
    strongest = np.sort(order[:count])
    if count > MAX_WAVES or f[strongest[-1]] > HIGHEST:
        description = f"a record of {count} waves up to {f[strongest[-1]]:.3g} Hz"
        raise argument_error(
            "height", description, f"at most {MAX_WAVES} up to {HIGHEST:g} Hz: a shorter record, or more error"
        )
    omega = 2.0 * math.pi * f[strongest]
    k = wavenumber(omega, water)
    kx, ky = k * math.cos(direction), k * math.sin(direction)
    phase = within_half_turn(omega * times[0] - np.angle(X[strongest]) - kx * x - ky * y)
    own = water.water if isinstance(water, Conditions) else Water(math.inf, water.gravity, water.surface.density)
    return Waves(kx, ky, amplitude[strongest], phase, omega, own)


def wavenumber(omega: np.ndarray, water: FluidColumn | Conditions) -> np.ndarray:
    """Wavenumber (n,) [rad/m] of waves of these angular frequencies (n,) [rad/s]."""
    if isinstance(water, Conditions):
        return water.wavenumber(omega)
    low, high = (np.log(factor * omega**2 / water.gravity) for factor in BRACKET)
    return np.exp(narrowed(lambda logarithm: np.log(water.roots(np.exp(logarithm))[0] / omega), low, high, 1e-14)[1])
