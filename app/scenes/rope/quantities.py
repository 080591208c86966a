"""Quantities of the rope: tip, tension, energies and their balance, limits of its step and stiffness, its contact."""

import functools
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.scenes.quantities import Quantities, Quantity, SceneInstant, for_sweeps, for_tasks
from app.scenes.rope.frame import RopeReadings
from app.scenes.rope.parameters import RopeParams
from app.scenes.springs.quantities import STABILITY
from app.scenes.springs.rope_parameters import ROPE_RADIUS, link_and_point
from sim.springs.state import energy, velocities

if TYPE_CHECKING:
    from app.scenes.rope.scene import RopeScene
    from sim.springs.analysis.energy import Energy


class RopeShape(NamedTuple):
    """The parts of a frame that a sweep reads, in double precision."""

    points: NDArray[np.float64]  # (n, 3) [m]
    tension: NDArray[np.float64]  # (n - 1,) [N]


class RopeInstant(SceneInstant):
    """The present state of a rope."""

    scene: "RopeScene"

    @functools.cached_property
    def frame(self) -> RopeShape:
        """Points and tension."""
        return RopeShape(self.scene.state.x[:, 0].T, self.scene.tension())

    @functools.cached_property
    def readings(self) -> RopeReadings:
        """The readings, newly assessed: those of the scene are up to half a second old."""
        self.scene.assess_stability()
        return self.scene.readings()

    @functools.cached_property
    def energy(self) -> "Energy":
        """Energies [J]."""
        return energy(self.scene.net, self.scene.state)

    @property
    def gained(self) -> float:
        """Potential energy [J] gained since the start."""
        return self.energy.gravity - self.scene.motion.account.initial.gravity

    @property
    def tip_speed(self) -> float:
        """Speed [m/s] of the tip."""
        return float(np.linalg.norm(velocities(self.scene.net, self.scene.state)[:, 0, -1]))


def carried_weight(p: RopeParams) -> float:
    """Weight [N] of the rope that the top spring carries at rest."""
    return float(np.broadcast_to(link_and_point(p)["mass"], p.points)[1:].sum()) * p.gravity


def largest_stiffness(now: Any) -> float:
    """Largest stable stiffness [N/m] of a link."""
    p, readings = now.params, now.readings
    rest = p.length / (p.points - 1)
    return readings.largest_stiffness / (rest if readings.parameter == "axial_stiffness" else 1.0)


def top_stretch(now: Any) -> float:
    """Stretch [m] of the top spring."""
    p, points = now.params, now.frame.points[:2].astype(float)
    return float(np.linalg.norm(points[1] - points[0])) - p.length / (p.points - 1)


def contact_depth(now: Any) -> float | None:
    """Depth [m] of the deepest point in the sphere; None without a sphere."""
    if now.frame.sphere is None:
        return None
    *centre, radius = now.frame.sphere
    gap = float(np.linalg.norm(now.frame.points.astype(float) - centre, axis=1).min())
    return max(radius + ROPE_RADIUS - gap, 0.0)


def contact_force(now: Any) -> float | None:
    """Force [N] of the spring at the deepest point; None without a sphere."""
    depth = contact_depth(now)
    return None if depth is None else now.params.contact_stiffness * depth


QUANTITIES: Quantities = {
    "tip_height": Quantity("m", "Height of the tip", lambda now: float(now.frame.points[-1, 2])),
    "tip_speed": for_sweeps("m/s", "Speed of the tip", lambda now: now.tip_speed),
    "largest_tension": Quantity("N", "Largest tension", lambda now: float(now.frame.tension.max())),
    "kinetic_energy": for_sweeps("J", "Kinetic energy", lambda now: now.energy.kinetic),
    "elastic_energy": for_sweeps("J", "Elastic energy of the links", lambda now: now.energy.elastic),
    "gravity_energy": for_sweeps("J", "Potential energy gained since the start", lambda now: now.gained),
    "contact_energy": for_sweeps("J", "Elastic energy of the contacts", lambda now: now.energy.contact),
    "dissipated_energy": for_sweeps(
        "J", "Energy dissipated by damping since the start", lambda now: now.scene.state.dissipated
    ),
    "energy_error": for_sweeps(
        "J",
        "Numerical error of the energy since the start",
        lambda now: now.scene.motion.energy_error(),
    ),
    **STABILITY,
    "largest_stiffness": Quantity("N/m", "Largest stable stiffness of a link", largest_stiffness),
    "link_stiffness": for_tasks("N/m", "Stiffness of a link", lambda now: link_and_point(now.params)["stiffness"]),
    "carried_weight": for_tasks(
        "N", "Weight that the top spring carries at rest", lambda now: carried_weight(now.params)
    ),
    "top_stretch_at_rest": for_tasks(
        "m",
        "Stretch of the top spring at rest",
        lambda now: carried_weight(now.params) / link_and_point(now.params)["stiffness"],
    ),
    "top_stretch": for_tasks("m", "Stretch of the top spring", top_stretch),
    "contact_depth": for_tasks("m", "Depth of the deepest point in the sphere", contact_depth),
    "contact_force": for_tasks("N", "Force of its spring", contact_force),
}
