"""A sea as a sum of Gerstner waves, drawn on a radial grid and evaluated at points.

    >>> from sim.ocean import SPECTRA, RadialSea, draw_waves
    >>> jonswap = SPECTRA["jonswap"]
    >>> sea = RadialSea(draw_waves(jonswap, jonswap.conditions(wind_speed=8.0), 64), FluidColumn(thickness=0.2))
    >>> sea.at([[0.0, 0.0]], t=12.0).height.shape  # `float_in` takes this sea
    (1,)

A wave shorter than twice the local spacing of the grid is skipped, one up to four times it is faded, so that nothing
pops as the grid moves; `evaluated` and `skipped` count (wave, vertex) pairs. Points have all waves.

Displaced points gather at the crests, so that a fixed place sees each wave choppiness k a^2/2 too low (Lamb, Art. 251).
All points are that much higher, the interface by its share of it: the mean level in place is that of still water.
"""

import copy
import dataclasses
import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from sim.interruption import raise_if_stopped, stop_request
from sim.jit import kernel
from sim.numerics.angles import within_half_turn
from sim.ocean.any_sea import AnySea, RadialSurface, SurfaceAt
from sim.ocean.fluids.fluid_column import FluidColumn
from sim.ocean.fluids.slick import SlickCover
from sim.ocean.radial.band_plan import BandPlan
from sim.ocean.radial.departing_waves import DepartingWaves
from sim.ocean.radial.footprints import Footprints
from sim.ocean.radial.radial_grid import RadialGrid
from sim.ocean.radial.wave_sum import set_mesh
from sim.ocean.tile.query import WaveFields, find_labels
from sim.validation import argument_error, as_array, check_kind, check_number, check_positions
from sim.water import SAME_WATER, Water
from sim.waves import RESPONSES, Kinematics, Waves, sums_at

CLEAN = FluidColumn()
TOLERANCE = 1e-7  # [m] at which a label counts as found


