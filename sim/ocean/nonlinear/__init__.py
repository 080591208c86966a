"""Waves beyond linear on the periodic tile: `NonlinearSea`, and `stokes_wave` as a start and a reference."""

from sim.ocean.nonlinear.sea import NonlinearSea
from sim.ocean.nonlinear.stokes import stokes_wave

__all__ = ["NonlinearSea", "stokes_wave"]
