"""The step up to which a method is right, beside closed forms, its kernel, and runs against the matrix exponential."""

import dataclasses
import functools
import math

import numpy as np
import pytest
import scipy.linalg
from scipy.interpolate import CubicSpline

from sim.springs import INTEGRATORS, accurate_methods, accurate_step, cloth, critical_step, rope
from sim.springs.analysis.accuracy import logarithms, mode_errors, motion_errors
from sim.springs.analysis.amplification import exponents
from sim.springs.analysis.growth import step_changes
from sim.springs.analysis.settling import find_rest_positions
from sim.springs.stability import TOLERANCE, gauge, moved_modes
from sim.springs.state import State, advance
from tests.naive import tangent
from tests.sim.springs.nets import DAMPABLE

DAMPINGS = (0.0, 7.0, 200.0, 1e4, 1e6)
PULL = 1e-5  # of gravity, in each direction: a motion so small that the net is linear
NETS = {
    "rope": rope(6),
    "axial": rope(6, damping_model="axial"),
    "drag": rope(6, drag=30.0),
    "stiff": rope(6, stiffness=1e5),
    "both ends": rope(8, end=(-1.5, 0.0, 0.3)),
    "cloth": cloth(3, 4),
}


def error_of(name, omega, rate, h):
    """The declared error of one mode."""
    return float(mode_errors(INTEGRATORS[name].changes, *np.array([[omega], [rate], [h]]))[0])


@pytest.mark.parametrize("name", INTEGRATORS)
def test_a_method_declares_the_eigenvalues_of_its_kernel_s_step(name):
    record = INTEGRATORS[name]
    for zeta in (0.0,) if record.undamped_only else (0.0, 0.1, 0.7, 2.0, 40.0):
        for h in (0.01, 0.2, 0.7):
            found = step_changes(record, zeta, h)
            declared = record.changes(*np.array([[1.0], [2.0 * zeta], [h]]))[:, 0]
            apart = [max(abs(found - order)) for order in (declared, declared[::-1])]
            assert min(apart) < 1e-8 * max(1.0, abs(declared).max()), (zeta, h)


@pytest.mark.parametrize(
    ("name", "error"),  # of an undamped mode, over powers of z = h omega
    [
        ("explicit_euler", lambda z: z / 2), ("implicit_euler", lambda z: z / 2), ("leapfrog", lambda z: z**2 / 24),
        ("symplectic_euler", lambda z: z**2 / 24), ("leapfrog_lagged", lambda z: z**2 / 24),
        ("implicit_midpoint", lambda z: z**2 / 12), ("rk4", lambda z: z**4 / 120),
    ],
)  # fmt: skip
def test_the_error_of_an_undamped_mode_is_the_closed_form(name, error):
    for z in (0.01, 0.05):
        assert error_of(name, 30.0, 0.0, z / 30.0) == pytest.approx(error(z), rel=0.01 + z * z)


@pytest.mark.parametrize("rate", [1e3, 1e6, 1e9])
def test_of_an_overdamped_mode_the_slow_decay_counts_and_the_fast_one_may_be_over_within_a_step(rate):
    slow = 400.0 / rate  # omega^2 / rate, 1/s
    h = 0.02 / slow
    assert error_of("implicit_euler", 20.0, rate, h) == pytest.approx(0.01, rel=0.02)  # r h/2
    assert error_of("implicit_midpoint", 20.0, rate, h) == pytest.approx(0.02**2 / 12, rel=0.02, abs=2.0 * slow / rate)
    assert error_of("rk4", 20.0, rate, 2.0 / rate) < 1e-3


def test_near_critical_damping_a_small_error_counts_as_a_small_one():
    # Eigenvalues move by the root of a change of the damping there, the motion by the change itself.
    errors = [error_of("leapfrog", 1.0, 2.0 * zeta, 0.05) for zeta in (0.9, 0.999, 1.0, 1.001, 1.1)]
    assert max(errors) < 3.0 * min(errors)