class RadialSea(AnySea):
    """Waves on a medium. Not for two threads at once."""

    is_sum_of_waves = True

    def __init__(
        self, waves: Waves, column: FluidColumn = CLEAN, exposure: float = 0.0, choppiness: float = 1.0
    ) -> None:
        """exposure [s]: time for which the waves have decayed on this medium; choppiness: factor on Gerstner's
        horizontal motion. The column carries the waves: they have the frequencies of the deep fluids in it.
        Raises ValueError for a negative number, other waves or another column, and waves of another depth or gravity.

        `past` [s] is the time spent on each medium. Waves never regain energy that they lost there.
        """
        self.evaluated = self.skipped = 0  # (wave, vertex) pairs
        self._time = 0.0
        self.choppiness = check_number("choppiness", choppiness, "", 0.0)
        self._departing: DepartingWaves | None = None
        self.slick: SlickCover | None = None  # it calms the waves under it
        self._loss: tuple[FluidColumn, np.ndarray, np.ndarray] | None = None  # of the fluids in the slick, k [1/m]
        self.past: dict[FluidColumn, float] = {}
        check_carried(waves, column)
        self._set(waves, column, waves.phase, np.zeros(len(waves.kx)))
        self.expose(exposure)

    def __deepcopy__(self, memo: object) -> "RadialSea":
        """An independent copy; it shares arrays, because only cached results are changed in place."""
        return copy.copy(self)

    def change(
        self, t: float, waves: Waves | None = None, column: FluidColumn | None = None, exposure: float | None = None,
        fade: float = 2.0,
    ) -> None:  # fmt: skip
        """Change the medium or the waves at time t [s]. Phases stay continuous; new waves take over within `fade` [s].

        Lost energy stays lost, also by other waves of the same length. exposure [s]: forget the losses, and apply those
        of so long a time on the new medium. Raises ValueError as the constructor.
        """
        t, fade = check_number("t", t, "s"), check_number("fade", fade, "s", 0.0)
        check_carried(waves or self.waves, column or self.column)
        self._time, past = max(self._time, t), self.past
        if exposure is not None:
            exposure, past = check_number("exposure", exposure, "s", 0.0), {}
        own, loss = self._own, self._lost
        if waves is None:
            self._drop_departed(t)
            loss = loss if exposure is None else np.zeros(len(own.kx))
            self._set(self.waves, column or self.column, phases_at(own, t), loss, t)
        else:
            self._departing = DepartingWaves(own, self.ratio, t, fade)
            self._set(waves, column or self.column, waves.phase, lost(past, waves.k), t)
        self.past = past
        self.expose(exposure or 0.0)

    def _set(self, waves: Waves, column: FluidColumn, phase: np.ndarray, loss: np.ndarray, t: float = 0.0) -> None:
        """phase (n,) [rad] at time t [s]; loss (n,): -ln of the fraction left of their amplitudes."""
        self.waves, self.column, self._lost = waves, column, loss
        k = waves.k
        rate, self.decay = column.roots(k)
        self.ratio = column.interface_ratio(k)
        amplitude = waves.amplitude * np.exp(-loss)
        # Phases at t = 0, within half a turn, in double: a month of seconds leaves an error of 1e-8 rad.
        phase = within_half_turn(phase + rate * t)
        water = Water(math.inf, column.gravity, column.surface.density)
        self._own = Waves(waves.kx, waves.ky, amplitude, phase, rate, water)
        self._loss = None
        self._forget_wavenumbers()
        # Of which waves, and `interface_of` them.
        self._interface: tuple[Waves | None, np.ndarray, np.ndarray] = None, rate, rate

    def _forget_wavenumbers(self) -> None:
        """Clear the cache of the wavenumbers of `waves_at`."""
        self._plan: BandPlan | None = None
        self._footprints: Footprints | None = None

    def expose(self, duration: float) -> None:
        """Let the waves decay at once as in `duration` [s] on this medium; phases stay.

        Raises ValueError for a negative one.
        """
        if check_number("duration", duration, "s", 0.0) > 0.0:
            self.past = self.past | {self.column: self.past.get(self.column, 0.0) + duration}
            self._lost = self._lost + self.decay * duration
            amplitude = self.waves.amplitude * np.exp(-self._lost)
            self._own = dataclasses.replace(self._own, amplitude=amplitude)

    @property
    def time(self) -> float:
        """Time [s] of the last evaluation, or of the last change if that is later."""
        return self._time

    @property
    def water(self) -> Water:
        """The fluid on top, which is deep except for a layer of oil, under the column's gravity."""
        return self._own.water

    @property
    def layers(self) -> tuple[tuple[float, float], ...]:
        """(density [kg/m3], thickness [m]) of the fluids of the column from the top."""
        return self.column.layers

    @property
    def amplitude(self) -> np.ndarray:
        """Present amplitudes (n,) [m] of the decayed waves."""
        return self._own.amplitude

    @property
    def rate(self) -> np.ndarray:
        """Angular frequencies (n,) [rad/s] of the waves on the column."""
        return self._own.omega

    @property
    def significant_height(self) -> float:
        """Hs = 4 sqrt(sum a^2/2) [m] of the decayed waves."""
        return 4.0 * math.sqrt(0.5 * float(np.square(self.amplitude).sum()))

    @property
    def mean_square_slope(self) -> float:
        """sum (ka)^2/2 of the decayed waves."""
        return 0.5 * float(np.square(self.waves.k * self.amplitude).sum())

    def _drop_departed(self, t: float) -> None:
        """Forget the waves that have faded out by time t [s]."""
        if self._departing is not None and self._departing.share_taken(t) >= 1.0:
            self._departing = None
            self._forget_wavenumbers()

    def waves_at(self, t: float | None = None) -> Waves:
        """All waves with their heights at time t [s], by default the sea's own, without slick; fading ones first."""
        self._time = t = self._time if t is None else check_number("t", t, "s")
        self._drop_departed(t)
        return self._own if self._departing is None else self._departing.joined_by(self._own, t)

    def _ratios(self) -> np.ndarray:
        """Height of the interface over the surface's of each of the waves of `waves_at`."""
        return self.ratio if self._departing is None else np.append(self._departing.ratio, self.ratio)

    def losses(self, k: np.ndarray) -> np.ndarray:
        """Loss [1/m] of waves of wavenumber k [rad/m] under the slick; kept while slick and waves stay the same."""
        assert self.slick is not None
        inside = self.slick.column
        if self._loss is None or self._loss[0] != inside or not np.array_equal(self._loss[1], k):
            self._loss = inside, k, self.slick.attenuation(k, self.column)
        return self._loss[2]

    def on(self, grid: RadialGrid, t: float, centre: tuple[float, float] = (0.0, 0.0)) -> RadialSurface:
        """The sea on a grid about `centre` (x, y) [m] at time t [s]."""
        waves, n = self.waves_at(check_number("t", t, "s")), len(grid)
        plan = self._plan
        if plan is None or plan.grid is not grid:
            plan = self._plan = BandPlan(grid, waves.k)
        slick = None if self.slick is None else (self.slick, self.losses(waves.k))
        sums = plan.sums(waves, phases_at(waves, t) / (2.0 * math.pi), self.choppiness, centre, slick)
        self.evaluated += plan.evaluated
        self.skipped += plan.skipped
        vertices, slope = np.empty((n, 3), np.float32), np.empty((n, 2), np.float32)
        jacobian = np.empty(n, np.float32)
        set_mesh(grid.x, grid.y, sums, vertices.reshape(-1), slope.reshape(-1), jacobian)
        if centre != (0.0, 0.0):
            vertices[:, 0] += np.float32(centre[0])
            vertices[:, 1] += np.float32(centre[1])
        return RadialSurface(vertices, slope, jacobian)

    def at(self, points: ArrayLike, t: float, size: ArrayLike = 0.0) -> SurfaceAt:
        """The sea above points (n, 2) [m] at time t [s]; its mean level is that of still water, see above.

        size [m]: one number or one a point: diameter over which the surface is averaged, as a hull of that size feels
        it. Raises ValueError for points of another shape or not finite.
        """
        where = check_positions("points", points)
        n = len(where)
        widths = as_array("size", size, f"one number [m], or {n} of them")
        if widths.shape not in ((), (n,)) or not (widths >= 0.0).all():
            raise argument_error("size", size, f"one number [m], or {n} of them")
        waves = self.waves_at(check_number("t", t, "s"))
        if self._footprints is None:
            self._footprints = Footprints(waves.k)
        weight = self._footprints.factors(np.broadcast_to(widths, (n,)))
        if self.slick is not None:
            weight = weight * np.exp(-self.losses(waves.k) * self.slick.paths(where, waves.kx, waves.ky))
        surface = WaveFields(waves.table, weight * waves.amplitude, float(t), self.choppiness)
        label, residual, sums = np.empty((n, 2)), np.empty(n), np.empty((n, 14))
        find_labels(where, surface, TOLERANCE, stop_request(), label, np.empty(n), residual)
        raise_if_stopped()
        if self._interface[0] is not waves:
            self._interface = waves, *interface_of(waves, self._ratios())
        _, responses, gathered = self._interface
        set_surface(label, surface, responses, sums)
        z, (hx, hy), (a, b, c) = sums[:, 0], sums[:, 1:3].T, sums[:, 3:6].T
        inverse = 1.0 / np.maximum(a * b - c * c, 0.1)
        slope = np.column_stack([(hx * b - hy * c) * inverse, (hy * a - hx * c) * inverse])
        # not by @, whose last digit depends on where the arrays lie
        mean, interface_mean = self.choppiness * (gathered[:, None] * np.square(weight)).sum(axis=2)
        return SurfaceAt(z + mean, slope, sums[:, 6:9].copy(), sums[:, 9].copy(), sums[:, 10] + interface_mean,
                         sums[:, 11:13].copy(), sums[:, 13].copy(), label, residual)  # fmt: skip

    def height_at(self, points: ArrayLike, t: float) -> tuple[np.ndarray, np.ndarray]:
        """Height (n,) [m] of the displaced surface above points (n, 2) [m] at time t [s], and the residual (n,) [m], as
        `Sea.height_at`; `at` also gives the motion. Raises ValueError as `at`."""
        surface = self.at(points, t)
        return surface.height, surface.residual

    def kinematics(self, points: ArrayLike, t: float, stretching: str = "constant") -> Kinematics:
        """Velocity, acceleration and pressure of the water at points (n, 3) [m] at time t [s].

        See `Waves.kinematics`, also for the errors raised. Raises ValueError over a layer of oil, too, under which the
        pressure would need both fluids.
        """
        if self.column.kind == "layer":
            raise argument_error("column", self.column.kind, "clean water or a mixture, which is one fluid")
        return self.waves_at(t).kinematics(points, t, stretching)


