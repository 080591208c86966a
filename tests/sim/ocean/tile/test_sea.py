"""The FFT sea against the sum of its waves, its own conservation laws, and its spectrum."""

import contextvars
import math
import warnings

import numpy as np
import pytest

from sim.interruption import STOP, TURN, InterruptionError, use_request
from sim.ocean import Sea
from sim.ocean.dispersion import viscous_root
from sim.ocean.fluids.medium import Medium
from sim.ocean.spectra import SPECTRA
from sim.ocean.statistics.statistics import expected as expected_of
from sim.validation import ApproximationWarning
from tests.naive_ocean import grid_fields, sum_of_waves

FIELDS = ("height", "displacement", "slope", "jacobian")


def relative(found: np.ndarray, expected: np.ndarray) -> float:
    return float(np.abs(found - expected).max() / np.abs(expected).max())


@pytest.mark.parametrize(("precision", "tolerance"), [("double", 1e-11), ("single", 1e-5)])
@pytest.mark.parametrize("spectrum", SPECTRA)
def test_every_field_is_the_sum_of_its_waves(spectrum, precision, tolerance):
    sea = Sea(16, 60.0, spectrum, wind_speed=6.0, wind_direction=0.4, choppiness=0.8, seed=5, precision=precision)
    for t in (0.0, 17.3, -4.0):
        expected = grid_fields(sea, t)
        surface = sea.surface(t)
        for field in FIELDS:
            assert relative(getattr(surface, field), expected[field]) < tolerance, field


def test_finite_depth_tension_and_decay_are_in_the_sum_too():
    sea = Sea(12, 2.0, wind_speed=1.0, depth=0.3, tension=0.0728, viscosity=1e-5, precision="double", gravity=3.0)
    assert (sea.decay_rates[1:3, 1] > 0.0).all()
    expected = grid_fields(sea, 3.0)
    for field in FIELDS:
        assert relative(getattr(sea.surface(3.0), field), expected[field]) < 1e-11


@pytest.mark.parametrize("precision", ["single", "double"])
def test_grids_are_real_contiguous_and_of_the_precision(precision):
    surface = Sea(16, 60.0, precision=precision).surface(1.0)
    dtype = np.float32 if precision == "single" else np.float64
    assert surface.height.dtype == surface.displacement.dtype == surface.jacobian.dtype == dtype
    assert surface.height.shape == (16, 16)
    assert surface.displacement.shape == surface.slope.shape == (16, 16, 2)
    assert surface.height.flags.c_contiguous
    assert surface.displacement[..., 1].flags.c_contiguous


def test_spectrum_is_hermitian_and_parseval_holds():
    sea = Sea(32, 80.0, precision="double", seed=2)
    surface = sea.surface(9.0)
    fields = {
        "height": surface.height - surface.mean_height,
        "Dx": surface.displacement[..., 0],
        "Dy": surface.displacement[..., 1],
        "sx": surface.slope[..., 0],
        "sy": surface.slope[..., 1],
    }
    half = sea.heights_spectrum(9.0).view(np.complex128)
    # h(-k) = conj h(k) on the line ky = 0; the rest of the plane is the conjugate by construction of c2r.
    line = half[:, 0]
    assert np.abs(line - np.conj(np.roll(line[::-1], 1))).max() <= 1e-12 * np.abs(line).max()
    twice = np.where(np.arange(17) == 0, 1.0, 2.0)
    k = np.hypot(sea.k[:, None], np.abs(sea.k[None, :17]))
    k[0, 0] = 1.0
    kx, ky = sea.k[:, None], np.abs(sea.k[None, :17])
    factors = {"height": 1.0, "Dx": kx / k, "Dy": ky / k, "sx": kx, "sy": ky}
    for name, field in fields.items():
        energy = (twice * np.abs(factors[name] * half) ** 2).sum()
        assert np.mean(field**2) == pytest.approx(energy, rel=1e-12), name
        assert abs(field.mean()) < 1e-13 * np.abs(field).max()


