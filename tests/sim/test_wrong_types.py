"""Arguments of a wrong type, of every public function: one ValueError each with the name, the value, the allowed."""

import inspect
import math
import re
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest

from sim import floating, springs
from sim.ocean import SPECTRA, RadialSea, Sea, dispersion, draw_waves, zero_crossings
from sim.ocean.nonlinear import NonlinearSea, stokes_wave
from sim.ocean.planets import gravity_of
from sim.ocean.statistics.statistics import beaufort
from sim.ocean.weathering import Spill, weather
from sim.particles.fire import Fire
from sim.particles.jet import Jet
from sim.particles.plume import flame_height
from sim.particles.rain import Rain, rainfall, terminal_speed
from sim.springs.statics import catenary, equilibrium


class Odd:
    """Nothing that any function takes."""

    def __repr__(self) -> str:
        return "Odd()"


WRONG = ("1", b"1", 1j, math.nan, True, None, Odd(), [Odd()])
PATTERN = r"^(bodies\[0\]\.)?{}(\[0\])?: .* is not allowed; allowed: \S"
NET = springs.rope(4)
BOX = floating.Hull.box(1.0, 1.0, 1.0)
BODY = floating.Body(BOX)
FLEET = floating.make_fleet([BODY])
SEA = Sea(16, 50.0)
POND = Sea(16, 50.0, wind_speed=0.0)
LEVEL = np.zeros((8, 1)), np.zeros((8, 1))
STEEP = NonlinearSea(length=50.0, start=LEVEL)
JONSWAP = SPECTRA["jonswap"]
WAVES = RadialSea(draw_waves(JONSWAP, JONSWAP.conditions(), 4))
ORIGIN, UPRIGHT, STILL = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), ((1025.0, math.inf),)


def afloat(**of_body: Any) -> None:
    floating.Body(**of_body).afloat()


def fleet(**of_body: Any) -> None:
    floating.make_fleet([floating.Body(**of_body)])


class Call(NamedTuple):
    """A function, arguments that it takes, and some that this table leaves out."""

    function: Callable[..., object]
    right: dict[str, Any]
    left_out: tuple[str, ...] = ()


def call(function: Callable[..., object], left_out: tuple[str, ...] = (), **right: Any) -> Call:
    """All arguments by their defaults, but for `right`."""
    given = inspect.signature(function).parameters.values()
    defaults = {p.name: p.default for p in given if p.default is not p.empty}
    return Call(function, defaults | right, left_out)