def check_carried(waves: Waves, column: FluidColumn) -> None:
    """Raises ValueError for other types than Waves, for shallow water, or under another gravity than the column.

    The column's fluids are deep.
    """
    check_kind("waves", waves, Waves, "Waves, as `draw_waves` draws them")
    check_kind("column", column, FluidColumn, "a FluidColumn")
    if not math.isclose(waves.water.gravity, column.gravity, rel_tol=SAME_WATER):
        allowed = f"those under the column's gravity of {column.gravity:g} m/s2"
        raise argument_error("waves", f"waves on {waves.water}", allowed)
    if len(waves.kx) and not math.isinf(waves.water.depth):
        description = f"waves of water {waves.water.depth:.6g} m deep, on a column inf m deep"
        raise argument_error("waves", description, "those of deep water")


def lost(past: Mapping[FluidColumn, float], k: np.ndarray) -> np.ndarray:
    """-ln of the fraction of amplitude that waves of wavenumber k [rad/m] keep after the times [s] on these media."""
    return sum((column.roots(k)[1] * duration for column, duration in past.items()), np.zeros(k.shape))


def phases_at(waves: Waves, t: float) -> np.ndarray:
    """Phase (n,) [rad], within half a turn, at time t [s] at the origin."""
    return within_half_turn(waves.phase - waves.omega * t)