@pytest.mark.parametrize(
    ("spectrum", "length", "size"),
    [
        ("pierson_moskowitz", 900.0, 512),
        ("jonswap", 700.0, 512),
        ("tma", 700.0, 512),
        ("phillips", 700.0, 512),
        ("elfouhaily", 1200.0, 512),
    ],
)
def test_fixed_amplitudes_have_the_height_of_the_spectrum(spectrum, length, size):
    conditions = {"wind_speed": 10.0, "depth": 20.0 if spectrum == "tma" else math.inf}
    known = {"tma": 2.00275, "elfouhaily": 2.60598, "jonswap": 2.13857}  # integrals where no exact closed form is
    declared = SPECTRA[spectrum].significant_height
    expected = known.get(spectrum) or declared(SPECTRA[spectrum].conditions(**conditions))
    sea = Sea(size, length, spectrum, amplitudes="fixed", **conditions)
    assert sea.significant_height == pytest.approx(expected, rel=5e-3)


def test_random_seas_have_the_height_of_the_spectrum_on_average():
    squares = [Sea(64, 500.0, seed=seed).significant_height ** 2 for seed in range(200)]
    target = Sea(64, 500.0, amplitudes="fixed").significant_height ** 2
    error = np.std(squares, ddof=1) / math.sqrt(len(squares))
    assert abs(np.mean(squares) - target) < 3.0 * error
    assert error < 0.02 * target


def test_the_drawn_field_has_the_height_its_amplitudes_say():
    sea = Sea(128, 600.0, "jonswap", seed=4, precision="double")
    heights = [4.0 * sea.surface(t).height.std() for t in np.arange(0.0, 400.0, 10.0)]
    assert np.mean(heights) == pytest.approx(sea.significant_height, rel=0.02)


def test_another_resolution_keeps_the_shared_wavenumbers():
    coarse, fine = (Sea(size, 300.0, seed=11, precision="double") for size in (32, 128))
    index = np.r_[0:16, 128 - 15 : 128]
    shared = np.r_[0:16, 17:32]
    np.testing.assert_array_equal(
        coarse.amplitudes_at(0.0)[np.ix_(shared, shared)], fine.amplitudes_at(0.0)[np.ix_(index, index)]
    )


def test_another_seed_is_another_sea():
    a, b = (Sea(32, 300.0, seed=seed).surface(0.0).height for seed in (0, 1))
    assert abs(np.corrcoef(a.ravel(), b.ravel())[0, 1]) < 0.5


def test_fixed_and_random_share_phases():
    a, b = (Sea(32, 300.0, amplitudes=kind, seed=3).amplitudes_at(0.0) for kind in ("random", "fixed"))
    waves = np.abs(b) > 0.0
    assert np.angle(a[waves] / b[waves]) == pytest.approx(0.0, abs=1e-12)


def test_waves_run_where_the_wind_goes():
    """A long-crested swell one step later is the same swell, shifted along the wind."""
    sea = Sea(64, 200.0, spectrum="jonswap", spreading="cos2s", spread_exponent=1000.0, wind_direction=math.pi / 2)
    before, after = sea.surface(0.0).height, sea.surface(0.5).height
    shifts = [float((after * np.roll(before, s, axis=1)).sum()) for s in (-1, 1)]
    assert shifts[1] > shifts[0]


def test_a_day_of_random_steps_does_not_drift():
    sea, rng = Sea(32, 200.0, seed=8), np.random.default_rng(0)
    t = 0.0
    while t < 86400.0:
        t += rng.uniform(0.0, 120.0)
        surface = sea.surface(t)
        _ = surface.height
    fresh = Sea(32, 200.0, seed=8).surface(t)
    for field in FIELDS:
        np.testing.assert_array_equal(getattr(surface, field), getattr(fresh, field))
    double = Sea(32, 200.0, seed=8, precision="double").surface(t).height
    assert relative(surface.height, double) < 1e-6


def test_transforms_run_only_for_what_is_read():
    sea = Sea(16, 60.0)
    counts = []
    for fields in (("height",), ("displacement",), ("slope",), ("jacobian",), FIELDS):
        before = sea.transforms.count
        surface = sea.surface(float(len(counts)))
        for field in fields + fields:
            getattr(surface, field)
        counts.append(sea.transforms.count - before)
    assert counts == [1, 2, 2, 3, 8]