def test_logarithms_of_small_changes_are_right_to_round_off():
    y = np.array([1e-13 + 0j, -1e-13 + 2e-14j, 0.3 - 0.2j, -1.0 + 0j])
    np.testing.assert_allclose(logarithms(y)[:2], y[:2], rtol=1e-12)
    assert logarithms(y)[2] == pytest.approx(np.log(1.0 + y[2]), rel=1e-14)
    assert logarithms(y)[3].real < -15.0  # over within a step


@pytest.mark.parametrize("name", DAMPABLE)
@pytest.mark.parametrize("y", [0.1, 0.9, 1.8, 20.0])
def test_the_error_of_a_fall_is_that_of_its_terminal_speed(name, y):
    """One point, m = 1 kg, falls with drag 60 y N s/m in steps of 1/60 s: y is their product with the rate."""
    record, h, rate = INTEGRATORS[name], 1.0 / 60.0, 60.0 * y
    if record.stable_step(0.0, rate) < h:
        return
    net = rope(2, stiffness=0.0, damping=0.0, drag=rate)
    state = State.at_rest(net)
    advance(net, state, record, h, 2000)
    before = state.x[2, 0, 1]
    advance(net, state, record, h, 60)
    measured = (before - state.x[2, 0, 1]) / (9.81 / rate)
    declared = error_of(name, 1e-3 * rate, rate, h)
    # The leapfrog's drag is exact where no link is damped, which its declared error does not know.
    least = 0.0 if name == "leapfrog" else 0.95 * declared - 1e-5
    assert least <= abs(measured - 1.0) <= 1.05 * declared + 1e-5


def damped(name, damping):
    """A net of NETS with its links' damping scaled to this of the first family [N s/m]."""
    net = NETS[name]
    factor = damping / net.families[0].damping
    return dataclasses.replace(net, families=tuple(f._replace(damping=factor * f.damping) for f in net.families))


@functools.cache
def rest_of(name):
    """Positions at rest, which no damping changes."""
    return find_rest_positions(NETS[name])


@functools.cache
def matrices(name):
    """K, D without and with links' damping, by differences of naive forces, and the components that are free."""
    x = rest_of(name)
    k, drag = tangent(damped(name, 0.0), x)
    free = np.tile(NETS[name].inverse_masses() > 0.0, 3)
    at = np.ix_(free, free)
    return k[at], drag[at], (tangent(damped(name, 1.0), x)[1] - drag)[at], free


def exact_motion(name, damping, duration):
    """The motion from rest under the pull, as a function of the time up to `duration` [s], in units M^1/2 u."""
    k, drag, links, free = matrices(name)
    m = len(k)
    generator = np.zeros((2 * m + 1, 2 * m + 1))
    generator[:m, m : 2 * m] = np.eye(m)
    generator[m : 2 * m, :m] = -0.5 * (k + k.T)
    generator[m : 2 * m, m : 2 * m] = -(drag + damping * links)
    generator[m : 2 * m, -1] = 9.81 * PULL * np.sqrt(np.tile(NETS[name].masses.ravel(), 3)[free])
    t = np.linspace(0.0, duration, 601)
    step = scipy.linalg.expm(generator * (duration / 600))
    state = np.zeros(2 * m + 1)
    state[-1] = 1.0
    states = [state]
    for _ in range(600):
        states.append(step @ states[-1])
    return CubicSpline(t, np.array(states)[:, :m])


def course(name, damping, method, h, steps):
    """Displacements (steps + 1, free) of a run under the pull, less one without it, in units M^1/2 u."""
    net, ends = damped(name, damping), []
    for pull in (0.0, 9.81 * PULL):
        pulled = dataclasses.replace(net, gravity=tuple(g + pull for g in net.gravity))
        state = State.still(rest_of(name))
        xs = [state.x.ravel().copy()]
        for _ in range(steps):
            advance(pulled, state, INTEGRATORS[method], h, 1)
            xs.append(state.x.ravel().copy())
        ends.append(np.array(xs))
    return ((ends[1] - ends[0]) * np.sqrt(np.tile(net.masses.ravel(), 3)))[:, matrices(name)[3]]


