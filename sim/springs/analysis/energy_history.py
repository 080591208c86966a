"""`EnergyHistory`: the energies of a run by name."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sim.records import equal_to_itself


@equal_to_itself
class EnergyHistory(NamedTuple):
    """Energies (frames,) [J] of a run; NaN after it has diverged.

    Without an account `dissipated` and `work` are 0 where nothing damps or moves a pin, else NaN: not known.
    """

    kinetic: NDArray[np.float64]
    elastic: NDArray[np.float64]
    gravity: NDArray[np.float64]
    contact: NDArray[np.float64]
    dissipated: NDArray[np.float64]  # by damping since the account of the state began
    work: NDArray[np.float64]  # put in since then, by pins, wind, waves and other moved things

    @property
    def total(self) -> NDArray[np.float64]:
        """Stored energy (frames,) [J]."""
        return self.kinetic + self.elastic + self.gravity + self.contact

    @property
    def error(self) -> NDArray[np.float64]:
        """Numerical error (frames,) [J]: stored and dissipated energy that nothing put in."""
        balance = self.total + self.dissipated - self.work
        return balance - balance[0]


def energy_history(ledger: NDArray[np.float64], is_known: bool) -> EnergyHistory:
    """The record of rows (frames, 6). is_known: whether dissipation and work were accounted for."""
    if not is_known:
        ledger[:, 4:] = np.nan
    return EnergyHistory(*np.ascontiguousarray(ledger.T))