LOAD = {"hull": BOX, "density": None, "mass": None, "center_of_gravity": None, "inertia": None}
POSE = {"position": ORIGIN, "rotation": UPRIGHT, "velocity": ORIGIN, "spin": ORIGIN}
CALLS = (
    call(springs.rope), call(springs.cloth, rows=4, cols=4), call(springs.simulate, system=NET),
    call(springs.critical_step, system=NET, integrator="rk4"), call(springs.State.at_rest, system=NET),
    call(springs.advance, system=NET, state=springs.State.at_rest(NET), integrator="rk4", h=0.01, steps=1),
    call(springs.lab_units, points=4, length=1.0, axial_stiffness=1.0, mass_per_length=1.0, axial_viscosity=1.0,
         drag_per_length=1.0),
    call(catenary, points=5, length=2.0, span=1.0, rise=0.0, stiffness=8.0, mass=1.0, gravity=10.0),
    call(Sea, size=16, length=50.0, spectrum="jonswap", fetch=1e5, density=1025.0, film=False, spreading="cos2"),
    call(SEA.surface, t=0.0), call(SEA.height_at, points=[[0.0, 0.0]], t=0.0), call(SEA.waves_at),
    call(SEA.kinematics, points=[[0.0, 0.0, -1.0]], t=0.0), call(SEA.expose, duration=0.0), call(SEA.resized, size=16),
    call(SEA.significant_height_at, t=0.0), call(POND.change, t=0.0),
    call(POND.ripples.add, t=0.0, points=[[1.0, 1.0]], width=1.0),
    call(NonlinearSea, length=50.0, start=LEVEL), call(stokes_wave, height=1.0, wavelength=50.0),
    call(STEEP.advance, t=0.0), call(STEEP.kinematics, points=[[0.0, 0.0, -1.0]]),
    call(JONSWAP.frequency_density, omega=1.0), call(JONSWAP.moments), call(JONSWAP.conditions),
    call(Rain, rate=5.0, length=10.0, ceiling=20.0), call(Fire, position=ORIGIN),
    call(Jet, nozzle=ORIGIN, velocity=(1.0, 0.0, 3.0)),
    call(zero_crossings, t=[0.0, 1.0], height=[0.0, 1.0]),
    call(draw_waves, spectrum=JONSWAP, count=4),
    call(WAVES.at, points=[[0.0, 0.0]], t=0.0), call(WAVES.kinematics, points=[[0.0, 0.0, 0.0]], t=0.0),
    call(dispersion.omega, k=1.0), call(dispersion.phase_speed, k=1.0), call(dispersion.group_speed, k=1.0),
    call(dispersion.two_layer, k=1.0, upper_density=850.0, thickness=1.0, lower_density=1025.0),
    call(dispersion.viscous_root, k=1.0, viscosity=1e-6),
    call(dispersion.viscous_two_layer, k=1.0, upper_density=850.0, upper_viscosity=1e-2, thickness=1.0,
         lower_density=1025.0, lower_viscosity=1e-3),
    call(gravity_of, mass=1.0), call(beaufort, wind_speed=1.0), call(Spill), call(weather, spill=Spill()),
    call(weather(Spill()).at, hours=1.0),
    call(floating.Hull.box, x=1.0, y=1.0, z=1.0), call(floating.Hull.sphere, radius=1.0),
    call(floating.Hull.cylinder, radius=1.0, height=1.0),
    call(floating.Hull.from_arrays, ("name",), vertices=BOX.vertices, faces=BOX.faces),
    Call(afloat, LOAD | POSE), Call(fleet, LOAD | POSE), call(BODY.afloat), call(floating.make_fleet, bodies=[BODY]),
    call(floating.metacentric_height, body=BODY), call(floating.righting_arm, body=BODY, heel=0.1),
    call(floating.response_amplitude, body=BODY, frequency=[1.0]),
    call(floating.float_in, sea=SEA, bodies=[BODY], duration=0.1, frames=2),
    call(floating.equilibrium_draft, hull=BOX, density=500.0), call(floating.heave_period, hull=BOX, density=500.0),
    call(floating.roll_period, hull=BOX, density=500.0),
    call(floating.predict, hull=BOX, density=500.0, layers=STILL, water_density=1025.0),
    call(floating.submerged, hull=BOX), call(floating.pressure_force, hull=BOX, density=1025.0),
    call(floating.step, fleet=FLEET, water=floating.still_water(FLEET), duration=0.01),
    call(floating.still_water, fleet=FLEET), call(floating.lowest, fleet=FLEET), call(floating.vertices, fleet=FLEET),
    # values of waves are checked by the step that takes them, once for all
    call(floating.make_water, ("height", "acceleration", "interface", "interface_rise", "yaw"), fleet=FLEET,
         layers=STILL, height=np.zeros(1)),
    call(floating.pull, fleet=FLEET, body=0, point=ORIGIN, target=ORIGIN, limit=1.0),
    call(floating.with_dataset, ("body",), hull=BOX, path="none.nc"),
    call(rainfall, rate=1.0), call(terminal_speed, diameter=1e-3), call(flame_height, power=1e6, diameter=1.0),
)  # fmt: skip
# (error's name, call, words of what is allowed) of slips that are easily made
SLIPS: tuple[tuple[str, Callable[[], object], str], ...] = (
    ("gravity", lambda: springs.rope(gravity=(0.0, 0.0, -9.81)), "a finite number [m/s"),
    ("stiffness", lambda: springs.rope(stiffness=[800.0] * 9), "a finite number of at least 0 N/m"),
    ("length", lambda: springs.rope(length="2 m"), "a finite number above 0"),
    ("mass", lambda: springs.rope(10, mass=[1.0] * 9), "or 10 of them"),
    ("end", lambda: springs.rope(end=1.0), "3 finite numbers"),
    ("sphere", lambda: springs.rope(sphere=(0.0, 0.0, 0.0)), "4 finite numbers"),
    ("contact", lambda: springs.rope(contact=800.0), "a Contact"),
    ("law", lambda: springs.rope(law="Slack"), "slack"),
    ("rows", lambda: springs.cloth((24, 36)), "a whole number"),
    ("pinned", lambda: springs.cloth(4, 4, pinned="top"), "edge"),
    ("air", lambda: springs.cloth(4, 4, air=(8.0, 0.0, 0.0)), "an Air"),
    ("air.wind", lambda: springs.cloth(4, 4, air=springs.Air(wind=8.0)), "3 finite numbers"),
    ("integrator", lambda: springs.simulate(NET, integrator="RK4"), "rk4"),
    ("integrator", lambda: springs.critical_step("rk4", NET), "rk4"),
    ("x", lambda: springs.simulate(NET, x=NET.x0), "(4, 3)"),
    ("rtol", lambda: springs.simulate(NET, integrator="rk4", rtol=1e-6), "adaptive"),
    ("system", lambda: springs.advance(springs.State.at_rest(NET), NET, "rk4", 0.01, 1), "a Net"),
    ("net", lambda: equilibrium("rope"), "a rope"),
    ("size", lambda: Sea(101), "even"),
    ("size", lambda: Sea((64, 64)), "even"),
    ("spectrum", lambda: Sea(16, spectrum="JONSWAP"), "jonswap"),
    ("hs", lambda: Sea(16, hs=3.0), "it is one of sea_state"),
    ("fetch", lambda: SPECTRA["phillips"].moments(fetch=2e5), "it is one of jonswap"),
    ("wind_speed", lambda: Sea(16, wind_speed=(10.0, 0.0)), "0 to 1000 m/s"),
    ("wind_direction", lambda: Sea(16, wind_direction=90.0), "rad"),
    ("depth", lambda: Sea(16, depth=-20.0), "or inf"),
    ("points", lambda: SEA.height_at((0.0, 0.0), 1.0), "(n, 2)"),
    ("points", lambda: SEA.kinematics([0.0, 0.0, -5.0], 1.0), "(n, 3)"),
    ("t", lambda: SEA.height_at([[0.0, 0.0]], [0.0, 1.0]), "a finite number"),
    ("conditions", lambda: JONSWAP.moments({"wind_speed": 10.0}), "or None"),
    ("waves", lambda: RadialSea(SEA), "draw_waves"),
    ("column", lambda: RadialSea(WAVES.waves, 1025.0), "FluidColumn"),
    ("t", lambda: zero_crossings([2.0, 1.0, 0.0], [0.0, 1.0, 2.0]), "rising"),
    ("body", lambda: floating.metacentric_height(BOX), "a Body"),
    ("heel", lambda: floating.righting_arm(BODY, 30.0), "rad"),
    ("heading", lambda: floating.response_amplitude(BODY, [1.0], heading=90.0), "rad"),
    ("bodies", lambda: floating.float_in(SEA, BODY, 1.0), "a list"),
    ("bodies[0]", lambda: floating.float_in(SEA, [BOX], 1.0), "a Body"),
    ("hull", lambda: floating.equilibrium_draft(BODY, 500.0), "a Hull"),
    ("layers", lambda: BODY.afloat(1025.0), "pairs"),
    ("density", lambda: afloat(hull=BOX, density=2000.0), "at most 1025"),
    ("inertia", lambda: afloat(hull=BOX, mass=500.0, inertia=(1.0, 1.0, 10.0)), "the sum of the other two"),
    ("temperature", lambda: Spill(temperature=288.15), "40 C"),
    ("points", lambda: POND.ripples.add(0.0, (4.0, 4.0), width=0.5, volume=1.0), "(n, 2)"),
)


