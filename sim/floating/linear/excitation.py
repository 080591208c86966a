"""The force of a sum of waves on floating hulls, beyond the pressure of the plane that `step` puts under each of them.

Linear theory gives a hull the force a Re(X exp(i (k.x - w t))) in a wave of height a, with X from boundary elements:
the pressure of the undisturbed wave over the whole hull (Froude-Krylov) and the waves that the hull scatters. `step`
applies the pressure under a plane at the height of the wave, averaged over the hull; to first order that is
X_plane, found here from the hull itself. The difference D = X - X_plane is summed over the waves. Small motions are
therefore those of linear theory, whatever the length of the wave beside the hull, and large ones follow the surface.
"""

import copy
import math
from collections.abc import Sequence

import numpy as np

from sim.floating.linear.hydrodynamics import DIRECTIONS, YAW, afloat
from sim.floating.motion.body import Body, Fleet
from sim.floating.motion.rotation import axes_of, four, heading_angle, heading_of
from sim.floating.statics.equilibrium import SEA_WATER, Layers, check_layers
from sim.interruption import raise_if_stopped
from sim.jit import kernel
from sim.numerics.angles import within_half_turn
from sim.ocean.radial.gerstner import widened
from sim.validation import argument_error
from sim.waves import AMPLITUDE, RESPONSES, Waves, sums_at

HEADING_TOLERANCE = 0.02  # [rad] that a hull turns before the directions of waves on it are updated
LAST_RATES = (15 / 8, -10 / 8, 3 / 8)  # weights of the last three rates of change, for that half a step after them
CREEPING = 0.1  # of sqrt(g k), below which a wave in viscous fluids only sinks away, and does nothing upward here


class WaveExcitation:
    """The excitation of a fleet by a sum of waves."""

    def __init__(self, bodies: Sequence[Body], widths: np.ndarray, layers: Layers = SEA_WATER) -> None:
        """bodies as in `make_fleet`; widths (n,) [m]: over which the surface at each is averaged in `RadialSea.at`."""
        fluids = check_layers(layers)
        keys = [(*body.loaded(), float(width)) for body, width in zip(bodies, widths, strict=True)]
        unique = list(dict.fromkeys(keys))
        self.kinds = [afloat(hull, rho, fluids).linear for hull, rho, _ in unique]
        self.widths = [width for _, _, width in unique]
        self.kind = np.array([unique.index(key) for key in keys], dtype=np.int64)
        self.is_round = np.array([kind.is_round for kind in self.kinds], dtype=bool)
        planes = [np.vstack([kind.plane.rise, kind.plane.slope]) for kind in self.kinds]
        self.planes = np.array(planes).reshape(len(self.kinds), 3, 6)
        forces = [kind.long for kind in self.kinds]
        longs = [np.vstack([one.rise, one.lift, one.run, one.twist * YAW]) for one in forces]
        self.longs = np.array(longs).reshape(len(self.kinds), 5, 6)
        self.kx = self.ky = np.zeros(0)
        self.heading = np.full(len(keys), np.inf)  # (n,) [rad] for which the responses were taken
        self.omega = np.zeros(0)
        self.responses = np.zeros((len(keys), 2 * RESPONSES, 0))
        self.impulses: tuple[np.ndarray, ...] = ()  # (n,) [m3 times m/s] upward at the last calls, the newest first

    def __deepcopy__(self, memo: object) -> "WaveExcitation":
        """An independent copy: only headings and responses are ever changed in place."""
        other = copy.copy(self)
        other.heading, other.responses = self.heading.copy(), self.responses.copy()
        return other

    def forces(self, fleet: Fleet, labels: np.ndarray, waves: Waves, t: float, h: float) -> np.ndarray:
        """Force and moment (n, 6) on each body at unit density, in the axes of the world, for the next step of h [s].

        labels (n, 2) [m]: where the bodies are on the resting surface at time t [s], the middle of the step.

        The upward force is the change of the impulse sum a Re(i D/w exp(i theta)) along the body's path, and so has no
        mean. In linear theory the force at a fixed place has no mean. At a place that moves with the waves its mean is
        of second order, and a small body that follows the water does not feel it.

        Raises ValueError for a hull with a dataset of one heading, in waves of another.
        """
        k, gravity = waves.k, waves.water.gravity
        if not (np.array_equal(waves.kx, self.kx) and np.array_equal(waves.ky, self.ky)):
            self.kx, self.ky, self.impulses = waves.kx.copy(), waves.ky.copy(), ()
            self.check_headings(fleet, waves.kx, waves.ky, waves.amplitude)
            pairs = [kind.beyond_long_waves(k) for kind in self.kinds]
            self.tables = np.array([rest for rest, _ in pairs]).reshape(len(pairs), len(k), len(DIRECTIONS), 6)
            self.is_long = np.array([is_long for _, is_long in pairs]).reshape(len(pairs), len(k))
            self.averaged = np.array([widened(k, width) for width in self.widths]).reshape(len(self.kinds), len(k))
            self.omega = np.zeros(0)
            self.responses = np.zeros((len(self.kind), 2 * RESPONSES, len(k)))
            raise_if_stopped()
        if not np.array_equal(waves.omega, self.omega):  # of other fluids
            self.omega = waves.omega.copy()
            self.heading[:] = np.inf
        runs = waves.omega > CREEPING * np.sqrt(gravity * k)
        inverse = np.divide(1.0, waves.omega, out=np.zeros_like(k), where=runs)
        set_responses(
            fleet.rotation, self.kind, self.is_round, self.heading, self.kx, self.ky, inverse, gravity, self.tables,
            self.is_long, self.longs, self.averaged, self.planes, self.responses,
        )  # fmt: skip
        raise_if_stopped()
        out = np.empty((len(self.kind), RESPONSES))
        set_forces(labels, t, waves.table, self.responses, out)
        if not self.impulses:  # as if the bodies had been here
            earlier = [np.empty_like(out) for _ in LAST_RATES]
            for step, one in enumerate(earlier, start=1):
                set_forces(labels, t - step * h, waves.table, self.responses, one)
            self.impulses = tuple(one[:, 2] for one in earlier)
        self.impulses = (out[:, 2].copy(), *self.impulses[: len(LAST_RATES)])
        out[:, 2] = rate_of_change(self.impulses, h)
        return out

    def check_headings(self, fleet: Fleet, kx: np.ndarray, ky: np.ndarray, amplitude: np.ndarray) -> None:
        """Raises ValueError for a hull with coefficients of one heading, in waves of another."""
        bearing = np.arctan2(ky, kx)[amplitude > 0.0]
        for b, q in enumerate(self.kind):
            heading = self.kinds[q].heading
            away = np.abs(within_half_turn(bearing - heading_angle(fleet.rotation[b]) - heading))
            if (away > HEADING_TOLERANCE).any():  # False for nan: all headings
                description = (
                    f"a hull with a dataset of {heading:.4g} rad only, in waves up to {away.max():.3g} rad from that"
                )
                allowed = "waves of that heading, or a dataset of headings all around"
                raise argument_error(f"bodies[{b}]", description, allowed)


