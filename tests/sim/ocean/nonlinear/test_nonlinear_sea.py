"""Nonlinear seas against linear ones, against steep waves of constant form, and by what they conserve."""

import math

import numpy as np
import pytest

from sim.ocean import Sea
from sim.ocean.nonlinear import NonlinearSea, stokes_wave
from sim.validation import DivergenceError

LENGTH = 50.0  # [m]
K = 2.0 * math.pi / LENGTH


def steep(steepness: float, order: int, size: int = 24, depth: float = math.inf, **more) -> tuple:
    """A wave of half height over length `steepness`/k, the sea that starts with it, and its period [s]."""
    wave = stokes_wave(2.0 * steepness / K, LENGTH, depth, order=20)
    x = np.arange(size) * LENGTH / size
    start = wave.elevation(x), wave.potential(x)
    sea = NonlinearSea(length=LENGTH, order=order, depth=depth, start=start, **({"breaking": False} | more))
    return wave, sea, LENGTH / wave.speed


def form_error(wave, sea) -> tuple[float, float]:
    """Largest difference of the forms over the height, each at its own phase, and relative error of the speed."""
    h, turn = np.fft.rfft(sea.height[:, 0]), -K * wave.speed * sea.time
    lag = np.angle(h[1] * np.exp(-1j * turn))
    shifted = np.fft.irfft(h * np.exp(-1j * np.arange(len(h)) * np.angle(h[1])), len(sea.height))
    x = np.arange(len(sea.height)) * LENGTH / len(sea.height)
    return np.abs(shifted - wave.elevation(x)).max() / wave.height, -lag / (K * wave.speed * sea.time)


@pytest.mark.parametrize("depth", [math.inf, 12.0])
def test_order_1_is_the_linear_sea(depth):
    linear = Sea(32, 200.0, "jonswap", wind_speed=9.0, depth=depth, choppiness=0.0, precision="double", seed=4)
    sea = NonlinearSea(size=32, length=200.0, order=1, depth=depth, start=linear)
    points = [[3.0, 70.0, -1.0], [111.0, -20.0, -7.0]]
    for t in (0.0, 13.0, 1000.0):
        sea.advance(t)
        wanted = linear.surface(t).height
        assert np.abs(sea.height - wanted).max() < 1e-12 * np.abs(wanted).max()
        flow, other = sea.kinematics(points), linear.kinematics(points, t)
        assert flow.velocity == pytest.approx(other.velocity, abs=1e-12)
        assert flow.acceleration == pytest.approx(other.acceleration, abs=1e-12)
    assert sea.significant_height == pytest.approx(linear.significant_height, rel=1e-12)
    assert sea.energy.kinetic == pytest.approx(sea.energy.potential, rel=1e-12)
    assert sea.steps == 0


def test_a_linear_sea_may_start_at_any_time_and_on_another_grid():
    linear = Sea(16, 200.0, "jonswap", wind_speed=12.0, choppiness=0.0, precision="double")
    linear.surface(40.0)
    fine, coarse = (NonlinearSea(size=size, order=1, start=linear) for size in ((32, 64), (16, 8)))
    assert fine.time == coarse.time == 40.0
    fine.advance(41.0)
    assert fine.height[::2, ::4] == pytest.approx(linear.surface(41.0).height, abs=1e-12)
    assert 0.0 < coarse.significant_height < linear.significant_height


@pytest.mark.parametrize("depth", [math.inf, 2.0 / K])
def test_the_speed_of_a_steep_wave_falls_into_place_with_the_order(depth):
    for steepness in (0.1, 0.2, 0.3):
        errors = []
        for order in (3, 5, 7):
            wave, sea, period = steep(steepness, order, depth=depth)
            sea.advance(3.0 * period)
            errors.append(abs(form_error(wave, sea)[1]))
        # Measured in deep water: 1.4e-5, 1.4e-7, 3e-8 at 0.1; 1.5e-3, 9e-5, 5e-6 at 0.3; at kd = 2 up to 1.6 times.
        assert errors[2] < errors[1] < errors[0] < 3e-3
        assert errors[2] < 2e-5


