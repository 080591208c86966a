"""Quantities of the cloth: its energies, its springs, its strain, the limit of its step."""

import functools
import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.scenes.quantities import Quantities, Quantity, SceneInstant, for_sweeps, for_tasks
from app.scenes.springs.quantities import STABILITY
from sim.springs.analysis.strain import structural_strain
from sim.springs.state import energy

if TYPE_CHECKING:
    from app.scenes.cloth.scene import ClothScene
    from sim.springs.analysis.energy import Energy


class ClothStrain(NamedTuple):
    """The part of a frame that a sweep reads, in double precision."""

    strain: NDArray[np.float64]  # (rows, cols)


class ClothInstant(SceneInstant):
    """The present state of a cloth."""

    scene: "ClothScene"

    @functools.cached_property
    def frame(self) -> ClothStrain:
        """The strain."""
        return ClothStrain(structural_strain(self.scene.net, self.scene.state.x))

    @functools.cached_property
    def energy(self) -> "Energy":
        """Energies [J]."""
        return energy(self.scene.net, self.scene.state)

    @property
    def dissipated(self) -> float:
        """Energy [J] dissipated by damping; NaN if no account was kept."""
        return self.scene.state.dissipated if self.scene.account_kept else math.nan


def straight_links(now: Any, apart: int) -> int:
    """Number of springs along rows and columns between particles this number of places apart."""
    rows, cols = now.frame.strain.shape
    return rows * (cols - apart) + cols * (rows - apart)


QUANTITIES: Quantities = {
    "total_energy": for_sweeps("J", "Energy in all", lambda now: now.energy.total),
    "kinetic_energy": for_sweeps("J", "Kinetic energy", lambda now: now.energy.kinetic),
    "elastic_energy": for_sweeps("J", "Elastic energy of the springs", lambda now: now.energy.elastic),
    "potential_energy": for_sweeps("J", "Potential energy above z = 0", lambda now: now.energy.gravity),
    "contact_energy": for_sweeps("J", "Elastic energy of the contacts", lambda now: now.energy.contact),
    "dissipated_energy": for_sweeps("J", "Energy dissipated by damping since the start", lambda now: now.dissipated),
    "largest_strain": Quantity("%", "Largest strain", lambda now: 100.0 * float(now.frame.strain.max())),
    # A sweep leaves them out: the stability of a large cloth is assessed now and then only.
    **{name: quantity._replace(recorded=False) for name, quantity in STABILITY.items()},
    "particles": for_tasks("1", "Particles", lambda now: now.frame.strain.size),
    "structural_links": for_tasks("1", "Structural springs", lambda now: straight_links(now, 1)),
    "shear_links": for_tasks(
        "1", "Shear springs", lambda now: 2 * math.prod(number - 1 for number in now.frame.strain.shape)
    ),
    "bend_links": for_tasks("1", "Bend springs", lambda now: straight_links(now, 2)),
    "cloth_mass": for_tasks(
        "kg", "Mass of the cloth", lambda now: now.params.density * now.params.width * now.params.length
    ),
}
