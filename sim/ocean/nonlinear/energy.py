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
    """What the waves had at the start, and what they have gained and lost since [J/m2]."""

    start: float
    fade_in: float | None  # gained by the fade-in, None until it is over
    lost: float = 0.0  # so far
    lost_before: float = 0.0  # before the last change of the grid

    def with_loss(self, lost: float) -> "EnergyBalance":
        """The balance after a loss since the last change of the grid."""
        return dataclasses.replace(self, lost=self.lost_before + lost)

    def after_fade_in(self, energy: float) -> "EnergyBalance":
        """The balance at the end of the fade-in, when the waves have this energy."""
        return dataclasses.replace(self, fade_in=self.change(energy))

    def on_another_grid(self) -> "EnergyBalance":
        """The balance at a change of the grid."""
        return dataclasses.replace(self, lost_before=self.lost)

    def change(self, energy: float) -> float:
        """What waves of this energy have gained since the start."""
        return energy + self.lost - self.start

    def account(self, kinetic: float, potential: float) -> SeaEnergy:
        """The account of waves that have these energies."""
        change = self.change(kinetic + potential)
        fade_in = change if self.fade_in is None else self.fade_in
        return SeaEnergy(kinetic, potential, self.lost, fade_in, change - fade_in)