@pytest.mark.parametrize(("steepness", "depth"), [(0.1, math.inf), (0.2, math.inf), (0.3, math.inf), (0.15, 8.0)])
def test_a_steep_wave_keeps_its_form_for_20_periods(steepness, depth):
    wave, sea, period = steep(steepness, 7, depth=depth)
    sea.advance(20.0 * period)
    form, speed = form_error(wave, sea)
    assert form < 1e-3  # measured: 2e-6, 1e-5, 5e-4, 2e-5
    assert abs(speed) < 1e-3


@pytest.mark.long  # a long run
def test_energy_over_100_periods():
    _, sea, period = steep(0.1, 5, 16, step=LENGTH / 8.9 / 100)
    sea.advance(100.0 * period)
    account = sea.energy
    assert abs(account.error) < 1e-6 * (account.kinetic + account.potential)
    assert account.breaking == account.fade_in == 0.0


def test_steps_converge_with_order_4():
    ends = []
    for parts in (20, 40, 80):
        _, sea, _ = steep(0.2, 3, 16, step=LENGTH / 9.0 / parts)
        sea.advance(LENGTH / 9.0)
        ends.append(sea.height)
    ratio = np.abs(ends[0] - ends[1]).max() / np.abs(ends[1] - ends[2]).max()
    assert 12.0 < ratio < 20.0
    assert sea.steps == 80


def test_frames_do_not_change_the_steps():
    seas = [steep(0.2, 3, 16, rtol=1e-6)[1] for _ in range(2)]
    for t in np.linspace(0.0, 10.0, 101):
        seas[0].advance(t)
        between = seas[0].height
    seas[1].advance(10.0)
    assert np.array_equal(between, seas[1].height)
    assert seas[0].steps == seas[1].steps


def test_a_frame_inside_a_step_is_on_the_way():
    wave, sea, _ = steep(0.1, 5, 16, step=0.2)
    for t in (0.03, 0.1, 0.17):
        sea.advance(t)
        assert form_error(wave, sea)[0] < 2e-5
        assert abs(sea.energy.error) < 1e-5 * sea.energy.potential


def test_a_wave_in_any_direction_is_the_same_wave():
    """Along y and obliquely, on rectangles, as exact as along x, a simpler case with one row of waves."""
    wave, sea, _ = steep(0.2, 4, 16, step=0.1)
    sea.advance(5.0)
    wanted, potential = sea.height[:, 0], sea.potential[:, 0]
    x = np.arange(16) * LENGTH / 16
    for shape, count in (((8, 16), (0, 1)), ((16, 4), (1, 0)), ((16, 16), (1, 1)), ((16, 16), (-1, 1))):
        sides = tuple(LENGTH * math.hypot(*count) / max(abs(c), 1) for c in count)
        grid = (
            np.arange(shape[0])[:, None] * count[0] * 16 // shape[0] + np.arange(shape[1]) * count[1] * 16 // shape[1]
        )
        index = grid % 16
        start = wave.elevation(x)[index], wave.potential(x)[index]
        other = NonlinearSea(length=sides, order=4, start=start, breaking=False, step=0.1)
        other.advance(5.0)
        assert other.height == pytest.approx(wanted[index], abs=1e-9)
        assert other.potential == pytest.approx(potential[index], abs=1e-8)


def test_still_water_stays_still():
    sea = NonlinearSea(length=10.0, start=(np.zeros((8, 8)), np.zeros((8, 8))))
    sea.advance(5.0)
    assert not sea.height.any()
    assert sea.significant_height == sea.energy.error == 0.0
    assert not sea.kinematics([[1.0, 1.0, -1.0]]).velocity.any()


def test_too_steep_for_the_order_is_an_error_that_says_so():
    _, sea, period = steep(0.4, 3, 64)
    with pytest.raises(DivergenceError, match=r"solution fails after t = \d.*too steep for this order"):
        sea.advance(20.0 * period)
    last = sea.time
    assert 0.0 < last < 20.0 * period
    assert np.abs(sea.height).max() < 8.0
    with pytest.raises(ValueError, match="the time of the sea"):
        sea.advance(0.5 * last)
    with pytest.raises(DivergenceError):
        sea.advance(20.0 * period)
    assert sea.time == pytest.approx(last, rel=0.01)
    _, sea, period = steep(0.4, 3, 64, step=0.05)
    with pytest.raises(DivergenceError):
        sea.advance(20.0 * period)