def rate_of_change(values: Sequence[np.ndarray], h: float) -> np.ndarray:
    """Rate of change at the first of values (n,), each of them h [s] older than the one before.

    Its sum over many steps is the change of the value itself. Needs one value more than LAST_RATES.
    """
    changes = zip(LAST_RATES, values[:-1], values[1:], strict=True)
    return np.sum([weight * (new - old) for weight, new, old in changes], axis=0) / h


@kernel
def set_responses(
    rotation, kind, is_round, heading, kx, ky, inverse, gravity, tables, is_long, longs, averaged, planes, responses
):
    """Set responses (n, 12, waves) of `sums_at` of the bodies that have turned: gravity D, and i gravity D/w upward.

    inverse (waves,) [s]: 1/w, 0 for waves that creep. tables (kinds, waves, 36, 6) without the long-wave force where
    is_long (kinds, waves), longs (kinds, 5, 6): that force, averaged (kinds, waves), planes (kinds, 3, 6).
    """
    count = tables.shape[2]
    spacing = 2.0 * math.pi / count
    D = np.empty(6, np.complex128)
    for b in range(kind.size):
        c, s = heading_of(axes_of(four(rotation, b)))
        yaw = 0.0 if is_round[kind[b]] else math.atan2(s, c)
        turned = yaw - heading[b]
        if abs(math.atan2(math.sin(turned), math.cos(turned))) < HEADING_TOLERANCE and np.isfinite(heading[b]):
            continue
        heading[b] = yaw
        c, s = math.cos(yaw), math.sin(yaw)
        q = kind[b]
        for i in range(kx.size):
            along, across = c * kx[i] + s * ky[i], c * ky[i] - s * kx[i]
            k, u = math.hypot(along, across), math.atan2(across, along) / spacing
            first = math.floor(u)
            t = u - first
            # the cubic through four directions
            a0, a1 = -t * (t - 1.0) * (t - 2.0) / 6.0, (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0
            a2, a3 = -(t + 1.0) * t * (t - 2.0) / 2.0, (t + 1.0) * t * (t - 1.0) / 6.0
            j = int(first)
            j0, j1, j2, j3 = (j - 1) % count, j % count, (j + 1) % count, (j + 2) % count
            for d in range(6):
                X = a0 * tables[q, i, j0, d] + a1 * tables[q, i, j1, d]
                X += a2 * tables[q, i, j2, d] + a3 * tables[q, i, j3, d]
                if is_long[q, i]:
                    X += longs[q, 0, d] + k * longs[q, 1, d]
                    X += 1j * (along * longs[q, 2, d] + across * longs[q, 3, d]) + along * across * longs[q, 4, d]
                plane = planes[q, 0, d] + 1j * (along * planes[q, 1, d] + across * planes[q, 2, d])
                D[d] = X - averaged[q, i] * plane
            for d in range(2):
                first_part, second_part = D[3 * d], D[3 * d + 1]
                D[3 * d], D[3 * d + 1] = c * first_part - s * second_part, s * first_part + c * second_part
            D[2] *= 1j * inverse[i]
            for d in range(6):
                responses[b, d, i], responses[b, 6 + d, i] = gravity * D[d].real, gravity * D[d].imag


@kernel(noalias=True)
def set_forces(labels, t, waves, responses, out):
    """Set the response (n, 6) of each body at its label (n, 2) to the waves at time t."""
    for b in range(labels.shape[0]):
        sums = sums_at(labels[b, 0], labels[b, 1], None, t, waves, waves, AMPLITUDE, responses, b, np.inf)
        out[b, 0], out[b, 1], out[b, 2], out[b, 3], out[b, 4], out[b, 5] = sums.response