def swing(name, damping):
    """(size of the eigenvalue [1/s], whether it oscillates) of the mode that moves farthest."""
    motion = moved_modes(damped(name, damping), rest_of(name))
    heaviest = int(motion.weight.argmax())
    size = abs(exponents(motion.omega, motion.rate)[1][heaviest])
    return float(size), bool(motion.rate[heaviest] < 2.0 * motion.omega[heaviest])


def measured_error(name, damping, method, h):
    """Largest distance of a run from the exact motion during its first swing, over the largest displacement.

    Without an overdamped motion the run may be early or late by half a step, as methods of first order are.
    """
    size, oscillates = swing(name, damping)
    first_swing = math.pi / size
    steps = max(1, int(first_swing / h))
    exact = exact_motion(name, damping, max(first_swing, h * steps) + h)
    t, u = h * np.arange(steps + 1), course(name, damping, method, h, steps)
    largest = np.linalg.norm(exact(np.linspace(0.0, first_swing, 200)), axis=1).max()
    errors = []
    for late in np.linspace(-0.5, 0.5, 11) if oscillates else (0.0,):
        seen = t + late * h >= 0.0
        errors.append(np.linalg.norm(u[seen] - exact(t[seen] + late * h), axis=1).max())
    return min(errors) / largest


MOST_STEPS = 4000  # of a run: shorter steps are no news, their errors are far smaller


@pytest.mark.parametrize("method", INTEGRATORS)
@pytest.mark.parametrize("name", NETS)
def test_a_run_at_a_step_that_is_right_is_right(name, method):
    for damping in DAMPINGS:
        net, state = damped(name, damping), State.still(rest_of(name))
        if INTEGRATORS[method].undamped_only and net.is_damped:
            continue
        h = 0.95 * accurate_step(net, method, state)
        first_swing = math.pi / swing(name, damping)[0]
        h = min(h, first_swing / 4.0)
        if h * MOST_STEPS > first_swing:
            # Implicit midpoint answers overdamped motions with velocities that alternate for some steps.
            most = 2.0 if method == "implicit_midpoint" else 1.2
            if name == "cloth" and damping >= 1e4 and method == "tr_bdf2":
                most = 4.0  # in steps of 88 s the solver's tolerance is coarse: `COARSE` of each change of velocity
            assert measured_error(name, damping, method, h) < most * TOLERANCE, damping


@pytest.mark.parametrize("method", ["explicit_euler", "implicit_euler", "implicit_midpoint", "tr_bdf2"])
@pytest.mark.parametrize("name", NETS)
def test_a_run_at_three_times_the_step_that_is_right_is_wrong(name, method):
    tried = 0
    for damping in (0.0, 0.3, 7.0):
        net, state = damped(name, damping), State.still(rest_of(name))
        h = 3.0 * accurate_step(net, method, state)
        # A step that is three times too long for an overdamped motion is a large part of it if the order is two.
        can_tell = swing(name, damping)[1] or INTEGRATORS[method].order == 1
        if can_tell and 0.0 < h < critical_step(net, method, state):
            tried += 1
            # Of an overdamped motion, off by 3 % in its speed, the place is off by a third of that.
            assert measured_error(name, damping, method, h) > 0.8 * TOLERANCE, damping
    assert tried or method == "explicit_euler" or (name == "drag" and INTEGRATORS[method].order == 2)