def test_no_choppiness_costs_one_transform():
    sea = Sea(16, 60.0, choppiness=0.0)
    surface = sea.surface(1.0)
    assert not surface.displacement.any()
    assert (surface.jacobian == 1.0).all()
    assert sea.transforms.count == 0
    _ = surface.height, sea.surface(1.0).height
    assert sea.transforms.count == 1


def test_a_field_stays_as_it_was_while_anyone_holds_it():
    sea = Sea(16, 60.0)
    held = [sea.surface(float(t)).height for t in range(20)]
    for t, field in enumerate(held):
        np.testing.assert_array_equal(field, Sea(16, 60.0).surface(float(t)).height)


def test_choppiness_gathers_water_at_the_crests():
    """Where the surface is high it is pressed together, so that crests are sharp and troughs are wide."""
    sea = Sea(64, 200.0, wind_speed=8.0, precision="double")
    surface = sea.surface(3.0)
    # To first order J - 1 is -sum |k| h: as like the height as its own roughened self.
    assert np.corrcoef(surface.height.ravel(), surface.jacobian.ravel())[0, 1] < -0.5
    by_place = surface.jacobian / surface.jacobian.sum()
    assert float((by_place * surface.height).sum()) < 0.0  # so more of the plane lies under troughs


def test_choppiness_can_change_live():
    sea = Sea(16, 60.0, choppiness=0.5, precision="double")
    D = sea.surface(2.0).displacement
    sea.choppiness = 1.0
    np.testing.assert_allclose(sea.surface(2.0).displacement, 2.0 * D, rtol=1e-12, atol=1e-15)


def test_loop_repeats_and_plain_sea_does_not():
    sea = Sea(32, 200.0, loop_period=20.0, precision="double")
    assert relative(sea.surface(23.0).height, sea.surface(3.0).height) < 1e-11
    plain = Sea(32, 200.0, precision="double")
    assert relative(plain.surface(23.0).height, plain.surface(3.0).height) > 0.1


def test_dispersion_scale_is_a_scale_of_time():
    slow, plain = Sea(32, 200.0, dispersion_scale=0.5), Sea(32, 200.0)
    assert relative(slow.surface(8.0).height, plain.surface(4.0).height) < 1e-6


def test_viscous_sea_loses_height_and_slope():
    sea = Sea(64, 20.0, wind_speed=3.0, viscosity=1e-3)
    heights = [sea.significant_height_at(t) for t in (0.0, 60.0, 600.0)]
    assert heights[0] > heights[1] > heights[2] > 0.0
    slopes = [float(np.square(sea.surface(t).slope).sum()) for t in (0.0, 60.0)]
    assert slopes[1] / slopes[0] < (heights[1] / heights[0]) ** 2


def test_film_damps_more_than_clean_water():
    clean, film = (Sea(32, 20.0, wind_speed=3.0, viscosity=1e-6, film=f) for f in (False, True))
    assert film.significant_height_at(100.0) < clean.significant_height_at(100.0)


def test_a_change_keeps_the_decay_so_far():
    sea = Sea(64, 20.0, wind_speed=3.0, viscosity=1e-2, precision="double")
    lasting = sea.significant_height_at(300.0)
    sea.change(300.0, wind_direction=0.01)
    assert sea.significant_height_at(300.0) == pytest.approx(
        lasting, rel=0.02
    )  # random amplitudes lie in other directions
    sea.change(400.0, viscosity=0.0)
    kept = sea.significant_height_at(400.0)
    same = Sea(64, 20.0, wind_speed=3.0, wind_direction=0.01, viscosity=1e-2).significant_height_at(400.0)
    assert kept == pytest.approx(same, rel=1e-9)
    assert sea.significant_height_at(1000.0) == kept
    # A stronger wind raises what is left, and brings back nothing of what was lost.
    sea.change(1000.0, relax=5.0, wind_speed=6.0)
    assert sea.significant_height_at(1000.0) == pytest.approx(kept, rel=1e-9)
    share = sea.energy_at(2000.0) / Sea(64, 20.0, wind_speed=6.0, wind_direction=0.01).energy_at(0.0).clip(1e-300)
    k = np.hypot(sea.k[:, None], sea.k[None, :])
    _, decay = viscous_root(k, 1e-2)
    seen = sea.energy_at(2000.0) > 1e-200
    np.testing.assert_allclose(share[seen], np.exp(-2.0 * 400.0 * decay[seen]), rtol=1e-9)


