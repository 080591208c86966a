"""Capytaine's datasets of other forms than `barge.nc`: response against its own RAO, and refusals with a way out."""

import math
from pathlib import Path

import numpy as np
import pytest

from sim.dispersion import wavenumber
from sim.floating import Body, Hull, float_in, heave_period, make_fleet, response_amplitude, roll_period, with_dataset
from sim.floating.linear.hydrodynamics import radiated_share
from sim.floating.linear.linear_table import read_table, write_table
from sim.floating.linear.response import linear_forces
from sim.mooring.moored import moored
from sim.ocean import SPECTRA, RadialSea, Sea, draw_waves
from sim.validation import ApproximationWarning
from sim.water import Water
from tests.refusals import assert_refused

pytest.importorskip("netCDF4")
xarray = pytest.importorskip("xarray")
FOLDER = Path(__file__).parent / "datasets"
BOXES = {"fore": ((20.0, 10.0, 4.0), (-20.0, 0.0, -0.5)), "aft": ((8.0, 8.0, 4.0), (10.0, 5.0, -0.3))}
AXES = ("complex", "omega", "wave_direction", "radiating_dof")


@pytest.fixture(scope="module")
def depths():
    with xarray.open_dataset(FOLDER / "depths.nc") as found:
        return found.load()


@pytest.fixture(scope="module")
def bodies():
    with xarray.open_dataset(FOLDER / "bodies.nc") as found:
        return found.load()


def box(name: str, place: tuple[float, float], path: Path, **choice) -> Body:
    """The box of a dataset at its place, loaded as Capytaine's was."""
    (x, y, z), centre = BOXES[name]
    plain = Hull.box(x, y, z)
    hull = with_dataset(Hull.from_arrays(plain.vertices + [*place, 0.0], plain.faces), path, **choice)
    mass = 1025.0 * x * y * 2.0
    inertia = mass / 12.0 * np.array([y**2 + z**2, x**2 + z**2, x**2 + y**2])
    return Body(hull, mass=mass, center_of_gravity=(*place, centre[2]), inertia=inertia)


def written(dataset, folder: Path, change) -> Path:
    """The file of a changed dataset."""
    path = folder / "changed.nc"
    change(dataset.copy(deep=True)).to_netcdf(path)
    return path


def assert_is_capytaines(body: Body, dataset, prefix: str, heading: float) -> None:
    """The response is Capytaine's RAO within 1e-5 of its greatest, at the frequencies of the dataset."""
    part = dataset if "omega" in dataset.dims else dataset.swap_dims(period="omega")
    names = [f"{prefix}{motion}" for motion in ("Surge", "Sway", "Heave", "Roll", "Pitch", "Yaw")]
    part = part.sel(omega=np.isfinite(part["omega"])).sel(radiating_dof=names)
    rao = part["RAO"].transpose(*AXES).values
    (j,) = np.flatnonzero(np.isclose(part["wave_direction"].values, heading))
    (x, y), k = body.center_of_gravity[:2], part["wavenumber"].values
    here = np.exp(-1j * k * (x * math.cos(heading) + y * math.sin(heading)))
    known = (rao[0] + 1j * rao[1])[:, j] * here[:, None]
    found = response_amplitude(body, part["omega"].values, heading)
    greatest = np.abs(known).max(axis=0)
    assert (np.abs(found - known) < 1e-5 * greatest + 1e-6 * greatest.max()).all()


@pytest.mark.parametrize("depth", [20.0, math.inf])
@pytest.mark.parametrize("heading", [0.0, 30.0, 60.0, 90.0])
def test_the_response_in_water_of_a_depth_is_capytaines(depths, depth, heading):
    body = box("fore", (0.0, 0.0), FOLDER / "depths.nc", depth=depth)
    assert_is_capytaines(body, depths.sel(water_depth=depth), "", math.radians(heading))


@pytest.mark.parametrize(("name", "heading"), [("fore", 30.0), ("aft", 210.0)])
def test_the_response_of_one_of_two_bodies_by_period_is_capytaines(bodies, name, heading):
    body = box(name, BOXES[name][1][:2], FOLDER / "bodies.nc", body=name)
    assert_is_capytaines(body, bodies, f"{name}__", math.radians(heading))


@pytest.mark.parametrize("end", [2.0 * math.pi, -1e-17])
def test_a_dataset_with_a_whole_turn_beside_0_is_read(tmp_path, bodies, end):
    def add(d):
        ahead = d.isel(wave_direction=[0]).assign_coords(wave_direction=[end])
        return xarray.concat([d, ahead], "wave_direction", data_vars="minimal")

    body = box("fore", BOXES["fore"][1][:2], written(bodies, tmp_path, add), body="fore")
    assert_is_capytaines(body, bodies, "fore__", 0.0)
    assert_is_capytaines(body, bodies, "fore__", math.radians(330.0))