def test_the_lab_s_rope_is_right_with_leapfrog_and_rk4_and_late_with_implicit_euler():
    net = rope()
    hanging = State.still(find_rest_positions(net))
    pendulum = math.sqrt(0.5 * 9.81 / 1.0)  # about: a uniform rod of 2 m swings with sqrt(3 g / 2 L)
    assert accurate_step(net, "implicit_euler", hanging) == pytest.approx(2.0 * TOLERANCE / pendulum, rel=0.4)
    for name in ("leapfrog", "rk4", "dop853"):
        assert accurate_step(net, name, hanging) == critical_step(net, name, hanging)
    assert "implicit_euler" not in accurate_methods(net, 1 / 60, hanging)
    assert accurate_methods(net, 1 / 60, hanging)[0] == "leapfrog"


def test_only_methods_that_are_stable_and_right_are_named():
    net = rope(damping=1e4)
    hanging = State.still(find_rest_positions(rope()))
    for h in (1e-4, 1 / 480, 1 / 60):
        names = accurate_methods(net, h, hanging)
        for name in DAMPABLE:
            assert (name in names) == (accurate_step(net, name, hanging) >= h), (name, h)
    assert "pefrl" in accurate_methods(rope(damping=0.0, drag=0.0), 1 / 60)
    assert "pefrl" not in accurate_methods(rope(), 1 / 60)


def test_the_gauge_names_a_method_that_is_right_where_its_own_is_only_stable():
    net = rope()
    hanging = State.still(find_rest_positions(net))
    wrong = gauge(net, "implicit_euler", 1 / 60, hanging)
    assert wrong.is_wrong
    assert wrong.accurate_step == accurate_step(net, "implicit_euler", hanging)
    changes, motion = INTEGRATORS["implicit_euler"].changes, moved_modes(net, hanging.x)
    assert wrong.error == motion_errors(changes, motion, np.array([1 / 60]))[0]
    assert wrong.accurate_method == accurate_methods(net, 1 / 60, hanging)[0]
    right = gauge(net, "leapfrog", 1 / 60, hanging)
    assert not right.is_wrong
    assert right.accurate_method == ""
    unstable = gauge(net, "explicit_euler", 1 / 60, hanging)
    assert not unstable.is_wrong  # it is worse than that
    assert unstable.share > 1.0


def test_the_error_at_the_accurate_step_is_the_tolerance():
    net = rope(damping=0.5)
    for tolerance in (1e-3, 0.01, 0.05):
        h = accurate_step(net, "implicit_midpoint", tolerance=tolerance)
        found = motion_errors(INTEGRATORS["implicit_midpoint"].changes, moved_modes(net), np.array([h]))[0]
        assert found == pytest.approx(tolerance, rel=0.01)


def test_the_modes_of_a_coarse_motion_are_those_of_the_net():
    # A fixed-free chain of n points: omega = 2 sqrt(k/m) sin((2j - 1) pi / (2 (2n + 1))), straight as it hangs.
    for points in (4, 10, 60, 400):
        net = rope(points, stiffness=1e4, gravity=0.0, damping=2.0, drag=0.3)
        motion = moved_modes(net)
        first = 2.0 * math.sqrt(1e4) * math.sin(math.pi / (2 * (2 * points - 1)))
        heaviest = int(motion.weight.argmax())
        assert motion.omega[heaviest] == pytest.approx(first, rel=0.01)
        assert motion.rate[heaviest] == pytest.approx(0.3 + 2.0 / 1e4 * first**2, rel=0.02)
        assert motion.weight.sum() == pytest.approx(1.0, rel=1e-12)


def test_what_does_not_move_is_right_at_every_step():
    assert accurate_step(rope(1), "rk4") == math.inf
    assert accurate_step(rope(2, stiffness=0.0, damping=0.0, drag=0.0, gravity=0.0), "implicit_euler") == math.inf
    assert accurate_step(rope(damping=0.0, drag=0.0), "explicit_euler") == 0.0
    assert math.isnan(gauge(rope(1), "rk4", 0.01, State.at_rest(rope(1))).error)