def test_a_resized_sea_has_lost_as_much():
    def aged(size):
        sea = Sea(size, 20.0, wind_speed=3.0, viscosity=1e-2, precision="double")
        sea.change(5.0, viscosity=1e-3)
        sea.change(9.0, viscosity=0.0)
        return sea

    np.testing.assert_allclose(aged(32).resized(64).energy_at(9.0), aged(64).energy_at(9.0), rtol=1e-12)


def test_exposure_is_waiting_with_the_clock_stopped():
    sea, other = (Sea(32, 20.0, wind_speed=3.0, viscosity=1e-3, precision="double") for _ in range(2))
    sea.expose(50.0)
    np.testing.assert_allclose(sea.energy_at(0.0), other.energy_at(50.0), rtol=1e-12)
    still = Sea(32, 20.0, wind_speed=3.0, precision="double")
    still.expose(50.0, Medium(viscosity=1e-3))
    np.testing.assert_allclose(still.energy_at(7.0), other.energy_at(50.0), rtol=1e-12)
    height = still.surface(0.0).height
    assert 4.0 * height.std() == pytest.approx(still.significant_height, rel=0.2)
    with pytest.raises(ValueError, match="duration"):
        sea.expose(-1.0)


def test_what_is_asked_of_a_sea_without_a_time_is_at_its_own():
    sea = Sea(64, 300.0, wind_speed=6.0)
    sea.change(60.0, relax=5.0, wind_speed=12.0)
    assert sea.time == 60.0
    calm, windy = (expected_of(Sea(64, 300.0, wind_speed=U)).significant_height for U in (6.0, 12.0))
    assert expected_of(sea).significant_height == pytest.approx(calm)
    sea.surface(200.0)
    assert expected_of(sea).significant_height == pytest.approx(windy)
    for call in (sea.significant_height_at, sea.energy_at, sea.amplitudes_at, lambda t: expected_of(sea, t)):
        for t in (0.0, math.nan, math.inf):
            with pytest.raises(ValueError, match=r"^t: "):
                call(t)


def test_change_relaxes_without_a_jump():
    sea = Sea(64, 300.0, wind_speed=6.0, precision="double", seed=1)
    before = sea.surface(10.0).height
    sea.change(10.0, relax=5.0, wind_speed=15.0, wind_direction=1.0)
    assert relative(sea.surface(10.0).height, before) < 1e-12
    heights = [sea.significant_height_at(t) for t in (10.0, 12.0, 20.0, 200.0)]
    assert heights == sorted(heights)
    target = Sea(64, 300.0, wind_speed=15.0, wind_direction=1.0, seed=1)
    assert heights[-1] == pytest.approx(target.significant_height, rel=1e-9)
    # While relaxing, surface(t) is a function of t alone.
    late = sea.surface(13.0).height
    _ = sea.surface(30.0).height
    np.testing.assert_array_equal(sea.surface(13.0).height, late)


def test_phases_go_on_when_gravity_changes():
    sea = Sea(32, 200.0, precision="double", amplitudes="fixed")
    for t in (3.0, 4.0, 7.5):
        before = sea.surface(t).height
        # The spectrum changes with gravity too: keep the magnitudes by relaxing over a very long time.
        sea.change(t, relax=1e12, gravity=9.81 * t, depth=30.0)
        assert relative(sea.surface(t).height, before) < 1e-10


def test_change_back_at_the_start_is_the_old_sea():
    sea, plain = (Sea(32, 200.0, precision="double", seed=6) for _ in range(2))
    sea.change(0.0, wind_speed=20.0, spectrum="jonswap")
    sea.change(0.0, wind_speed=10.0, spectrum="pierson_moskowitz")
    assert relative(sea.surface(5.0).height, plain.surface(5.0).height) < 1e-12


