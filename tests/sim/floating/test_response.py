"""Response amplitudes: against Capytaine's own on a committed dataset, against the boundary, and limits."""

import math
from pathlib import Path

import numpy as np
import pytest

from sim.floating import Body, Hull, linear_forces, response_amplitude, with_dataset
from sim.floating.linear.dataset import MOTIONS
from sim.floating.linear.hydrodynamics import velocity_at
from tests.refusals import assert_refused

xarray = pytest.importorskip("xarray")
BARGE = Path(__file__).parents[3] / "assets" / "barge.nc"
HEADINGS = (0, 30, 60, 90, 140)  # [degrees]


@pytest.fixture(scope="module")
def dataset():
    pytest.importorskip("netCDF4")
    with xarray.open_dataset(BARGE) as found:
        return found.load()


@pytest.fixture(scope="module")
def body(dataset) -> Body:
    mass = dataset["inertia_matrix"].values
    hull = with_dataset(Hull.box(60.0, 16.0, 6.0), BARGE)
    return Body(hull, mass=mass[0, 0], center_of_gravity=(0.0, 0.0, 1.0), inertia=mass[3:, 3:])


def capytaines(dataset) -> np.ndarray:
    """Its own response (frequencies, directions, 6)."""
    values = dataset["RAO"].transpose("complex", "omega", "wave_direction", "radiating_dof").values
    return values[0] + 1j * values[1]


@pytest.mark.parametrize("heading", HEADINGS)
def test_the_response_of_a_barge_is_capytaines(dataset, body, heading):
    """1 % of the greatest; what is left is the asymmetry of Capytaine's coefficients, of which the mean is taken."""
    known = capytaines(dataset)
    omega = dataset["omega"].values
    waves = np.isfinite(omega)
    known = known[: waves.sum()]
    (j,) = np.flatnonzero(np.isclose(dataset["wave_direction"].values, math.radians(heading)))
    found = response_amplitude(body, omega[waves], math.radians(heading))
    greatest = np.abs(known).max(axis=(0, 1))
    for motion in ("Heave", "Roll", "Pitch"):
        m = MOTIONS.index(motion)
        assert found[:, m] == pytest.approx(known[:, j, m], abs=0.01 * greatest[m]), motion


def test_the_other_side_is_the_mirror_image(body):
    left, right = response_amplitude(body, [0.9], 0.7), response_amplitude(body, [0.9], -0.7)
    assert left * [1, -1, 1, -1, 1, -1] == pytest.approx(right, abs=1e-9)


def test_a_dataset_about_another_point_of_a_shifted_hull_is_the_same(tmp_path, dataset, body):
    """The hull 5 m along x and 2 m along y in its file, and motions about another centre of rotation."""
    moved = dataset.copy(deep=True)
    omega, heading = moved["omega"].values, moved["wave_direction"].values
    k = np.where(np.isfinite(omega), omega, 0.0) ** 2 / 9.81
    T = velocity_at(1.0, -0.5, -2.0)  # to the new centre from the old one
    back = np.linalg.inv(T)
    for name in ("added_mass", "radiation_damping"):
        values = moved[name].transpose("omega", "influenced_dof", "radiating_dof")
        moved[name] = values.copy(data=back.T @ values.values @ back)
    phase = np.exp(1j * k[:, None] * (5.0 * np.cos(heading) + 2.0 * np.sin(heading)))
    for name in ("diffraction_force", "Froude_Krylov_force"):
        values = moved[name].transpose("complex", "omega", "wave_direction", "influenced_dof")
        X = (values.values[0] + 1j * values.values[1]) @ back * phase[:, :, None]
        moved[name] = values.copy(data=np.stack([X.real, X.imag]))
    moved["rotation_center"] = ("space_coordinate", [6.0, 1.5, -1.0])
    moved.to_netcdf(tmp_path / "moved.nc")
    hull = with_dataset(Hull.from_arrays(body.hull.vertices + [5.0, 2.0, 0.0], body.hull.faces), tmp_path / "moved.nc")
    other = body._replace(hull=hull, center_of_gravity=(5.0, 2.0, 1.0))
    w = np.array([0.35, 0.8, 1.25])
    assert response_amplitude(other, w, 1.0) == pytest.approx(response_amplitude(body, w, 1.0), rel=1e-6, abs=1e-9)


def test_the_velocity_at_a_place_of_a_rigid_body_is_its_own_and_that_of_its_spin():
    v, spin, r = np.random.default_rng(4).normal(size=(3, 3))
    assert velocity_at(*r) @ np.append(v, spin) == pytest.approx(np.append(v + np.cross(spin, r), spin))


