"""The energy account of a nonlinear sea."""

import dataclasses
from typing import NamedTuple


class SeaEnergy(NamedTuple):
    """Mean energy per area [J/m2] of a nonlinear sea. kinetic + potential + breaking = start + fade_in + error."""

    kinetic: float
    potential: float
    breaking: float  # lost so far to the damping of breaking waves
    fade_in: float  # brought so far by the fading in of the nonlinear terms
    error: float  # of the steps, since the fade-in ended


@dataclasses.dataclass(frozen=True)
class EnergyBalance:
    """Energy of the waves at the start, and its gains and losses since [J/m2]."""

    start: float
    fade_in: float | None  # gained by the fade-in, None until it is over
    lost: float = 0.0  # to breaking, before the last change of the grid

    def account(self, kinetic: float, potential: float, lost: float) -> SeaEnergy:
        """The account of waves that have these energies, and have lost so much since the last change of the grid."""
        breaking = self.lost + lost
        change = kinetic + potential + breaking - self.start
        fade_in = change if self.fade_in is None else self.fade_in
        return SeaEnergy(kinetic, potential, breaking, fade_in, change - fade_in)