def test_resizing_keeps_what_both_grids_hold():
    sea = Sea(32, 200.0, precision="double", seed=4)
    sea.change(3.0, gravity=5.0, relax=4.0)
    sea.ripples.add(4.0, [[50.0, 60.0]], 20.0, volume=500.0)
    up = sea.resized(64)
    back = up.resized(32)
    assert up.size == 64
    for t in (4.0, 9.0):
        assert relative(back.surface(t).height, sea.surface(t).height) < 1e-12
    # The waves of the smaller grid are those of the larger one below its Nyquist line.
    fine, coarse = (np.fft.rfft2(s.height - s.mean_height) / s.height.size for s in (up.surface(9.0), sea.surface(9.0)))
    fine, coarse = fine[np.r_[0:16, 49:64], :16], coarse[np.r_[0:16, 17:32], :16]
    assert np.abs(fine - coarse).max() < 1e-12 * np.abs(coarse).max()


def test_a_custom_dispersion_replaces_the_seas_own():
    sea = Sea(16, 60.0, frequency=lambda k: 2.0 * k, precision="double")
    shift = Sea(16, 60.0, precision="double")
    assert sea.frequencies[1, 0] == pytest.approx(2.0 * sea.k[1])
    assert relative(sea.surface(0.0).height, shift.surface(0.0).height) < 1e-12


QUERIES = [("single", 1e-5), ("double", 1e-9)]


@pytest.mark.parametrize(("precision", "tolerance"), QUERIES)
def test_height_query_finds_the_vertices_of_the_drawn_mesh(precision, tolerance):
    sea = Sea(64, 120.0, wind_speed=6.0, precision=precision)
    surface = sea.surface(4.0)
    x = np.arange(64) * 120.0 / 64
    points = np.stack(np.meshgrid(x, x, indexing="ij"), -1) + surface.displacement
    assert surface.jacobian.min() > 0.0
    height, residual = sea.height_at(points.reshape(-1, 2), 4.0)
    assert residual.max() < 1e-4
    assert np.abs(height - surface.height.ravel()).max() < tolerance * sea.significant_height * 10


def test_height_query_has_a_small_residual_anywhere_above_an_unfolded_sea():
    sea = Sea(128, 200.0, wind_speed=8.0)
    assert sea.surface(0.0).jacobian.min() > 0.0
    points = np.random.default_rng(0).uniform(-300.0, 500.0, (5000, 2))
    _, residual = sea.height_at(points, 0.0)
    assert residual.max() < 1e-4


def test_exact_height_query_lies_on_the_sum_of_waves():
    sea = Sea(24, 60.0, wind_speed=5.0, precision="double", seed=9)
    assert sea.surface(2.0).jacobian.min() > 0.0
    labels = np.random.default_rng(1).uniform(0.0, 60.0, (40, 2))
    f = sum_of_waves(sea, 2.0, labels[:, 0], labels[:, 1])
    height, residual = sea.height_at(labels + np.stack([f["Dx"], f["Dy"]], -1), 2.0, exact=True)
    assert residual.max() < 1e-8
    assert height == pytest.approx(f["height"] + sea.surface(2.0).mean_height, abs=1e-8)


# [m] the second-order mean is exact to third order: of a sea 9 m high 1.3 mm are left, of one 2 m high 0.04 mm
MEAN_LEVELS = [
    ({"spectrum": "sea_state", "hs": 2.0, "tp": 7.0, "length": 300.0}, 1e-4),
    ({"spectrum": "phillips", "wind_speed": 10.0, "length": 400.0}, 1e-4),  # waves both ways: the mean beats
    ({"spectrum": "tma", "wind_speed": 14.0, "length": 400.0, "depth": 10.0}, 5e-4),
    ({"spectrum": "sea_state", "hs": 9.0, "tp": 12.5, "length": 800.0}, 2.5e-3),
    ({"spectrum": "pierson_moskowitz", "wind_speed": 20.8, "length": 800.0, "choppiness": 0.6}, 2.5e-3),
]