def test_long_waves_carry_the_body_and_tilt_it_as_they_are_steep():
    body = Body(Hull.box(30.0, 10.0, 6.0), density=512.5)
    w = np.array([0.2])
    ahead, beam = response_amplitude(body, w, 0.0)[0], response_amplitude(body, w, math.pi / 2)[0]
    k = 0.2**2 / 9.81
    assert ahead[2] == pytest.approx(1.0, abs=0.02)
    assert beam[3] == pytest.approx(1j * k, rel=0.06)  # the slope of cos(k y) is -k sin: Re(i k e^(i(k y - wt)))
    assert ahead[4] == pytest.approx(-1j * k, rel=0.06)


def test_in_two_fluids_the_heave_of_a_long_wave_is_the_wave():
    body = Body(Hull.box(30.0, 10.0, 6.0), density=512.5)
    spill = [(850.0, 1.0), (1025.0, math.inf)]
    assert abs(response_amplitude(body, [0.03], 0.3, spill)[0, 2]) == pytest.approx(1.0, abs=5e-3)
    pitch, alone = (response_amplitude(body, [0.2], 0.3, layers)[0, 4] for layers in (spill, spill[1:]))
    assert pitch == pytest.approx(alone, rel=0.02)


@pytest.mark.parametrize(
    ("name", "change", "words"),
    [
        ("path", lambda d: d.drop_vars("added_mass"), "added_mass"),
        ("path", lambda d: d.isel(wave_direction=[0, 9, 18]), "30 degrees apart"),
        ("path", lambda d: d.isel(omega=[0, 1, 2]), "four frequencies"),
        ("path", lambda d: d.isel(influenced_dof=[0, 2]), "the motions"),
        ("draft", lambda d: d.drop_vars("draught"), "draught"),
    ],
)
def test_a_dataset_that_does_not_fit_is_refused(tmp_path, dataset, name, change, words):
    change(dataset).to_netcdf(tmp_path / "bad.nc")
    assert_refused(name, lambda: with_dataset(Hull.box(60.0, 16.0, 6.0), tmp_path / "bad.nc"), words)


def test_what_is_no_dataset_is_refused(tmp_path):
    (tmp_path / "text.nc").write_text("no", "utf-8")
    for path in (tmp_path / "text.nc", tmp_path / "none.nc"):
        assert_refused("path", lambda path=path: with_dataset(Hull.box(1.0, 1.0, 1.0), path), "export_dataset")


def test_frequencies_of_any_shape_have_the_answers_of_a_list():
    body = Body(Hull.box(30.0, 10.0, 6.0), density=512.5)
    listed, forces = response_amplitude(body, [0.5, 0.9], 0.4), linear_forces(body, [0.5, 0.9], 0.4)
    one = response_amplitude(body, 0.5, 0.4)
    assert one.shape == (6,)
    assert one == pytest.approx(listed[0], rel=1e-12)
    assert response_amplitude(body, [[0.5], [0.9]], 0.4) == pytest.approx(listed[:, None], rel=1e-12)
    single = linear_forces(body, 0.9, 0.4)
    for name in ("added", "damping", "excitation"):
        assert np.array_equal(getattr(single, name), getattr(forces, name)[1])
    assert response_amplitude(body, [], 0.4).shape == (0, 6)


def test_the_response_of_a_box_by_the_shipped_table_is_capytaines():
    """Surge, heave and pitch in head seas, by Capytaine 3.0 on panels of 1.5 m: draft 4 m of 40 x 40 x 10 m."""
    omega = np.array([0.35, 0.5, 0.65, 0.8, 0.95, 1.1])
    mass = 1025.0 * 40.0 * 40.0 * 4.0
    inertia = tuple(mass * np.array([0.35, 0.26, 0.26]) ** 2 * 40.0**2)
    box = Body(Hull.box(40.0, 40.0, 10.0), mass=mass, center_of_gravity=(0.0, 0.0, 1.0), inertia=inertia)
    found = np.abs(response_amplitude(box, omega))
    for motion, expected, within in (
        (0, (0.952, 0.876, 0.740, 0.552, 0.206, 0.270), 0.02),
        (2, (0.996, 0.991, 0.994, 0.934, 0.536, 0.212), 0.01),
        (4, (0.0123, 0.0248, 0.0415, 0.0686, 0.1523, 0.0559), 0.03),
    ):
        assert found[:, motion] == pytest.approx(expected, abs=within * max(expected))