def interface_of(waves: Waves, ratio: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Height, slope along x and y, and rise of the interface in waves of 1 m, as responses (1, 12, waves) of `sums_at`,
    and the heights (2, waves) [m] of surface and interface that gathered points miss, at a choppiness of 1.

    ratio (waves,): interface over surface.
    """
    missed = 0.5 * waves.k * np.square(waves.amplitude)
    responses = np.zeros((1, 2 * RESPONSES, len(ratio)))
    responses[0, 0], responses[0, RESPONSES + 1], responses[0, RESPONSES + 2] = (
        ratio,
        ratio * waves.kx,
        ratio * waves.ky,
    )
    responses[0, RESPONSES + 3] = -ratio * waves.omega
    return responses, np.stack([missed, ratio * missed])


@kernel(noalias=True)
def set_surface(labels, surface, responses, out):
    """Set the sums at labels (n, 2) of the resting surface, without mean: out (n, 14).

    Columns: elevation, slope (2), 1 + strains (3), velocity (3), upward acceleration, responses (4).
    """
    s = surface
    for p in range(labels.shape[0]):
        sums = sums_at(labels[p, 0], labels[p, 1], None, s.t, s.waves, s.amplitudes, p, responses, 0, np.inf)
        out[p, 0] = sums.elevation
        out[p, 1], out[p, 2] = sums.slope
        xx, yy, xy = sums.strain
        out[p, 3], out[p, 4], out[p, 5] = 1.0 + s.choppiness * xx, 1.0 + s.choppiness * yy, s.choppiness * xy
        out[p, 6], out[p, 7], out[p, 8] = sums.velocity
        out[p, 9] = sums.acceleration[2]
        out[p, 10], out[p, 11], out[p, 12], out[p, 13], _, _ = sums.response
