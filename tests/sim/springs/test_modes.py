import dataclasses
import math

import numpy as np
import pytest

from sim.springs import INTEGRATORS, rope
from sim.springs.forces.matrices import DAMPING, STIFFNESS
from sim.springs.state import State, advance, velocities
from sim.springs.statics import equilibrium
from tests.sim.springs.test_stability import tangent_matrix

LAB = rope(10, gravity=10.0)
LONGITUDINAL = (  # [rad/s] of nine moving points, fixed and free, k = 800 N/m, m = 1 kg
    4.67139321, 13.88675621, 22.7233247, 30.94006013, 38.31283137, 44.64052844, 49.75054827, 53.50350283, 55.79702131,
)  # fmt: skip
HANGING = (  # [rad/s] across the lab's hanging rope
    2.29137194, 5.50000363, 8.67471704, 11.85560964, 15.05649477, 18.2965422, 21.61098242, 25.07574064, 28.90865207,
)  # fmt: skip


def hanging(net):
    """The net at rest in its equilibrium."""
    return State(np.ascontiguousarray(equilibrium(net).x.T[:, None]), np.zeros_like(net.x0))


def mode_shapes(net, x, axis):
    """Squared frequencies and shapes (moving points, modes) of motions along one axis."""
    n = net.shape[1]
    block = tangent_matrix(net, x, STIFFNESS)[axis * n + 1 : (axis + 1) * n, axis * n + 1 : (axis + 1) * n]
    return np.linalg.eigh(block)


def measured(net, axis, shape, amplitude, seconds, name="rk4", steps=None):
    """Frequency [rad/s] and decay rate [1/s] of one mode's free motion, from the zeros and peaks of its amplitude."""
    state = hanging(net)
    rest = state.x[axis, 0, 1:].copy()
    state.x[axis, 0, 1:] += amplitude * shape
    steps = steps or 4000
    h = seconds / steps
    q, dq = np.empty(steps + 1), np.empty(steps + 1)
    for i in range(steps + 1):
        if i:
            advance(net, state, INTEGRATORS[name], h, 1)
        q[i] = shape @ (state.x[axis, 0, 1:] - rest) / amplitude
        dq[i] = shape @ velocities(net, state)[axis, 0, 1:] / amplitude
    # Zeros of q by Hermite interpolation's secant: half a period apart whatever the damping.
    i = np.nonzero(np.sign(q[:-1]) != np.sign(q[1:]))[0]
    zeros = h * (i + q[i] / (q[i] - q[i + 1]))
    speeds = np.interp(zeros, h * np.arange(steps + 1), np.abs(dq))
    omega = math.pi * (len(zeros) - 1) / (zeros[-1] - zeros[0])
    decay = math.log(speeds[0] / speeds[-1]) / (zeros[-1] - zeros[0])
    return omega, decay


def test_longitudinal_frequencies_are_the_fixed_free_chain_s():
    squared, _ = mode_shapes(LAB, hanging(LAB).x, 2)
    assert np.sqrt(squared) == pytest.approx(LONGITUDINAL, rel=1e-8)


def test_frequencies_across_the_lab_s_hanging_rope_are_the_table_s():
    squared, _ = mode_shapes(LAB, hanging(LAB).x, 0)
    assert np.sqrt(squared) == pytest.approx(HANGING, rel=1e-8)


@pytest.mark.parametrize("points", [5, 10])
def test_a_nearly_inextensible_chain_has_the_zeros_of_laguerre_s_polynomial(points):
    net = rope(points, 2.0, stiffness=1e9, gravity=10.0)
    squared, _ = mode_shapes(net, hanging(net).x, 0)
    zeros = np.polynomial.laguerre.lagroots([0.0] * (points - 1) + [1.0])
    assert squared == pytest.approx(10.0 * (points - 1) / 2.0 * zeros, rel=1e-6)
    if points == 5:
        assert zeros == pytest.approx([0.32254769, 1.7457611, 4.5366203, 9.3950709], rel=1e-7)