@pytest.mark.parametrize(("values", "left"), MEAN_LEVELS)
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_mean_level_of_a_choppy_sea_is_that_of_still_water(values, left, seed):
    """The mean over places is that of h J over labels, J the exact Jacobian; of waves alone it is 2 to 20 cm low."""
    sea = Sea(128, seed=seed, precision="double", **values)
    for t in (0.0, 4.7):
        surface = sea.surface(t)
        assert surface.jacobian.min() > 0.0
        assert surface.mean_height > 10.0 * left
        assert float((surface.height * surface.jacobian).mean()) == pytest.approx(0.0, abs=left)


def test_gauges_all_over_a_choppy_sea_read_still_water_on_average():
    sea = Sea(128, 300.0, "sea_state", hs=2.0, tp=7.0)
    x = (np.arange(256) + 0.3) * 300.0 / 256
    places = np.stack(np.meshgrid(x, x, indexing="ij"), -1).reshape(-1, 2)
    surface = sea.surface(3.0)
    assert surface.mean_height > 0.03
    height, _ = sea.height_at(places, 3.0)
    assert float(height.mean()) == pytest.approx(0.0, abs=1e-3)
    # No transform more than before, and nothing at choppiness 0.
    before = sea.transforms.count
    assert sea.surface(4.0).mean_height > 0.0
    assert sea.transforms.count == before
    sea.choppiness = 0.0
    assert sea.surface(4.0).mean_height == 0.0
    assert float(np.float64(sea.surface(4.0).height).mean()) == pytest.approx(0.0, abs=1e-6)


def test_height_query_says_where_the_surface_folds():
    """Where the search is caught in a fold the residual is large; nothing is ever made up or not a number."""
    sea = Sea(128, 60.0, wind_speed=10.0, choppiness=5.0)
    surface = sea.surface(0.0)
    assert surface.jacobian.min() < 0.0
    points = np.random.default_rng(0).uniform(0.0, 60.0, (4000, 2))
    height, residual = sea.height_at(points, 0.0)
    assert np.isfinite(height).all()
    assert np.isfinite(residual).all()
    assert residual.max() > 1e-4
    assert np.abs(height).max() <= 1.5 * np.abs(surface.height).max()


def test_flat_query_needs_no_search():
    sea = Sea(32, 100.0, choppiness=0.0)
    height, residual = sea.height_at([[0.0, 0.0], [100.0 / 32, 200.0]], 1.0)
    assert height == pytest.approx(sea.surface(1.0).height[[0, 1], [0, 0]], rel=1e-5)
    assert not residual.any()


def test_unknown_condition_is_a_type_error():
    with pytest.raises(TypeError, match="wind_sped"):
        Sea(16, 50.0, wind_sped=3.0)


def test_bad_change_leaves_the_sea_alone():
    sea = Sea(16, 50.0)
    before = sea.surface(1.0).height.copy()
    with pytest.raises(ValueError, match=r"^depth"):
        sea.change(1.0, depth=-1.0)
    np.testing.assert_array_equal(sea.surface(1.0).height, before)
    assert sea.version == 0


def test_no_wind_is_a_flat_sea():
    surface = Sea(16, 50.0, wind_speed=0.0).surface(3.0)
    assert not surface.height.any()
    assert (surface.jacobian == 1.0).all()


def test_a_regular_wave_on_a_tile_is_its_nearest_wave_as_high_as_given():
    sea = Sea(64, 100.0, "regular", wave_height=1.0, wave_period=4.0, wind_speed=0.0, precision="double", seed=7)
    height = sea.surface(3.0).height
    # 24.98 m in 4 s fits four times into 100 m: 25 m.
    assert height.max() - height.min() == pytest.approx(1.0, rel=0.02)
    assert height.std() == pytest.approx(1.0 / math.sqrt(8.0), rel=1e-9)
    spectrum = np.abs(np.fft.fft2(height))
    assert np.unravel_index(spectrum.argmax(), spectrum.shape)[0] in (4, 60)
    assert expected_of(sea).significant_height == pytest.approx(sea.significant_height) == pytest.approx(math.sqrt(2.0))
    assert expected_of(sea).direction == pytest.approx(0.0)
    crossing = Sea(64, 100.0, "regular", wave_height=1.0, wave_period=4.0, second_height=0.5, second_period=3.0)
    assert expected_of(crossing).significant_height == pytest.approx(math.hypot(math.sqrt(2.0), 0.5), rel=0.05)