LINEAR = {"size": 16, "length": 100.0, "spectrum": "sea_state", "hs": 1.0, "tp": 5.0}
LEVEL = np.zeros((16, 8))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"order": 8}, "order: 8.*from 1 to 7"),
        ({"order": 2.0}, "order: 2.0"),
        ({"size": 12}, r"size: 12.*that of the arrays, \(16, 8\)"),
        ({"size": (16, 3)}, "size: .*even whole numbers"),
        ({"size": (16, 8, 1)}, "size: .*even whole numbers"),
        ({"length": None}, "length: None"),
        ({"length": (10.0, 0.0)}, "length: 0.0"),
        ({"length": (1.0, 2.0, 3.0)}, "length: "),
        ({"depth": 0.0}, "depth: 0.0"),
        ({"gravity": math.nan}, "gravity: nan"),
        ({"density": -1.0}, "density: -1.0"),
        ({"fade": -1.0}, "fade: -1.0"),
        ({"step": 0.0}, "step: 0.0"),
        ({"rtol": 1.0}, "rtol: 1.0"),
        ({"breaking": 1}, "breaking: 1"),
        ({"start": None}, "start: None.*a Sea, Waves, or elevation and potential"),
        ({"start": (LEVEL, LEVEL[:8])}, "start: "),
        ({"start": (LEVEL, LEVEL + math.nan)}, "start: "),
        ({"start": (LEVEL[:, :3], LEVEL[:, :3])}, "size: "),
        ({"start": ([], [])}, "size: "),
        ({"start": Sea(**LINEAR), "length": 99.0}, "length: 99.0.*that of the waves it starts from, 100"),
        ({"start": Sea(**LINEAR), "depth": 5.0}, "depth: 5.0.*that of the waves it starts from, inf"),
        ({"start": Sea(**LINEAR, tension=0.07)}, "without tension, viscosity"),
        ({"start": Sea(**LINEAR, viscosity=1e-6)}, "without tension, viscosity"),
    ],
)
def test_refusals(arguments, message):
    with pytest.raises(ValueError, match=message):
        NonlinearSea(**({"length": 100.0, "start": (LEVEL, LEVEL)} | arguments))


def test_times_and_points_that_are_refused():
    sea = NonlinearSea(start=Sea(**LINEAR))
    sea.advance(2.0)
    for t, message in ((1.0, "t: 1.0.*the time of the sea, 2 s, or later"), (math.nan, "t: nan")):
        with pytest.raises(ValueError, match=message):
            sea.advance(t)
    with pytest.raises(ValueError, match="points"):
        sea.kinematics([[0.0, 0.0]])


def test_the_energy_account_of_a_linear_start():
    """The fade-in adds the energy of bound waves, of second order; afterwards breaking accounts for the rest."""
    linear = Sea(32, 120.0, "sea_state", hs=1.6, tp=5.0, precision="double")
    sea = NonlinearSea(start=linear, order=3, fade=8.0)
    begun = sea.energy
    sea.advance(15.0)
    during = sea.energy
    assert during.error == 0.0
    assert during.kinetic + during.potential + during.breaking == pytest.approx(
        begun.kinetic + begun.potential + during.fade_in
    )
    assert 0.0 < abs(during.fade_in) < 0.05 * begun.potential
    sea.advance(25.0)
    fixed = sea.energy.fade_in
    sea.advance(40.0)
    after = sea.energy
    assert after.fade_in == fixed
    assert after.breaking > during.breaking > 0.0
    assert abs(after.error) < 3e-5 * after.potential
    fine = NonlinearSea(start=linear, order=3, fade=8.0, step=0.1)
    fine.advance(40.0)
    assert fine.energy.fade_in == pytest.approx(after.fade_in, rel=0.05)
    assert fine.energy.breaking == pytest.approx(after.breaking, rel=1e-3)


def test_breaking_takes_what_is_too_steep():
    """A sea of k_p Hs/2 = 0.45, which is impossible, loses energy until it is possible; the account holds."""
    linear = Sea(32, 160.0, "sea_state", hs=8.0, tp=6.0, precision="double")
    sea = NonlinearSea(start=linear, order=3, fade=6.0, rtol=1e-4)
    steepest = np.abs(sea.slope).max()
    sea.advance(30.0)
    account = sea.energy
    assert steepest > 0.9
    assert np.abs(sea.slope).max() < 0.8
    assert account.breaking > 0.2 * account.potential
    assert abs(account.error) < 0.02 * (account.kinetic + account.potential)


