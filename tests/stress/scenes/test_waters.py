"""Seas at the ends of their sizes, depths and winds; hulls upside down, under water and in the air."""

import dataclasses
import itertools
import math

import numpy as np
import pytest

from app.messages import Reset, where_not_finite
from app.scenes.radial_sea.scene import RadialSeaParams, RadialSeaScene
from app.server.loop.sim_loop import FRAME_INTERVAL, SimLoop
from sim.ocean import Sea
from sim.ocean.dispersion import omega
from sim.ocean.spectra import SPECTRA
from tests.stress.tally import Tally

SIZES = (8, 20, 64, 1024)
LENGTHS = (0.1, 1.0, 100.0, 1e5)  # [m]
DEPTHS = (1e-3, 0.1, 10.0, 1e4, math.inf)  # [m]
WINDS = (0.0, 1e-3, 0.5, 30.0, 100.0)  # [m/s]
UPSIDE_DOWN = (0.0, 1.0, 0.0, 0.0)
ON_EDGE = (math.cos(math.pi / 8), math.sin(math.pi / 8), 0.0, 0.0)


@pytest.mark.parametrize("spectrum", SPECTRA)
def test_every_wind_over_every_depth(spectrum: str, tally: Tally) -> None:
    for wind, depth, length in itertools.product(WINDS, DEPTHS, LENGTHS):
        with tally.fault("sea of an odd size, depth or wind"):
            sea = Sea(16, length, spectrum, wind_speed=wind, depth=depth)
            for t in (0.0, 1e6):
                s = sea.surface(t)
                for field in (s.height, s.displacement, s.slope, s.jacobian):
                    assert np.isfinite(field).all(), (wind, depth, length)
            assert wind > 0.0 or not s.height.any()


def test_every_size(tally: Tally) -> None:
    for size, length, precision in itertools.product(SIZES, LENGTHS, ("single", "double")):
        with tally.fault("sea of an odd size, depth or wind"):
            sea = Sea(size, length, wind_speed=10.0, precision=precision)
            s = sea.surface(12.0)
            assert np.isfinite(s.height).all()
            assert abs(float(s.height.mean())) <= 1e-5 * max(float(np.abs(s.height).max()), 1e-30)
            height, residual = sea.height_at(np.array([[0.0, 0.0], [0.3 * length, 1e6 * length]]), 12.0)
            assert np.isfinite(height).all()
            assert np.isfinite(residual).all()


def test_weather_that_jumps_about(tally: Tally) -> None:
    rng = np.random.default_rng(6)
    sea = Sea(32, 200.0)
    for turn in range(500):
        with tally.fault("weather that jumps"):
            sea.change(
                0.1 * turn,
                float(rng.choice([0.0, 1e-6, 5.0, 1e6])),
                str(rng.choice(list(SPECTRA))),
                wind_speed=float(rng.choice(WINDS)),
                wind_direction=float(rng.uniform(-6.0, 6.0)),
                depth=float(rng.choice(DEPTHS)),
                gravity=float(10.0 ** rng.uniform(-2.0, 3.0)),
                viscosity=float(rng.choice([0.0, 1e-6, 10.0])),
            )
            s = sea.surface(0.1 * turn)
            assert np.isfinite(s.height).all()
            assert np.isfinite(s.displacement).all()


@pytest.mark.parametrize(
    ("bad", "words"),
    [({"size": 0}, "size"), ({"size": 3.5}, "size"), ({"length": 0.0}, "length"), ({"wind_speed": -1.0}, "wind_speed"),
     ({"wind_speed": math.nan}, "wind_speed"), ({"depth": 0.0}, "depth"), ({"gravity": 0.0}, "gravity"),
     ({"spectrum": "none such"}, "spectrum")],
)  # fmt: skip
def test_what_is_no_sea_is_refused_by_name(bad: dict, words: str, tally: Tally) -> None:
    with tally.fault("bad argument"), pytest.raises(ValueError, match=f"{words}: .* is not allowed; allowed: "):
        Sea(**{"size": 16, "length": 100.0, **bad})


def test_frequencies_over_forty_decades() -> None:
    k = 10.0 ** np.arange(-20.0, 20.5)
    for depth, tension in itertools.product(DEPTHS, (0.0, 0.0728)):
        w = omega(k, depth=depth, tension=tension, density=1000.0)
        assert np.isfinite(w).all()
        assert (np.diff(w) > 0.0).all()


def float_for(scene: RadialSeaScene, seconds: float) -> None:
    """The bodies stay numbers, turned by proper turns, for so long."""
    scene.advance(round(seconds / scene.step))
    fleet = scene.bodies.fleet
    for state in (fleet.position, fleet.rotation, fleet.velocity, fleet.spin):
        assert np.isfinite(state).all()
    assert np.abs(np.linalg.norm(fleet.rotation, axis=1) - 1.0).max() < 1e-6


@pytest.mark.parametrize("wind", [0.5, 25.0])
@pytest.mark.parametrize("spill", ["none", "layer", "mixed"])
def test_hulls_in_places_where_no_hull_belongs(wind: float, spill: str, tally: Tally) -> None:
    scene = RadialSeaScene(
        RadialSeaParams(bodies=4, wind_speed=wind, spill=spill, size=1.0, wave_count=24, rings=16, spokes=16)
    )
    fleet = scene.bodies.fleet
    home = fleet.position.copy()

    def start(**state: object) -> None:
        fleet.position[:], fleet.velocity[:], fleet.spin[:], fleet.rotation[:] = home, 0.0, 0.0, (1.0, 0.0, 0.0, 0.0)
        for name, value in state.items():
            getattr(fleet, name)[:] = value

    for what, state in {
        "hull upside down": {"rotation": UPSIDE_DOWN},
        "hull on edge": {"rotation": ON_EDGE},
        "hull under water": {"position": home - (0.0, 0.0, 10.0)},
        "hull in the air": {"position": home + (0.0, 0.0, 100.0)},
        "hull in a spin": {"spin": (0.0, 300.0, 40.0)},
        "hull shot into the water": {"position": home + (0.0, 0.0, 20.0), "velocity": (100.0, 0.0, -500.0)},
        "hulls all in one place": {"position": (0.0, 0.0, 0.0)},
    }.items():
        with tally.fault(what):
            start(**state)
            float_for(scene, 6.0)
            scene.frame()
            # What is light comes up again, wherever it was, and stays.
            assert (np.abs(fleet.position[:, 2]) < 15.0).all()
    with tally.fault("hull that is no longer a number"):
        loop = SimLoop(scene)
        start(velocity=math.nan)
        loop.tick(FRAME_INTERVAL)
        loop.tick(FRAME_INTERVAL)
        assert "no longer finite" in loop.latest.status.halted
        assert where_not_finite(loop.latest.frame) == ""
        loop.commands.put(Reset())
        for _ in range(30):
            loop.tick(FRAME_INTERVAL)
        assert loop.run.running
        float_for(scene, 1.0)


def test_hulls_at_every_step_and_density(tally: Tally) -> None:
    for step, density, size in itertools.product((1 / 500, 1 / 20), (50.0, 1020.0), (0.3, 4.0)):
        with tally.fault("hull of an odd size or density"):
            params = RadialSeaParams(
                bodies=6, wind_speed=25.0, size=size, density=density, time_step=step, wave_count=16
            )
            float_for(RadialSeaScene(dataclasses.replace(params, rings=16, spokes=16)), 5.0)