@pytest.mark.parametrize("direction", [0.0, 0.5, 2.4])
def test_a_regular_wave_that_a_tile_cannot_hold_is_the_nearest_that_it_can_and_warned_of(direction):
    """Waves of 126 m on a tile of 20 m, and of 1.56 m, which cells of 0.82 m are too large for: as high as given."""
    given = {"wave_height": 1.0, "wind_speed": 0.0, "wind_direction": direction, "precision": "double"}
    with pytest.warns(ApproximationWarning, match=r"a wave of 126 m is longer than the tile of 20 m"):
        long = Sea(64, 20.0, "regular", wave_period=9.0, **given)
    with pytest.warns(ApproximationWarning, match=r"a wave of 1\.56 m is too short for the grid of 54 m and 64 cells"):
        short = Sea(64, 54.0, "regular", wave_period=1.0, **(given | {"wind_direction": 0.0}))
    for sea, length in ((long, 20.0), (short, 54.0 / 31)):
        assert sea.significant_height == pytest.approx(math.sqrt(2.0))
        assert sea.surface(1.0).height.std() == pytest.approx(1.0 / math.sqrt(8.0), rel=1e-9)
        waves = sea.waves_at()
        assert 2.0 * math.pi / max(abs(waves.kx[0]), abs(waves.ky[0])) == pytest.approx(length)
    assert abs(expected_of(long).direction - direction) < math.radians(30.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        Sea(64, 47.0, "regular", wave_period=1.0, **given)
        Sea(64, 20.0, "regular", wave_period=9.0, **(given | {"wave_height": 0.0}))


def test_the_low_pass_leaves_its_share_of_the_slopes():
    """Energy by exp(-(k l)^2), so that of sum k^2 S that share is left."""
    sharp, soft = (Sea(32, 40.0, wind_speed=6.0, low_pass=length, amplitudes="fixed") for length in (0.0, 0.7))
    kk = np.add.outer(sharp.k**2, sharp.k**2)
    energy = sharp.energy_at(0.0)
    left = energy * np.exp(-kk * 0.7**2)
    assert soft.energy_at(0.0) == pytest.approx(left, rel=1e-5, abs=1e-12)
    assert soft.slope_left(0.0) == pytest.approx((kk * left).sum() / (kk * energy).sum(), rel=1e-3)
    assert sharp.slope_left(0.0) == 1.0


@pytest.mark.parametrize("direction", [0.0, 0.5 * math.pi, 4.0])
def test_the_exact_height_of_waves_in_any_direction_is_the_grid_s(direction):
    sea = Sea(16, 30.0, wind_speed=6.0, wind_direction=direction, choppiness=0.0)
    x = np.arange(16) * 30.0 / 16
    points = np.stack(np.meshgrid(x, x, indexing="ij"), -1).reshape(-1, 2)
    height, _ = sea.height_at(points, 2.0, exact=True)
    assert height.reshape(16, 16) == pytest.approx(sea.surface(2.0).height, abs=1e-5)


@pytest.mark.parametrize(
    ("points", "exact", "choppiness"), [(20_000, False, 1.0), (20_000, False, 0.0), (1, True, 1.0)]
)
def test_many_points_and_one_sum_of_all_waves_give_turns_and_can_be_ended(points, exact, choppiness):
    sea, request, turns = Sea(16, 100.0, choppiness=choppiness), np.array([0, 0, 1, 0], np.int64), []
    where = np.random.default_rng(0).uniform(0.0, 100.0, (points, 2))
    sea.height_at(where, 0.0, exact)  # all that is made once

    def turn():
        turns.append(1)
        request[TURN], request[STOP] = 1, len(turns) >= 3

    def try_out():
        use_request(request, turn)
        with pytest.raises(InterruptionError):
            sea.height_at(where, 0.0, exact)

    contextvars.copy_context().run(try_out)
    assert len(turns) <= 4  # not of every sum and not of every piece
