"""The water below linear waves: velocity, acceleration and pressure at points, as a sum over waves.

    >>> from sim.ocean import Sea
    >>> sea = Sea(64, 400.0, "regular", wave_height=2.0, wave_period=8.0, wind_speed=0.0, depth=60.0)
    >>> flow = sea.kinematics([[0.0, 0.0, 0.0], [0.0, 0.0, -60.0]], t=12.0)
    >>> flow.velocity.shape, flow.acceleration.shape, flow.pressure.shape
    ((2, 3), (2, 3), (2,))
    >>> bool(abs(flow.velocity[1, 2]) < 1e-12)  # at the bottom water moves along it
    True

A wave a cos(theta), theta = k.x - omega t + phase, in water of depth h moves the water at height z (Lamb, Art. 229)
along k by u = a omega C cos(theta) and upwards by w = a omega S sin(theta), and its pressure is

  p = rho a omega^2/k C cos(theta),    C = cosh k(z + h)/sinh kh,  S = sinh k(z + h)/sinh kh,  e^(kz) in deep water

of first order in steepness: the velocity has a potential, the acceleration is du/dt in place, and rho du/dt = -grad p.
The points are places, not labels. Left out are the choppy displacement, of second order here, decay within a period,
rings and slicks.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sim.jit import kernel
from sim.ocean.gerstner import Waves
from sim.ocean.spectra import Conditions
from sim.turns import cos_sin_turns
from sim.validation import (
    argument_error,
    check_choice,
    check_finite,
    check_positions,
    check_vector,
    check_within,
    is_whole_number,
)
from sim.wave_motion import flow_at

STRETCHINGS = ("constant", "wheeler")
MAX_TURN, CREST_HALVINGS = 1e4, 60  # of the search for the phases of a crest
LONGEST = 1e-12  # [rad/m] in place of a wavenumber of 0


class Kinematics(NamedTuple):
    """The water at n points at one moment."""

    velocity: np.ndarray  # (n, 3) [m/s]
    acceleration: np.ndarray  # (n, 3) [m/s2] in place
    pressure: np.ndarray  # (n,) [Pa] beyond that of still water


class Components(NamedTuple):
    """n waves a cos(k.x - omega t + 2 pi phase) on one body of water. Arrays (n,)."""

    kx: np.ndarray  # [rad/m]
    ky: np.ndarray  # [rad/m]
    amplitude: np.ndarray  # [m]
    omega: np.ndarray  # [rad/s]
    phase: np.ndarray  # [turns] at t = 0
    depth: float  # [m], or inf
    density: float  # [kg/m3]
    elevation_error: float = 0.0  # [m] root mean square of the elevation of the waves that are left out
    velocity_error: float = 0.0  # [m/s] the same of the vertical velocity at z = 0

    def largest(self, count: int) -> "Components":
        """The `count` highest of these waves; the errors then hold what is left out. Raises ValueError for a count
        that is not whole or below 1."""
        if not is_whole_number(count) or count < 1:
            raise argument_error("count", count, "a whole number from 1")
        order = np.argsort(-self.amplitude, kind="stable")
        kept, left = order[:count], order[count:]
        squares = 0.5 * np.square(self.amplitude[left])
        return self._replace(
            **{name: getattr(self, name)[kept] for name in ("kx", "ky", "amplitude", "omega", "phase")},
            elevation_error=math.sqrt(self.elevation_error**2 + float(squares.sum())),
            velocity_error=math.sqrt(self.velocity_error**2 + float((squares * self.omega[left] ** 2).sum())),
        )

    def with_crest(self, height: float, place: tuple[float, float], t: float) -> "Components":
        """These waves with a linear crest of this height [m] at a place (x, y) [m] at time t [s].

        Amplitudes stay, and so does Hs. Phases follow the gradient of the height there, as far as needed: a wave turns
        in proportion to its amplitude, so that in the mean a group of the form of NewWave is added (Tromans, Anaturk
        and Hagemeijer 1991, Proc. ISOPE 3:64). Raises ValueError for a height that these amplitudes cannot have.
        """
        x, y = check_vector("place", place, "m", 2)
        turns = 2.0 * math.pi * self.phase
        theta = turns + self.kx * x + self.ky * y - self.omega * check_finite("t", t, "s")
        highest = float(self.amplitude.sum())
        height = check_within("height", height, -0.99 * highest, 0.99 * highest, "m")
        largest = max(float(self.amplitude.max(initial=0.0)), 1e-300)
        half, turned, low, high = np.tan(0.5 * theta), theta, -MAX_TURN, MAX_TURN
        for _ in range(CREST_HALVINGS):  # the flow theta' = -a sin(theta) takes tan(theta/2) to this
            middle = 0.5 * (low + high)
            turned = 2.0 * np.arctan(np.exp(np.clip(-middle / largest * self.amplitude, -300.0, 300.0)) * half)
            is_high = float((self.amplitude * np.cos(turned)).sum()) > height
            low, high = (low, middle) if is_high else (middle, high)
        return self._replace(phase=(turns - theta + turned) / (2.0 * math.pi))

    def table(self) -> np.ndarray:
        """Rows (9, n) for `set_flow`: kx, ky [turns/m], phase [turns], omega [turns/s], cos and sin of the bearing,
        a omega/(1 - q) [m/s], q = e^(-2kh), a [m]."""
        k = np.hypot(self.kx, self.ky)
        level = k == 0.0  # no wave: it moves no water, and stands here as a long one without speed
        kx, k = np.where(level, LONGEST, self.kx), np.where(level, LONGEST, k)
        double = -2.0 * k * self.depth
        speed = np.where(level, 0.0, self.amplitude * self.omega) / -np.expm1(double)
        turn = 2.0 * math.pi
        rows = (kx / turn, self.ky / turn, self.phase, self.omega / turn, kx / k, self.ky / k)
        return np.array([*rows, speed, np.exp(double), self.amplitude])

    def kinematics(self, points: ArrayLike, t: float, stretching: str = "constant") -> Kinematics:
        """The water at points (n, 3) [m], z up from still water, at time t [s].

        stretching, near the surface: "constant" is linear theory up to z = 0 and above it the value there; "wheeler"
        takes the value at z' = h (z - eta)/(h + eta), eta the elevation of the sum there (Wheeler 1970, J. Pet.
        Technol. 22:359). Points below the bottom have the value at the bottom. Raises ValueError for another shape,
        points or a time that are not finite, or another stretching.
        """
        where = check_positions("points", points, 3)
        wheeler = check_choice("stretching", stretching, STRETCHINGS) == "wheeler"
        n = len(where)
        flow = Kinematics(np.empty((n, 3)), np.empty((n, 3)), np.empty(n))
        t = check_finite("t", t, "s")
        set_flow(where, t, self.table(), self.depth, self.density, wheeler, *flow)
        return flow


def components_of(waves: Waves, conditions: Conditions) -> Components:
    """The waves of `draw_waves` on water of these conditions: few that hold all of a spectrum's energy, at any depth.

    >>> from sim.ocean import SPECTRA, draw_waves
    >>> conditions = SPECTRA["tma"].conditions(wind_speed=12.0, depth=30.0)
    >>> waves = components_of(draw_waves(SPECTRA["tma"], conditions, 100), conditions)
    >>> waves.kinematics([[0.0, 0.0, -5.0]], t=3.0).velocity.shape
    (1, 3)
    """
    omega = conditions.omega(waves.k)
    return Components(waves.kx, waves.ky, waves.amplitude, omega, waves.phase, conditions.depth, conditions.density)


def components_of_tile(
    k: np.ndarray, h0: np.ndarray, omega: np.ndarray, base: float, conditions: Conditions
) -> Components:
    """The waves of a tile that have an amplitude.

    k: (n,) [rad/m] in FFT order. h0, omega: (n, n) [m], [rad/s], with the phases of time `base` [s].
    """
    there = h0 != 0.0
    h0, omega = h0[there], omega[there]
    kx, ky = (np.broadcast_to(along, there.shape)[there] for along in (k[:, None], k[None, :]))
    phase = (np.angle(h0) + omega * base) / (2.0 * math.pi)
    phase -= np.rint(phase)
    return Components(kx, ky, 2.0 * np.abs(h0), omega, phase, conditions.depth, conditions.density)


@kernel(noalias=True, allocates=False)
def set_flow(points, t, waves, depth, density, wheeler, velocity, acceleration, pressure):
    """Set velocity (n, 3), acceleration (n, 3) and pressure (n,) at points (n, 3) at time t; waves as `table` has them.

    wheeler: whether heights are stretched. depth may be inf. Other kernels may call it with the same arrays each step.
    """
    for p in range(points.shape[0]):
        x, y, z = points[p, 0], points[p, 1], points[p, 2]
        if wheeler:
            eta = 0.0
            for i in range(waves.shape[1]):
                c, _ = cos_sin_turns(waves[0, i] * x + waves[1, i] * y + waves[2, i] - waves[3, i] * t)
                eta += waves[8, i] * c
            z = (z - eta) / (1.0 + eta / depth)
        u, v, w, du, dv, dw, pushed, _ = flow_at(x, y, z, t, waves, depth)
        velocity[p, 0], velocity[p, 1], velocity[p, 2] = u, v, w
        acceleration[p, 0], acceleration[p, 1], acceleration[p, 2] = du, dv, dw
        pressure[p] = density * pushed
