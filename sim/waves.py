"""Linear waves and the water that carries them: the one record of waves, and the one sum over them in double precision.

    >>> waves = Waves(kx=[0.06, 0.0], ky=[0.0, 0.1], amplitude=[1.0, 0.5], phase=[0.0, 1.57], water=Water(depth=60.0))
    >>> flow = waves.kinematics([[0.0, 0.0, 0.0], [0.0, 0.0, -60.0]], t=12.0)
    >>> flow.velocity.shape, flow.acceleration.shape, flow.pressure.shape
    ((2, 3), (2, 3), (2,))
    >>> bool(abs(flow.velocity[1, 2]) < 1e-12)  # at the bottom water moves along it
    True

A wave a cos(theta), theta = k.x - omega t + phase, in water of depth h moves the water at height z (Lamb,
Hydrodynamics, Art. 229)

  along k by u = a omega C cos(theta), upwards by w = a omega S sin(theta), under the pressure
  p = rho a omega^2/k C cos(theta), C = cosh k(z + h)/sinh kh, S = sinh k(z + h)/sinh kh; both are e^(kz) in deep water.

of first order in steepness: the velocity has a potential, the acceleration is du/dt in place, and rho du/dt = -grad p.
Points are places, not labels. Left out are the choppy displacement, of second order here, decay within a period, rings
and slicks.
"""

import dataclasses
import functools
import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sim.jit import kernel
from sim.numerics.root import narrowed
from sim.numerics.turns import cos_sin_turns
from sim.records import equal_to_itself
from sim.validation import (
    argument_error,
    as_array,
    check_choice,
    check_kind,
    check_number,
    check_positions,
    check_vector,
    is_whole_number,
    read_only,
)
from sim.water import Water

STRETCHINGS = ("constant", "wheeler")
MAX_TURN, TURN_RESOLUTION = 1e4, 1e-14  # of the search for the phases of a crest
LONGEST = 1e-12  # [rad/m] in place of a wavenumber of 0
DEEPEST = 40.0  # kz beyond which the motion is under 1e-17 of that at the surface
# Rows of `Waves.table`. k along x and y [turns/m], phase [turns], rate [turns/s], cos and sin of the bearing,
# omega/(1 - q) [1/s], q = e^(-2kh), amplitude [m].
KX, KY, PHASE, RATE, EAST, NORTH, SPEED, ECHO, AMPLITUDE = range(9)
RESPONSES = 6  # of a body to a wave
DEEP_SEA = Water()


@equal_to_itself
class Kinematics(NamedTuple):
    """The water at n points at one moment."""

    velocity: np.ndarray  # (n, 3) [m/s]
    acceleration: np.ndarray  # (n, 3) [m/s2] in place
    pressure: np.ndarray  # (n,) [Pa] beyond that of still water