def test_breaking_leaves_a_wave_that_does_not_break():
    wave, sea, period = steep(0.2, 5, 32, breaking=True)
    sea.advance(10.0 * period)
    assert form_error(wave, sea)[0] < 1e-3
    assert sea.energy.breaking < 1e-6 * sea.energy.potential


@pytest.mark.stress
@pytest.mark.timeout(3600)
@pytest.mark.parametrize(("hs", "tp"), [(0.0, 6.0), (3.0, 8.0), (4.0, 6.0), (8.0, 6.0), (20.0, 6.0)])
@pytest.mark.parametrize("order", [2, 3, 5])
@pytest.mark.parametrize("depth", [math.inf, 10.0])
def test_seas_of_all_steepnesses_go_on_or_say_why(hs, tp, order, depth):
    linear = Sea(48, 240.0, "sea_state", hs=hs, tp=tp, depth=depth, precision="double")
    sea = NonlinearSea(start=linear, order=order, fade=2.0 * tp, rtol=1e-4)
    diverged = False
    try:
        sea.advance(15.0 * tp)
    except DivergenceError:
        diverged = True
    if diverged:
        assert hs / tp**2 > 0.2
        assert np.isfinite(sea.height).all()
    else:
        account = sea.energy
        assert np.abs(sea.height).max() <= 2.0 * hs
        assert account.breaking >= 0.0
        assert abs(account.error) <= 0.03 * (account.kinetic + account.potential)


@pytest.mark.parametrize("depth", [math.inf, 12.0])
def test_a_steep_wave_runs_alike_in_every_direction(depth: float) -> None:
    """k a = 0.2 along eight wavenumbers of one length: speed and crest after a period, order 3."""
    side, n = 200.0, 48
    wave = stokes_wave(0.4 * side / (2.0 * math.pi * 5.0), side / 5.0, depth, order=12)
    x = np.arange(n) * side / n
    X, Y = np.meshgrid(x, x, indexing="ij")
    speeds, crests = [], []
    for i, j in ((5, 0), (4, 3), (3, 4), (0, 5), (-3, 4), (-4, 3), (-5, 0), (4, -3)):
        along = (i * X + j * Y) / 5.0
        start = wave.elevation(along), wave.potential(along)
        sea = NonlinearSea(length=side, order=3, depth=depth, start=start, breaking=False, step=0.1)
        before = np.fft.fft2(sea.height)[i, j]
        sea.advance(0.4 * wave.wavelength / wave.speed)
        turned = np.angle(before / np.fft.fft2(sea.height)[i, j])
        speeds.append(abs(turned) / (0.8 * math.pi) * wave.speed)
        crests.append(float(sea.waves_at().amplitude.max()))
    assert speeds == pytest.approx([wave.speed] * 8, rel=3e-3)
    assert np.ptp(speeds) < 1e-5 * wave.speed
    assert np.ptp(crests) < 1e-5 * wave.height


def test_the_drift_of_the_energy_is_the_error_of_the_account() -> None:
    """k a = 0.2 over 10 periods: 5e-6 of the energy at the default tolerance, a hundredth of that at 1e-8."""
    drifts = []
    for rtol in (1e-6, 1e-8):
        wave = stokes_wave(0.4 * 100.0 / (2.0 * math.pi), 100.0, order=12)
        x = np.arange(64) * 100.0 / 64
        start = wave.elevation(x), wave.potential(x)
        sea = NonlinearSea(length=100.0, start=start, breaking=False, rtol=rtol)
        before = sea.energy.kinetic + sea.energy.potential
        sea.advance(10.0 * 100.0 / wave.speed)
        drift = sea.energy.kinetic + sea.energy.potential - before
        assert sea.energy.error == pytest.approx(drift, abs=1e-12 * before)
        drifts.append(drift / before)
    assert -1e-5 < drifts[0] < -2e-6
    assert abs(drifts[1]) < 0.01 * abs(drifts[0])
