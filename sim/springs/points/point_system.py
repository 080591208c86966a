"""`PointSystem`: a net of springs or mooring lines, as the kernels of this package move it."""

import abc
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from sim.springs.integrators import Integrator
from sim.validation import check_kind

RunT = TypeVar("RunT", covariant=True)  # the record of a run: `Run` of a net, `MooringRun` of a mooring


class PointSystem(abc.ABC, Generic[RunT]):
    """Points with masses and the forces on them: a `Net`, or a `System` of sim.mooring."""

    @abc.abstractmethod
    def kernel_view(self, h: float) -> Any:
        """The kernels' record for steps of h [s], see `arrays` and `line_arrays` in this folder."""

    @property
    @abc.abstractmethod
    def state_shape(self) -> tuple[int, ...]:
        """The shape of positions: (3, rows, cols) of a net, (3, n) of lines."""

    @abc.abstractmethod
    def start(self) -> NDArray[np.float64]:
        """Positions [m] of `state_shape` at the start of a motion: as a net was built, or the rest of lines."""

    @property
    @abc.abstractmethod
    def evaluation_cost(self) -> float:
        """Time that one evaluation of the forces on all points takes, over that of one point of a rope."""

    @abc.abstractmethod
    def check_integrator(self, integrator: Integrator) -> None:
        """Raises ValueError for an integrator that cannot advance the system."""


def check_system(system: object) -> None:
    """Raises ValueError for anything but a net or a mooring."""
    allowed = "a Net, as `rope` and `cloth` make them, or a System, as `read_moordyn` makes it"
    check_kind("system", system, PointSystem, allowed)