@dataclasses.dataclass(frozen=True, eq=False)
class Waves:
    """n waves a cos(k.x - omega t + phase) on one water. Arrays (n,) float64, read-only copies of those given.

    Raises ValueError for arrays that are not finite or not of one shape (n,), and for what is no `Water`.
    """

    kx: np.ndarray  # [rad/m]
    ky: np.ndarray  # [rad/m]
    amplitude: np.ndarray  # [m]
    phase: np.ndarray  # [rad] at t = 0
    omega: np.ndarray = None  # type: ignore[assignment]  # [rad/s]; by default that of gravity waves on the water
    water: Water = DEEP_SEA
    elevation_error: float = 0.0  # [m] root mean square of the elevation of the waves that are left out
    velocity_error: float = 0.0  # [m/s] the same of the vertical velocity at z = 0

    def __post_init__(self) -> None:
        check_kind("water", self.water, Water, "a Water")
        for name in ("kx", "ky", "amplitude", "phase", "omega"):
            numbers = getattr(self, name)
            if name == "omega" and numbers is None:
                numbers = self.water.omega(self.k)
            allowed = "finite numbers of shape (n,), as many as of kx"
            values = as_array(name, numbers, allowed)
            object.__setattr__(self, name, read_only(values))
            if values.ndim != 1 or values.shape != self.kx.shape or not np.isfinite(values).all():
                raise argument_error(name, values if values.ndim == 1 else values.shape, allowed)

    def __reduce__(self) -> tuple[type["Waves"], tuple[Any, ...]]:
        """Pickle the fields alone, so that their copies are read-only too."""
        return Waves, tuple(getattr(self, field.name) for field in dataclasses.fields(self))

    @functools.cached_property
    def k(self) -> np.ndarray:
        """Wavenumber (n,) [rad/m]."""
        return read_only(np.hypot(self.kx, self.ky))

    @property
    def significant_height(self) -> float:
        """Hs = 4 sqrt(sum a^2/2) [m]."""
        return 4.0 * math.sqrt(0.5 * float(np.square(self.amplitude).sum()))

    def largest(self, count: int) -> "Waves":
        """The `count` highest of these waves; the errors then include the omitted waves. Raises ValueError for a count
        that is not whole or below 1."""
        if not is_whole_number(count) or count < 1:
            raise argument_error("count", count, "a whole number of at least 1")
        order = np.argsort(-self.amplitude, kind="stable")
        highest, left = order[:count], order[count:]
        squares = 0.5 * np.square(self.amplitude[left])
        return dataclasses.replace(
            self,
            **{name: getattr(self, name)[highest] for name in ("kx", "ky", "amplitude", "omega", "phase")},
            elevation_error=math.sqrt(self.elevation_error**2 + float(squares.sum())),
            velocity_error=math.sqrt(self.velocity_error**2 + float((squares * self.omega[left] ** 2).sum())),
        )

    def with_crest(self, height: float, place: tuple[float, float], t: float) -> "Waves":
        """The waves with a linear crest of this height [m] at a place (x, y) [m] at time t [s].

        Amplitudes stay, and so does Hs. Phases follow the gradient of the height there, as far as needed: a wave turns
        in proportion to its amplitude, so that in the mean a group of the form of NewWave is added (Tromans, Anaturk
        and Hagemeijer 1991, Proc. ISOPE 3:64). Raises ValueError for a height that these amplitudes cannot have.
        """
        x, y = check_vector("place", place, "m", 2)
        theta = self.phase + self.kx * x + self.ky * y - self.omega * check_number("t", t, "s")
        highest = float(self.amplitude.sum())
        height = check_number("height", height, "m", -0.99 * highest, 0.99 * highest)
        largest = max(float(self.amplitude.max(initial=0.0)), 1e-300)
        half = np.tan(0.5 * theta)

        def turned(s: float) -> np.ndarray:
            """Phases after the flow theta' = -a sin(theta) for s/largest, which scales tan(theta/2)."""
            return 2.0 * np.arctan(np.exp(np.clip(-s / largest * self.amplitude, -300.0, 300.0)) * half)

        def excess(s: float) -> float:
            return float((self.amplitude * np.cos(turned(s))).sum()) - height

        angles = turned(narrowed(excess, -MAX_TURN, MAX_TURN, TURN_RESOLUTION)[1])
        return dataclasses.replace(self, phase=self.phase - theta + angles)

    @functools.cached_property
    def table(self) -> np.ndarray:
        """Rows (9, n) for kernels: KX, KY, PHASE, RATE, EAST, NORTH, SPEED, ECHO, AMPLITUDE. Not to be changed."""
        k = np.hypot(self.kx, self.ky)
        level = k == 0.0  # no wave: it moves no water, and stands here as a long one without speed
        kx, k = np.where(level, LONGEST, self.kx), np.where(level, LONGEST, k)
        double = -2.0 * k * self.water.depth
        speed = np.where(level, 0.0, self.omega) / -np.expm1(double)
        turn = 2.0 * math.pi
        rows = (kx / turn, self.ky / turn, self.phase / turn, self.omega / turn, kx / k, self.ky / k)
        return np.array([*rows, speed, np.exp(double), self.amplitude])

    def elevation(self, points: ArrayLike, t: float) -> np.ndarray:
        """Height (n,) [m] of the linear surface above points (n, 2) [m] at time t [s]. Raises ValueError for points of
        another shape or not finite."""
        where = check_positions("points", points)
        elevation = np.empty(len(where))
        set_elevation(where, check_number("t", t, "s"), self.table, elevation)
        return elevation

    def response(self, points: ArrayLike, t: float, X: ArrayLike) -> np.ndarray:
        """Sum of a Re(X exp(i theta)) over the waves, (n, 6), at points (n, 2) [m] at time t [s]; X (waves, 6) complex.

        Raises ValueError for points or X of another shape or not finite.
        """
        where, factors = check_positions("points", points), np.asarray(X, complex)
        if factors.shape != (len(self.kx), RESPONSES) or not np.isfinite(factors).all():
            raise argument_error("X", factors.shape, f"finite numbers of shape ({len(self.kx)}, {RESPONSES})")
        response = np.empty((len(where), RESPONSES))
        rows = np.concatenate([np.real(factors).T, np.imag(factors).T])[None]
        set_response(where, check_number("t", t, "s"), self.table, np.ascontiguousarray(rows), response)
        return response

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
        t = check_number("t", t, "s")
        set_kinematics(where, t, self.table, self.water.depth, self.water.density, wheeler, *flow)
        return flow


class Sums(NamedTuple):
    """Sums over waves at one place."""

    elevation: Any  # [m]
    displacement: Any  # (x, y) [m] of a label of the surface of deep water: -a (k/|k|) sin theta (Lamb, Art. 251)
    slope: Any  # (x, y) of the elevation
    strain: Any  # (xx, yy, xy) derivatives of the displacement
    velocity: Any  # (u, v, w) [m/s]
    acceleration: Any  # (x, y, z) [m/s2]
    pressure: Any  # [m2/s2] over density, beyond that of still water
    response: Any  # six of a Re(X exp(i theta))