@pytest.mark.parametrize("one", CALLS, ids=lambda one: one.function.__qualname__)
def test_a_wrong_type_is_refused_by_name(one: Call) -> None:
    for name, right in one.right.items():
        for wrong in WRONG if name not in one.left_out else ():
            if right is wrong or type(right) is type(wrong) is str or (isinstance(right, bool) and wrong is True):
                continue
            with pytest.raises(ValueError, match=PATTERN.format(name)) as error:
                one.function(**{**one.right, name: wrong})
            assert "\n" not in str(error.value)


def test_the_table_is_of_300_arguments() -> None:
    assert sum(len(one.right) - len(one.left_out) for one in CALLS) >= 290


@pytest.mark.parametrize(("name", "slip", "words"), SLIPS)
def test_a_slip_is_refused_by_name_in_one_short_line(name: str, slip: Callable[[], object], words: str) -> None:
    with pytest.raises(ValueError, match=rf"^{re.escape(name)}: .+ is not allowed; allowed: ") as error:
        slip()
    given, allowed = str(error.value).split(" is not allowed; allowed: ")
    assert words in allowed
    assert len(given) < 120


def test_an_unknown_condition_names_one_that_is_written_alike() -> None:
    with pytest.raises(TypeError, match=r"^Hs: no such condition; did you mean hs\?$"):
        Sea(16, Hs=3.0)