@pytest.mark.parametrize("axis", ["period", "freq", "wavelength", "wavenumber"])
def test_every_axis_of_frequencies_is_read(tmp_path, depths, axis):
    """The infinite frequency has a wavelength and a period of 0."""
    path = written(depths.sel(water_depth=20.0), tmp_path, lambda d: d.swap_dims(omega=axis).sortby(axis))
    body, known = box("fore", (0.0, 0.0), path), box("fore", (0.0, 0.0), FOLDER / "depths.nc", depth=20.0)
    w = np.array([0.4, 1.0, 1.9])
    assert response_amplitude(body, w, 0.5) == pytest.approx(response_amplitude(known, w, 0.5), rel=1e-12)


def test_a_dataset_of_one_heading_is_used_at_that_heading_only(tmp_path, depths):
    heading = math.radians(45.0)
    path = written(depths.sel(water_depth=20.0), tmp_path, lambda d: d.isel(wave_direction=[3]))
    one = box("fore", (0.0, 0.0), path)
    chosen = box("fore", (0.0, 0.0), FOLDER / "depths.nc", depth=20.0, heading=heading)
    for body in (one, chosen):
        assert_is_capytaines(body, depths.sel(water_depth=20.0), "", heading)
        assert_refused("heading", lambda body=body: response_amplitude(body, [0.8], 0.7), "0.785398 rad")
    w = [0.3, 0.349]  # below the dataset, where the damping continues
    B = linear_forces(one, [*w, 0.35], heading).damping[:, 2, 2]
    assert B[1] == pytest.approx(B[2], rel=0.01)
    shares = [radiated_share(float(wavenumber(np.array(v / math.sqrt(9.81)), 1.0, 20.0)), 20.0) for v in w]
    assert B[0] / B[1] == pytest.approx(shares[0] / shares[1])


def test_in_long_waves_of_shallow_water_the_body_moves_with_the_water():
    """Surge a coth(kd), heave a, below the dataset; and no step at its first frequency."""
    body = box("fore", (0.0, 0.0), FOLDER / "depths.nc", depth=20.0)
    for w in (0.05, 0.02):
        k = float(wavenumber(np.array(w / math.sqrt(9.81)), 1.0, 20.0))
        found = response_amplitude(body, [w], 0.0)[0]
        assert found[2] == pytest.approx(1.0, abs=0.02)
        assert found[0] == pytest.approx(1j / math.tanh(k * 20.0), rel=0.02)
    below, above = response_amplitude(body, [0.3499, 0.3501], 0.4)
    assert above == pytest.approx(below, rel=2e-3, abs=1e-5)


def test_a_dataset_without_centre_takes_the_one_given(tmp_path, depths):
    bare = lambda d: d.drop_vars(["rotation_center", "center_of_mass"])  # noqa: E731
    path = written(depths.sel(water_depth=20.0), tmp_path, bare)
    assert_refused("rotation_center", lambda: with_dataset(Hull.box(20.0, 10.0, 4.0), path), "center_of_mass")
    body = box("fore", (0.0, 0.0), path, rotation_center=(0.0, 0.0, -0.5))
    assert_is_capytaines(body, depths.sel(water_depth=20.0), "", 0.0)


def test_of_several_speeds_the_part_without_speed_is_read(tmp_path, depths):
    def moving(d):
        for name in ("added_mass", "radiation_damping", "diffraction_force", "Froude_Krylov_force"):
            values = d[name].expand_dims(speed=2) * xarray.DataArray([1.0, 1.1], dims="speed")
            d[name] = (
                values.expand_dims(wave_direction=d["wave_direction"]) if "mass" in name or "damp" in name else values
            )
        return d.drop_vars("forward_speed").rename(speed="forward_speed").assign_coords(forward_speed=[0.0, 2.0])

    path = written(depths.sel(water_depth=20.0), tmp_path, moving)
    assert_is_capytaines(box("fore", (0.0, 0.0), path), depths.sel(water_depth=20.0), "", math.pi / 2)