@kernel(inline=True)
def exponential(x):
    """e^x for -DEEPEST <= x <= 0 within 1e-13: Taylor's series of x/1024, squared ten times."""
    y = x / 1024.0
    e = 1.0 + y * (1.0 + y / 2.0 * (1.0 + y / 3.0 * (1.0 + y / 4.0 * (1.0 + y / 5.0 * (1.0 + y / 6.0)))))
    e *= e
    e *= e
    e *= e
    e *= e
    e *= e
    e *= e
    e *= e
    e *= e
    e *= e
    return e * e


@kernel(inline=True)
def sums_at(x, y, z, t, waves, amplitudes, row, responses, which, depth):
    """`Sums` at a place at time t. It is expanded into its caller, where the compiler drops unread sums.

    z: None for the resting surface. Above that and below the bottom are the motion and the pressure there.
    waves (9, n): see `Waves.table`.
    amplitudes[row] (n,) [m]: those of the waves at this place, row AMPLITUDE of the table or with factors of the place.
    responses[which] (12, n): real, then imaginary parts of X. None: without responses.
    """
    turn = 2.0 * math.pi
    eta = dx = dy = hx = hy = xx = yy = xy = u = v = w = du = dv = dw = pushed = 0.0
    r0 = r1 = r2 = r3 = r4 = r5 = 0.0
    for i in range(waves.shape[1]):
        kx, ky, nx, ny = waves[KX, i], waves[KY, i], waves[EAST, i], waves[NORTH, i]
        c, s = cos_sin_turns(kx * x + ky * y + waves[PHASE, i] - waves[RATE, i] * t)
        c, s = c * amplitudes[row, i], s * amplitudes[row, i]
        eta += c
        dx -= nx * s
        dy -= ny * s
        hx -= kx * s
        hy -= ky * s
        xx -= nx * kx * c
        yy -= ny * ky * c
        xy -= nx * ky * c
        k = kx * nx + ky * ny  # [turns/m], as rates are in turns/s: factors of 2 pi follow after the loop
        e = 1.0 if z is None else exponential(max(turn * k * min(max(z, -depth), 0.0), -DEEPEST))
        back = waves[ECHO, i] / e
        level, upward = waves[SPEED, i] * (e + back), waves[SPEED, i] * (e - back)
        u += nx * level * c
        v += ny * level * c
        w += upward * s
        du += nx * waves[RATE, i] * level * s
        dv += ny * waves[RATE, i] * level * s
        dw -= waves[RATE, i] * upward * c
        pushed += waves[RATE, i] / k * level * c
        if responses is not None:
            r0 += responses[which, 0, i] * c - responses[which, 6, i] * s
            r1 += responses[which, 1, i] * c - responses[which, 7, i] * s
            r2 += responses[which, 2, i] * c - responses[which, 8, i] * s
            r3 += responses[which, 3, i] * c - responses[which, 9, i] * s
            r4 += responses[which, 4, i] * c - responses[which, 10, i] * s
            r5 += responses[which, 5, i] * c - responses[which, 11, i] * s
    return Sums(
        eta, (dx, dy), (turn * hx, turn * hy), (turn * xx, turn * yy, turn * xy), (u, v, w),
        (turn * du, turn * dv, turn * dw), pushed, (r0, r1, r2, r3, r4, r5),
    )  # fmt: skip


@kernel(noalias=True)
def set_elevation(points, t, waves, out):
    """Set the elevation (n,) at points (n, 2)."""
    for p in range(points.shape[0]):
        out[p] = sums_at(points[p, 0], points[p, 1], None, t, waves, waves, AMPLITUDE, None, 0, 0.0).elevation


@kernel(noalias=True)
def set_response(points, t, waves, responses, out):
    """Set the responses (n, 6) at points (n, 2) to the same factors (1, 12, waves)."""
    for p in range(points.shape[0]):
        sums = sums_at(points[p, 0], points[p, 1], None, t, waves, waves, AMPLITUDE, responses, 0, 0.0)
        out[p, 0], out[p, 1], out[p, 2], out[p, 3], out[p, 4], out[p, 5] = sums.response


@kernel(noalias=True)
def set_kinematics(points, t, waves, depth, density, wheeler, velocity, acceleration, pressure):
    """Set velocity (n, 3), acceleration (n, 3) and pressure (n,) at points (n, 3) at time t; waves as `table` has them.

    wheeler: whether heights are stretched. depth may be inf.
    """
    for p in range(points.shape[0]):
        x, y, z = points[p, 0], points[p, 1], points[p, 2]
        if wheeler:
            eta = sums_at(x, y, z, t, waves, waves, AMPLITUDE, None, 0, depth).elevation
            z = (z - eta) / (1.0 + eta / depth)
        sums = sums_at(x, y, z, t, waves, waves, AMPLITUDE, None, 0, depth)
        velocity[p, 0], velocity[p, 1], velocity[p, 2] = sums.velocity
        acceleration[p, 0], acceleration[p, 1], acceleration[p, 2] = sums.acceleration
        pressure[p] = density * sums.pressure
