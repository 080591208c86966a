"""Waves beyond linear on the periodic tile: `NonlinearSea`, and starts: `stokes_wave`, `breather`, `modulated_waves`.

`stokes_wave` is a reference too.
"""

from sim.ocean.nonlinear.sea import NonlinearSea
from sim.ocean.nonlinear.starts.packets import breather, modulated_waves
from sim.ocean.nonlinear.starts.stokes import stokes_wave

__all__ = ["NonlinearSea", "breather", "modulated_waves", "stokes_wave"]