@pytest.mark.parametrize("first", [0.0, -180.0, 90.0, -360.0])
def test_directions_of_a_full_turn_have_one_at_both_ends_once(tmp_path, first):
    """0 to 360 degrees, or -180 to 180, as without the repeated one."""
    turn = np.arange(13) * 30.0
    values = np.random.default_rng(1).uniform(0.5, 1.5, 12)[np.arange(13) % 12]  # no symmetry helps

    def around(count: int) -> Body:
        headings = np.radians(turn[:count] + first)
        factor = xarray.DataArray(
            np.roll(values[:12], int(first // 30))[np.arange(13) % 12][:count], dims="wave_direction"
        )

        def change(d):
            d = d.isel(wave_direction=[0] * count).assign_coords(wave_direction=headings)
            return d.assign({name: d[name] * factor for name in ("diffraction_force", "Froude_Krylov_force")})

        path = tmp_path / f"{count}.nc"
        with xarray.open_dataset(FOLDER / "depths.nc") as found:
            change(found.load().sel(water_depth=20.0)).to_netcdf(path)
        return box("fore", (0.0, 0.0), path)

    omega = [0.5, 0.8, 1.2]
    for heading in (0.0, 0.3, 3.1, 6.0):
        full, once = (response_amplitude(around(count), omega, heading) for count in (13, 12))
        assert np.abs(full - once).max() <= 1e-12 * np.abs(once).max()


def test_coefficients_that_are_not_finite_are_refused(tmp_path):
    hull = Hull.box(20.0, 10.0, 4.0)
    table = with_dataset(hull, FOLDER / "depths.nc", depth=20.0).shape.table
    assert table is not None
    excitation = table.excitation.copy()
    excitation[0, 0, 2, 3, 1] = math.nan
    path = tmp_path / "hull.hydrodynamics.npz"
    write_table(path, table._replace(excitation=excitation), hull)
    assert_refused("path", lambda: read_table(path, hull), "excitation is not finite")
    write_table(path, table, hull)
    assert read_table(path, hull).density == 1025.0


def fresh(d):
    """Forces by Capytaine in fresh water, in proportion to the density."""
    names = ("added_mass", "radiation_damping", "diffraction_force", "Froude_Krylov_force")
    return d.assign({name: d[name] / 1.025 for name in names} | {"rho": 1000.0})


SINGLE = 1e-6  # relative: the file has numbers of single precision


def test_a_dataset_of_fresh_water_is_that_of_salt_water(tmp_path, depths):
    """Coefficients over the density do not depend on it: only the draft is checked."""
    known = depths.sel(water_depth=20.0)
    salt = box("fore", (0.0, 0.0), FOLDER / "depths.nc", depth=20.0)
    body = box("fore", (0.0, 0.0), written(known, tmp_path, fresh))
    omega = [0.5, 1.0]
    given, other = linear_forces(body, omega), linear_forces(salt, omega)
    for name in ("mass", "stiffness", "added", "damping", "excitation"):
        found, wanted = getattr(given, name), getattr(other, name)
        assert np.abs(found - wanted).max() <= SINGLE * np.abs(wanted).max(), name
    assert heave_period(*body.loaded()) == pytest.approx(heave_period(*salt.loaded()), rel=SINGLE)
    assert roll_period(*body.loaded()) == pytest.approx(roll_period(*salt.loaded()), rel=SINGLE)
    assert moored(1, body, 1.0).mass == pytest.approx(moored(1, salt, 1.0).mass, rel=SINGLE, abs=1.0)
    assert make_fleet([body]).linear.added_bound == pytest.approx(make_fleet([salt]).linear.added_bound, rel=SINGLE)
    # In fresh water a body of the same draft has 2.5 % less of each.
    layers = ((1000.0, math.inf),)
    lighter = body._replace(mass=body.mass / 1.025, inertia=body.inertia / 1.025)
    found = linear_forces(lighter, omega, layers=layers)
    for name in ("added", "damping", "excitation"):
        wanted = getattr(other, name)
        assert np.abs(1.025 * getattr(found, name) - wanted).max() <= SINGLE * np.abs(wanted).max(), name


def test_a_sea_or_mooring_of_another_depth_or_heading_is_refused():
    body = box("fore", (0.0, 0.0), FOLDER / "depths.nc", depth=20.0).afloat()
    deep = Sea(32, 200.0, "regular", wave_height=0.5, wave_period=6.0, wind_speed=0.0)
    regular = SPECTRA["regular"]
    waves = draw_waves(regular, regular.conditions(wave_height=0.5, wave_period=6.0))
    for sea in (deep, RadialSea(waves)):
        assert_refused("bodies[0]", lambda sea=sea: float_in(sea, [body], duration=0.1, frames=2), "dataset's depth")
    conditions = regular.conditions(wave_height=0.5, wave_period=6.0, depth=50.0)
    other = draw_waves(regular, conditions)
    assert_refused("waves", lambda: moored(1, body, 1.0, other), "dataset's depth")
    shallow = Sea(32, 200.0, "regular", wave_height=0.5, wave_period=6.0, wind_speed=0.0, depth=20.0)
    assert np.isfinite(float_in(shallow, [body], duration=0.1, frames=2).x).all()
    one = box("fore", (0.0, 0.0), FOLDER / "depths.nc", depth=math.inf, heading=0.0).afloat()
    assert np.isfinite(float_in(RadialSea(waves), [one], duration=0.1, frames=2).x).all()
    for use in (
        lambda: float_in(shallow, [one], duration=0.1, frames=2),
        lambda: moored(1, one, 1.0, water=Water(20.0)),
    ):
        with pytest.warns(ApproximationWarning, match=r"water inf m deep, in water of 20 m; .* waves up to 40 m long"):
            use()
    across = draw_waves(regular, regular.conditions(wave_height=0.5, wave_period=6.0, wind_direction=1.0))
    assert_refused("bodies[0]", lambda: float_in(RadialSea(across), [one], duration=0.1, frames=2), "of that heading")
    assert moored(1, one, 1.0).mass[2][2] > one.loaded()[1] * one.hull.volume


HULL = Hull.box(20.0, 10.0, 4.0)


def with_nan(d, count: int = 6):
    return d.assign(added_mass=d["added_mass"].where(d["omega"] >= d["omega"].values[count]))


def test_frequencies_without_numbers_are_left_out_and_named(tmp_path, depths):
    """The lowest ones, as older programs fail there."""
    known = depths.sel(water_depth=20.0)
    with pytest.warns(UserWarning, match=r"left out, at omega 0.35, 0.5 rad/s"):
        body = box("fore", (0.0, 0.0), written(known, tmp_path, lambda d: with_nan(d, 2)))
    assert_is_capytaines(body, known.isel(omega=slice(2, None)), "", 0.0)
    without_end = lambda d: d.assign(added_mass=d["added_mass"].where(d["omega"] < math.inf))  # noqa: E731
    body = box("fore", (0.0, 0.0), written(known, tmp_path, without_end))
    assert_is_capytaines(body, known, "", 0.0)
    table = body.hull.shape.table
    assert table is not None
    assert (table.infinite == table.added_mass[:, :, -1]).all()


REFUSED = [
    ("depth", lambda d: d, {}, "20, inf m"),
    ("depth", lambda d: d, {"depth": 30.0}, "20, inf m"),
    ("path", lambda d: d.assign_coords(forward_speed=2.0), {"depth": 20.0}, "2 m/s"),
    ("path", lambda d: d.drop_vars(["rho"]), {"depth": 20.0}, "rho"),
    ("path", lambda d: d.isel(omega=[0, 1, 2]), {"depth": 20.0}, "four frequencies"),
    ("path", lambda d: d.isel(wave_direction=[0, 2]), {"depth": 20.0}, "`heading`"),
    ("heading", lambda d: d, {"depth": 20.0, "heading": 0.1}, "0, 0.2618"),
    ("body", lambda d: d, {"depth": 20.0, "body": "ship"}, "fore"),
    ("path", lambda d: d.isel(influenced_dof=[0, 2]), {"depth": 20.0}, "Surge, Heave"),
    ("path", with_nan, {"depth": 20.0}, "with numbers"),
    ("path", lambda d: d.isel(influenced_dof=0), {"depth": 20.0}, "influenced_dof"),
    ("draft", lambda d: d.assign(draught=5.0), {"depth": 20.0}, "height of the hull"),
    ("draft", lambda d: d.drop_vars("draught"), {"depth": 20.0}, "draught"),
    ("rho", lambda d: d.assign_coords(rho=0.0), {"depth": 20.0}, "above 0"),
    ("path", lambda d: d.assign_coords(rho=("omega", d["omega"].values)), {"depth": 20.0}, "one number rho"),
]


@pytest.mark.parametrize(("name", "change", "choice", "words"), REFUSED)
def test_what_does_not_fit_is_refused_with_the_way_out(tmp_path, depths, name, change, choice, words):
    path = written(depths, tmp_path, change)
    assert_refused(name, lambda: with_dataset(HULL, path, **choice), words)


def test_of_several_bodies_one_is_named():
    path = FOLDER / "bodies.nc"
    assert_refused("body", lambda: with_dataset(HULL, path), "fore, aft")
    assert_refused("body", lambda: with_dataset(HULL, path, body="mid"), "fore, aft")


def test_all_that_a_dataset_does_not_say_is_asked_for_at_once(bodies, tmp_path):
    lost = [name for name in ("draught", "rotation_center", "center_of_mass") if name in bodies.variables]
    path = written(bodies, tmp_path, lambda dataset: dataset.drop_vars(lost))
    with pytest.raises(ValueError, match="body: None") as error:
        with_dataset(HULL, path)
    assert [reason.partition(":")[0] for reason in str(error.value).split("; ") if " is not allowed" in reason] == [
        "body", "draft", "rotation_center",
    ]  # fmt: skip
    with pytest.raises(ValueError, match=r"^draft: None") as error:
        with_dataset(HULL, path, body="aft")
    assert "rotation_center: None" in str(error.value)
    assert with_dataset(HULL, path, body="aft", draft=2.0, rotation_center=(10.0, 5.0, 0.0)).shape.table is not None