@pytest.mark.parametrize("mode", [0, 1, 4, 8])
def test_the_rope_swings_at_its_modes_frequencies(mode):
    net = rope(10, damping=0.0, drag=0.0, gravity=10.0)
    _, shapes = mode_shapes(net, hanging(net).x, 0)
    omega, decay = measured(net, 0, shapes[:, mode], 1e-4, 20.0 * math.pi / HANGING[mode])
    assert omega == pytest.approx(HANGING[mode], rel=1e-5)
    assert abs(decay) < 1e-4 * omega


@pytest.mark.parametrize("mode", [0, 3, 8])
def test_longitudinal_vibrations_decay_at_the_rayleigh_rate(mode):
    """gamma = (b lambda + c)/m with lambda = m omega^2/k: amplitudes fall as exp(-gamma t/2)."""
    net = LAB
    _, shapes = mode_shapes(net, hanging(net).x, 2)
    omega0 = LONGITUDINAL[mode]
    gamma = 7.0 * omega0**2 / 800.0 + 1.0
    zeta = gamma / (2.0 * omega0)
    seconds = 2.2 * math.pi / omega0 if zeta > 0.1 else 6.2 * math.pi / omega0
    omega, decay = measured(net, 2, shapes[:, mode], 1e-4, seconds)
    assert omega == pytest.approx(omega0 * math.sqrt(1.0 - zeta**2), rel=1e-3)
    assert decay == pytest.approx(0.5 * gamma, rel=1e-3)


@pytest.mark.parametrize("model", ["isotropic", "axial"])
def test_only_isotropic_damping_reaches_motion_across_the_rope(model):
    net = rope(10, drag=0.0, damping_model=model)
    _, shapes = mode_shapes(net, hanging(net).x, 0)
    n = net.shape[1]
    damping = tangent_matrix(net, hanging(net).x, DAMPING)[1:n, 1:n]
    rates = np.diag(shapes.T @ damping @ shapes)
    if model == "axial":
        assert np.abs(rates).max() == 0.0
    else:
        assert rates.min() > 0.1


def test_a_taut_rope_has_the_string_s_frequencies():
    """omega = 2 sqrt(T/(m a)) sin(j pi/(2 (n + 1))) across, 2 sqrt(k/m) sin(...) along, of n points between pins."""
    net = rope(12, 2.0, 0.3, 500.0, gravity=0.0, end=(2.5, 0.0, 0.0))
    squared = np.linalg.eigvalsh(tangent_matrix(net, net.x0, STIFFNESS))[6:]
    j = np.arange(1, 11)
    sine = 2.0 * np.sin(j * math.pi / 22.0) ** 1
    spacing, tension = 2.5 / 11, 500.0 * 0.5 / 11
    across, along = tension / (0.3 * spacing) * sine**2, 500.0 / 0.3 * sine**2
    assert np.sort(squared) == pytest.approx(np.sort(np.concatenate([across, across, along])), rel=1e-10)


@pytest.mark.parametrize("z", [0.1, 0.5, 1.0, 1.9])
def test_leapfrog_rings_at_its_numerical_frequency(z):
    """Omega = (2/h) asin(z/2), of the leapfrog and of symplectic Euler."""
    net = dataclasses.replace(rope(2, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0))
    for name in ("leapfrog", "symplectic_euler", "leapfrog_lagged"):
        state = State.at_rest(net)
        state.x[0, 0, 1] -= 1e-3
        wave = []
        for _ in range(64):
            wave.append(-state.x[0, 0, 1] - 1.0)
            advance(net, state, INTEGRATORS[name], z, 1)
        # x_{n+1} + x_{n-1} = 2 cos(Omega h) x_n
        cosine = (np.array(wave[2:]) + wave[:-2]) @ wave[1:-1] / (2.0 * np.array(wave[1:-1]) @ wave[1:-1])
        assert math.acos(cosine) == pytest.approx(2.0 * math.asin(z / 2.0), rel=1e-9)
