"""The water below nonlinear waves, against the flow of a steep wave of constant form."""

import math

import numpy as np
import pytest

from sim.ocean import Sea
from sim.ocean.nonlinear import NonlinearSea, stokes_wave
from sim.ocean.nonlinear.padded_transforms import padded_size

LENGTH = 50.0  # [m]
K = 2.0 * math.pi / LENGTH
DENSITY = 1025.0


def flow_of(wave, x: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Velocity (n, 2), acceleration (n, 2) and dynamic pressure (n,) of the series; the pressure but for a constant."""
    j = K * np.arange(1, len(wave.sines) + 1)
    deep = math.isinf(wave.depth)
    up = np.exp(np.outer(z, j))
    down = 0.0 * up if deep else np.exp(-np.outer(z + 2.0 * wave.depth, j))
    scale = 1.0 if deep else 1.0 + np.exp(-2.0 * j * wave.depth)
    C, S, cos, sin = (up + down) / scale, (up - down) / scale, np.cos(np.outer(x, j)), np.sin(np.outer(x, j))
    velocity = np.column_stack([(C * cos) @ (j * wave.sines), (S * sin) @ (j * wave.sines)])
    along = np.column_stack([-(C * sin) @ (j * j * wave.sines), (S * cos) @ (j * j * wave.sines)])
    pressure = DENSITY * (wave.speed * velocity[:, 0] - 0.5 * np.square(velocity).sum(1))
    return velocity, -wave.speed * along, pressure


def errors(order: int, depth: float, axis: int = 0) -> np.ndarray:
    """Largest errors of velocity, acceleration and pressure over the largest values: from the bottom to the crest."""
    wave = stokes_wave(0.2 / K, LENGTH, depth, order=15)
    x = np.arange(32) * LENGTH / 32
    start = [np.tile(f, (8, 1)) if axis else f for f in (wave.elevation(x), wave.potential(x))]
    sea = NonlinearSea(length=(40.0, LENGTH) if axis else LENGTH, depth=depth, order=order, start=tuple(start))
    along = np.linspace(0.0, LENGTH, 21)
    surface = wave.elevation(along)
    worst = []
    for z in (surface, np.minimum(0.0, surface), np.minimum(-1.0, surface), np.full(21, -9.0)):
        points = np.column_stack([along, np.full(21, 7.0), z])
        flow = sea.kinematics(points[:, [1, 0, 2]] if axis else points)
        velocity, acceleration, pressure = flow_of(wave, along, z)
        found = flow.pressure - flow.pressure.mean() + pressure.mean()
        pairs = (
            (flow.velocity[:, [axis, 2]], velocity),
            (flow.acceleration[:, [axis, 2]], acceleration),
            (found, pressure),
        )
        worst.append([np.abs(a - b).max() / np.abs(b).max() for a, b in pairs])
        assert not flow.velocity[:, 1 - axis].any()
    return np.array(worst).max(axis=0)


@pytest.mark.parametrize("depth", [math.inf, 10.0])
def test_the_flow_converges_with_the_order(depth):
    # Measured on deep water at the velocity: 2.5e-3, 6e-5, 2e-6.
    for order, bound in ((3, 5e-3), (5, 2e-4), (7, 1e-5)):
        assert errors(order, depth).max() < bound


def test_the_flow_along_y_is_the_same():
    assert errors(5, 10.0, axis=1) == pytest.approx(errors(5, 10.0), rel=1e-6)


def test_above_the_surface_and_below_the_bottom_are_the_values_there():
    wave = stokes_wave(1.0, LENGTH, 10.0)
    x = np.arange(32) * LENGTH / 32
    sea = NonlinearSea(length=LENGTH, depth=10.0, start=(wave.elevation(x), wave.potential(x)))
    crest = float(sea.height[0, 0])
    above, on, bottom, below = sea.kinematics([[0, 0, 9.0], [0, 0, crest], [3, 0, -10.0], [3, 0, -50.0]]).velocity
    assert above == pytest.approx(on, rel=1e-9)
    assert below == pytest.approx(bottom, rel=1e-9)
    assert bottom[2] == pytest.approx(0.0, abs=1e-9)


def test_the_flow_at_the_surface_makes_its_rise():
    """eta_t = w - u eta_x - v eta_y, and the pressure there is rho g eta: the conditions that the method solves."""
    random = np.random.default_rng(2)
    x, y = np.arange(32)[:, None] * 2.5, np.arange(32) * 2.5
    eta = potential = 0.0
    for nx, ny in ((1, 0), (1, 1), (2, -1), (0, 1)):
        phase = 2.0 * math.pi * (nx * x + ny * y) / 80.0 + random.uniform(0.0, 6.0)
        eta, potential = eta + 0.3 * np.cos(phase), potential + 0.3 * 9.0 * np.sin(phase)
    sea = NonlinearSea(length=80.0, order=6, start=(eta, potential))
    points = np.column_stack([g.ravel() for g in (*np.broadcast_arrays(x, y), sea.height)])
    flow, slope = sea.kinematics(points), sea.slope.reshape(-1, 2)
    rise = flow.velocity[:, 2] - (flow.velocity[:, :2] * slope).sum(1)
    assert rise == pytest.approx(sea.rise.ravel(), abs=2e-5 * np.abs(rise).max())
    assert flow.pressure == pytest.approx(DENSITY * 9.81 * points[:, 2], abs=2e-5 * np.abs(flow.pressure).max())


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_products_have_the_fewest_cells_that_transform_quickly(order):
    def is_quick(cells: int) -> bool:
        return cells == 1 or any(cells % factor == 0 and is_quick(cells // factor) for factor in (2, 3, 5, 7))

    assert padded_size(1, order) == 1
    for size in range(8, 400, 2):
        wanted = size * (order + 1) / 2
        assert padded_size(size, order) == next(n for n in range(8, 2000, 8) if n >= wanted and is_quick(n))


def test_in_a_trough_the_water_above_the_surface_is_that_on_it():
    wave = stokes_wave(4.0, 100.0)
    x = np.arange(64) * 100.0 / 64
    sea = NonlinearSea(length=100.0, order=5, start=(wave.elevation(x), wave.potential(x)))
    trough = float(sea.height[32, 0])
    assert trough < -1.8
    on, below_still, still, above = sea.kinematics([[50.0, 0.0, z] for z in (trough, -0.01, 0.0, 1.0)]).velocity
    for velocity in (below_still, still, above):
        assert velocity == pytest.approx(on, rel=1e-9)
    pressure = sea.kinematics([[50.0, 0.0, -0.01]]).pressure
    assert pressure == pytest.approx(DENSITY * 9.81 * trough, rel=1e-3)


@pytest.mark.parametrize("depth", [math.inf, 15.0])
def test_the_sums_over_a_rectangle_are_those_of_single_waves(depth):
    """Elevation, potential flow and its change, wave by wave; rows and columns of different lengths."""
    linear = Sea(16, 80.0, "sea_state", hs=1.0, tp=5.0, depth=depth, choppiness=0.0, precision="double")
    sea = NonlinearSea((32, 16), 80.0, 3, start=linear, fade=0.0)
    sea.advance(0.7)
    random = np.random.default_rng(8)
    points = np.column_stack([random.uniform(-200.0, 200.0, (40, 2)), random.uniform(-20.0, 2.0, 40)])
    modes, flow = sea._equations.modes, sea._now.flow
    phase = np.exp(1j * (modes.kx * points[:, :1, None] + modes.ky[:, None] * points[:, 1:2, None]))
    eta = (phase * modes.weight * sea._now.u[0]).real.sum(axis=(1, 2))
    assert sea.height_at(points[:, :2], 0.7, exact=True)[0] == pytest.approx(eta, abs=1e-12)
    z = np.maximum(np.minimum(points[:, 2], eta), -depth)[:, None, None]
    expected = np.zeros((40, 2, 4))
    for f in range(2):
        terms = (flow.parts[:, f, 0] + 1j * flow.parts[:, f, 1])[:, None]
        up = np.exp(modes.k * np.minimum(z, 0.0))
        down = 0.0 if math.isinf(depth) else np.exp(-modes.k * (np.minimum(z, 0.0) + 2.0 * depth))
        scale = 1.0 if math.isinf(depth) else 1.0 + np.exp(-2.0 * modes.k * depth)
        value, slope = terms[0] * (up + down) / scale, terms[0] * modes.k * (up - down) / scale
        crest_value = sum(terms[n] * (modes.k * z) ** n / math.factorial(n) * (modes.tanh if n % 2 else 1.0)
                          for n in range(3))  # fmt: skip
        crest_slope = sum(terms[n] * modes.k * (modes.k * z) ** n / math.factorial(n) * (1.0 if n % 2 else modes.tanh)
                          for n in range(3))  # fmt: skip
        value, slope = np.where(z > 0.0, crest_value, value), np.where(z > 0.0, crest_slope, slope)
        each = value, 1j * modes.kx * value, 1j * modes.ky[:, None] * value, slope
        expected[:, f] = np.stack([(phase * one).real.sum(axis=(1, 2)) for one in each], axis=-1)
    found = sea.kinematics(points)
    assert found.velocity == pytest.approx(expected[:, 0, 1:], abs=1e-11)
    assert found.acceleration == pytest.approx(expected[:, 1, 1:], abs=1e-11)
    pressure = -DENSITY * (expected[:, 1, 0] + 0.5 * np.square(expected[:, 0, 1:]).sum(1))
    assert found.pressure == pytest.approx(pressure, abs=1e-8)
