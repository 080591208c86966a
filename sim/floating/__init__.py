"""Floating bodies: hulls, where they float, and how they move in one or two fluids under waves."""

from sim.floating.hulls.hull import Hull, shape_from_file
from sim.floating.linear.dataset import with_dataset
from sim.floating.linear.excitation import WaveExcitation
from sim.floating.linear.periods import heave_period, roll_period
from sim.floating.linear.response import LinearForces, linear_forces, response_amplitude
from sim.floating.motion.body import Body, Fleet, lowest, make_fleet, pull, vertices
from sim.floating.motion.float_in import FloatRun, FloatState, float_in
from sim.floating.motion.fluid_state import FluidState, make_water, still_water
from sim.floating.motion.heave_meter import HeaveMeter
from sim.floating.motion.motion import MotionCoefficients, step
from sim.floating.shapes import SHAPES, Shape
from sim.floating.statics.equilibrium import equilibrium_draft
from sim.floating.statics.hydrostatics import Submerged, pressure_force, submerged
from sim.floating.statics.prediction import HydrostaticPrediction, predict
from sim.floating.statics.righting import metacentric_height, righting_arm

__all__ = [
    "SHAPES", "Body", "Fleet", "FloatRun", "FloatState", "FluidState", "HeaveMeter", "Hull", "HydrostaticPrediction",
    "LinearForces", "MotionCoefficients", "Shape", "Submerged", "WaveExcitation", "equilibrium_draft", "float_in",
    "heave_period", "linear_forces", "lowest", "make_fleet", "make_water", "metacentric_height", "predict",
    "pressure_force", "pull", "response_amplitude", "righting_arm", "roll_period", "shape_from_file", "step",
    "still_water", "submerged", "vertices", "with_dataset",
]  # fmt: skip
