"""Bodies in motion: settling, periods, waves, drift, energy, the limit of stability."""

import math

import numpy as np
import pytest

from sim.floating import (
    Body,
    Hull,
    MotionCoefficients,
    equilibrium_draft,
    heave_period,
    lowest,
    make_fleet,
    make_water,
    pull,
    roll_period,
    step,
    still_water,
    submerged,
    vertices,
)
from sim.floating.linear.hydrodynamics import POLES
from sim.floating.linear.hydrodynamics import afloat as afloat_in
from sim.floating.motion.motion import frequency_bound
from sim.floating.motion.rotation import heading_angle, product, rotation_matrix
from sim.floating.statics.stability import UPRIGHT
from tests.naive_floating import axes_of_heading, lumpy, naive_step, quaternion

FRAME_INTERVAL = 1 / 60
WATER = [(1025.0, math.inf)]
SPILL = [(850.0, 0.2), (1025.0, math.inf)]
FREE = MotionCoefficients(quadratic_drag=0.0)  # radiation alone takes energy
UNDAMPED = FREE._replace(radiation=0.0)  # added mass is that of infinite frequency


def undamped_frequency(hull, density):
    """omega [rad/s] of heave with the added mass of infinite frequency, of a hull with straight sides."""
    mass = density * hull.volume + 1025 * afloat_in(hull, density).linear.infinite[2, 2]
    return math.sqrt(1025 * 9.81 * hull.size[0] * hull.size[1] / mass)


def afloat(hull, density, layers, above=0.0, **more):
    """A body upright at its equilibrium, or `above` it [m]."""
    lift = -hull.extents[2, 0] - equilibrium_draft(hull, density, layers) + above
    return Body(hull, density, (0.0, 0.0, lift), **more)


def period_of(times, values):
    """Mean time between upward crossings of zero, by linear interpolation."""
    up = np.flatnonzero((values[:-1] < 0) & (values[1:] >= 0))
    crossing = times[up] + (times[up + 1] - times[up]) * -values[up] / (values[up + 1] - values[up])
    return np.diff(crossing).mean()


@pytest.mark.parametrize(
    "layers",
    [
        pytest.param(WATER, marks=pytest.mark.stress),
        SPILL,
        pytest.param([(850.0, 3.0), (1025.0, math.inf)], marks=pytest.mark.stress),
    ],
)
def test_what_is_dropped_settles_at_its_draft(layers):
    """Stable upright hulls dropped from above, tilted a little, in one fluid, at the interface and in oil only."""
    raft, buoy, ball = Hull.box(1.0, 1.5, 0.4), Hull.cylinder(0.5, 0.4), Hull.sphere(0.5)
    mesh = Hull.from_arrays(Hull.sphere(0.5).vertices * [1.5, 1.2, 0.5], Hull.sphere(0.5).faces)
    bodies = [
        Body(hull, density, (10.0 * i, 0.0, 0.6), (1.0, 0.05, 0.08, 0.3))
        for i, (hull, density) in enumerate([(raft, 400.0), (buoy, 300.0), (ball, 420.0), (mesh, 600.0)])
    ]
    fleet = make_fleet(bodies)
    water = still_water(fleet, layers)
    for _ in range(120 * 60):
        step(fleet, water, FRAME_INTERVAL)
    expected = [equilibrium_draft(body.hull, body.density, layers) for body in bodies]
    assert -lowest(fleet) == pytest.approx(expected, abs=1e-4)
    assert np.abs(fleet.velocity[:, 2]).max() < 1e-6
    # Only drag stops a drift, dv/dt = -v^2/L along each axis: after t it is below L/t, with L = 4 (m + A)/(rho S), and
    # A that of slow motions.
    sway = np.array([np.diag(afloat_in(body.hull, body.density).linear.added_mass[0])[:2].max() for body in bodies])
    wet = np.array([afloat_in(body.hull, body.density, tuple(layers)).wet_area[:2].min() for body in bodies])
    length = 4 * (fleet.mass + layers[-1][0] * sway) / (layers[0][0] * wet)
    assert (np.hypot(*fleet.velocity[:, :2].T) < math.sqrt(2) * length / 120).all()


@pytest.mark.parametrize(
    ("hull", "density"), [(Hull.sphere(0.5), 512.5), (Hull.cylinder(0.5, 4.0), 512.5), (Hull.box(2.0, 2.0, 1.0), 410.0)]
)
def test_heave_period_is_that_of_theory(hull, density):
    period = heave_period(hull, density, WATER)
    fleet = make_fleet([afloat(hull, density, WATER, above=0.01)])
    rest = afloat(hull, density, WATER).position[2]
    water = still_water(fleet, WATER)
    z = []
    for _ in range(round(5 * period / FRAME_INTERVAL)):
        step(fleet, water, FRAME_INTERVAL, FREE)
        z.append(fleet.position[0, 2] - rest)
    measured = period_of(FRAME_INTERVAL * np.arange(len(z)), np.array(z))
    assert measured == pytest.approx(period, rel=0.015)  # damping alone makes it 0.4 % shorter or longer


@pytest.mark.parametrize("layers", [WATER, SPILL])
@pytest.mark.parametrize("axis", [0, 1])
def test_roll_period_is_that_of_the_metacentric_height(layers, axis):
    """Without added mass and radiation, where the formula is exact."""
    added = 0.0
    hull, density = Hull.box(3.0, 2.0, 0.6), 400.0
    tilt = [math.cos(0.01), 0.0, 0.0, 0.0]
    tilt[1 + axis] = math.sin(0.01)
    fleet = make_fleet([afloat(hull, density, layers, rotation=tuple(tilt))], layers)
    water = still_water(fleet, layers)
    coefficients = UNDAMPED._replace(added_mass=added)
    expected = roll_period(hull, density, layers, added=added, axis=axis)
    angle = []
    for _ in range(round(6 * expected / FRAME_INTERVAL)):
        step(fleet, water, FRAME_INTERVAL, coefficients)
        angle.append(2 * fleet.rotation[0, 1 + axis])
    assert period_of(FRAME_INTERVAL * np.arange(len(angle)), np.array(angle)) == pytest.approx(expected, rel=0.01)


def test_heave_between_two_fluids_has_the_period_of_both_waterplanes():
    hull = Hull.cylinder(1.0, 0.8)
    fleet = make_fleet([afloat(hull, 500.0, SPILL, above=0.01)])
    rest = afloat(hull, 500.0, SPILL).position[2]
    water = still_water(fleet, SPILL)
    z = []
    for _ in range(600):
        step(fleet, water, FRAME_INTERVAL, FREE)
        z.append(fleet.position[0, 2] - rest)
    expected = heave_period(hull, 500.0, SPILL)
    assert period_of(FRAME_INTERVAL * np.arange(600), np.array(z)) == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("with_acceleration", [True, pytest.param(False, marks=pytest.mark.stress)])
def test_a_small_hull_follows_a_long_wave(with_acceleration):
    """Airy wave of 100 m and 0.5 m: heave and surge of the hull are those of the water, within 2 %.

    Without the surface's acceleration the hull still follows, within (omega/omega_heave)^2.
    """
    k, amplitude = 2 * math.pi / 100, 0.5
    omega = math.sqrt(9.81 * k)
    hulls = [Hull.box(1.0, 1.0, 0.4), Hull.sphere(0.5), Hull.cylinder(0.5, 0.4)]
    fleet = make_fleet([afloat(hull, 500.0, WATER)._replace(position=(20.0 * i, 0, 0)) for i, hull in enumerate(hulls)])
    rest = np.array([afloat(hull, 500.0, WATER).position[2] for hull in hulls])
    heave, wave, surge, orbit = [], [], [], []
    for frame in range(60 * 90):
        phase = k * fleet.position[:, 0] - omega * frame * FRAME_INTERVAL
        eta = amplitude * np.cos(phase)
        zero = np.zeros(3)
        water = make_water(
            fleet,
            WATER,
            eta,
            slope=np.stack([-k * amplitude * np.sin(phase), zero], axis=1),
            velocity=np.stack([omega * eta, zero, omega * amplitude * np.sin(phase)], axis=1),
            acceleration=-(omega**2) * eta if with_acceleration else None,
        )
        step(fleet, water, FRAME_INTERVAL)
        if frame > 60 * 30:
            phase = k * fleet.position[:, 0] - omega * (frame + 1) * FRAME_INTERVAL
            heave.append(fleet.position[:, 2] - rest)
            wave.append(amplitude * np.cos(phase))
            surge.append(fleet.velocity[:, 0].copy())
            orbit.append(omega * amplitude * np.cos(phase))
    response = np.std(heave, axis=0) / np.std(wave, axis=0)
    lost = [(omega * heave_period(hull, 500.0, WATER) / 2 / math.pi) ** 2 for hull in hulls]
    bound = 0.02 if with_acceleration else 0.02 + max(lost)
    assert response == pytest.approx(np.ones(3), abs=bound)
    if with_acceleration:
        assert np.std(np.subtract(heave, wave), axis=0) / np.std(wave, axis=0) == pytest.approx(np.zeros(3), abs=0.02)
    assert np.std(surge, axis=0) / np.std(orbit, axis=0) == pytest.approx(np.ones(3), abs=bound)


@pytest.mark.parametrize("minutes", [5, pytest.param(60, marks=pytest.mark.stress)])
def test_still_water_moves_nothing(minutes):
    """Hulls at rest where they float."""
    hulls = [Hull.box(1.0, 1.5, 0.4), Hull.cylinder(0.5, 0.4), Hull.sphere(0.5)]
    fleet = make_fleet([
        afloat(hull, 400.0, SPILL)._replace(position=(5.0 * i, 0.0, afloat(hull, 400.0, SPILL).position[2]))
        for i, hull in enumerate(hulls)
    ])  # fmt: skip
    water = still_water(fleet, SPILL)
    for _ in range(600 * minutes):
        step(fleet, water, 0.1)
    assert fleet.position[:, 0] == pytest.approx([0, 5, 10], abs=1e-6)
    assert fleet.position[:, 1] == pytest.approx(np.zeros(3), abs=1e-6)
    assert np.abs(fleet.velocity).max() < 1e-7  # the sphere of triangles still rolls towards its lowest face
    assert fleet.rotation[:2, 0] == pytest.approx(np.ones(2), abs=1e-9)


def energy_of(fleet, bodies, i):
    """Kinetic energy of body i and the fluid that it carries, its weight's and the still sea water's potential [J]."""
    turn = rotation_matrix(fleet.rotation[i])
    heading = axes_of_heading(turn)
    velocity, spin = heading.T @ fleet.velocity[i], fleet.spin[i]
    carried = fleet.linear.added_factor[fleet.linear_hull[i]].T @ np.append(velocity, heading.T @ spin)
    solid = fleet.density[i] * turn @ bodies[i].hull.inertia @ turn.T
    total = fleet.mass[i] * (velocity @ velocity / 2 + 9.81 * fleet.position[i, 2]) + spin @ solid @ spin / 2
    wet = submerged(bodies[i].hull, fleet.position[i], fleet.rotation[i], 0.0)
    depth = -wet.centre[2] if wet.volume > 0 else 0.0
    return total + (np.maximum(fleet.carried[i], 0.0) * carried**2).sum() / 2 + 1025 * 9.81 * wet.volume * depth


def least_energy(bodies):
    """`energy_of` of each body at rest (n,) [J]."""
    rest = make_fleet([afloat(body.hull, body.density, WATER) for body in bodies])
    step(rest, still_water(rest), 1e-6, UNDAMPED)
    return np.array([energy_of(rest, bodies, i) for i in range(len(bodies))])


@pytest.mark.parametrize("seconds", [10, pytest.param(60, marks=pytest.mark.stress)])
def test_no_entry_and_no_exit_gives_energy(seconds):
    """Rolling hulls dropped again and again into still water, without drag and waves: their energy only falls."""
    rng = np.random.default_rng(1)
    bodies = []
    for i, hull in enumerate(
        [Hull.box(1.5, 1.0, 0.4), Hull.box(1.0, 1.0, 1.0), Hull.cylinder(0.5, 0.5), Hull.box(1.0, 2.5, 0.5)]
    ):
        tilt, place, speed = rng.uniform(-0.3, 0.3), (20.0 * i, 0.0, rng.uniform(1, 3)), (0.0, rng.uniform(-1, 1), 0.0)
        rotation = (math.cos(tilt), math.sin(tilt), 0.0, 0.0)
        bodies.append(Body(hull, rng.uniform(60, 300), place, rotation, speed, (rng.uniform(-2, 2), 0.0, 0.0)))
    fleet = make_fleet(bodies)
    least = least_energy(bodies)
    water, energy, carried = still_water(fleet), [], []
    for _ in range(60 * seconds):
        step(fleet, water, 1 / 60, UNDAMPED, substeps=8)
        energy.append([energy_of(fleet, bodies, i) for i in range(4)])
        carried.append(fleet.carried.sum(axis=1))
    above = np.array(energy) - least
    grows = np.diff(carried, axis=0) > 0
    assert (grows[1:] & ~grows[:-1]).sum() >= 80
    assert (above - np.minimum.accumulate(above)).max(axis=0) == pytest.approx(np.zeros(4), abs=1e-4 * above[0].min())


def test_energy_of_undamped_heave_stays_bounded():
    """A thousand periods of a box: the energy (m + A) v^2/2 + C z^2/2 stays within omega h of its start."""
    hull, density = Hull.box(2.0, 2.0, 0.6), 500.0
    fleet = make_fleet([afloat(hull, density, WATER, above=0.05)])
    rest = afloat(hull, density, WATER).position[2]
    water = still_water(fleet, WATER)
    omega = undamped_frequency(hull, density)
    energy = []
    for _ in range(round(1000 * 2 * math.pi / omega / 0.05)):
        step(fleet, water, 0.05, UNDAMPED, substeps=1)
        energy.append(fleet.velocity[0, 2] ** 2 / 2 + omega**2 * (fleet.position[0, 2] - rest) ** 2 / 2)
    assert np.ptp(energy) < 1.1 * omega * 0.05 * energy[0]
    assert np.mean(energy[-1000:]) == pytest.approx(np.mean(energy[:1000]), rel=0.01)


@pytest.mark.parametrize("minutes", [2, pytest.param(10, marks=pytest.mark.stress)])
def test_undamped_rocking_stays_bounded(minutes):
    """Tilted, spinning and bobbing at once for minutes without drag: no more energy than lifts a body by 2 mm appears.

    Some does and goes again, as free rotation keeps the momentum of the solid alone.
    """
    hulls = [Hull.box(1.0, 1.5, 0.4), Hull.cylinder(0.5, 1.0), Hull.sphere(0.5)]
    bodies = [
        Body(hull, 400.0, (9.0 * i, 0, 0.2), (1.0, 0.2, 0.1, 0.0), spin=(0.3, 0.2, 0.5)) for i, hull in enumerate(hulls)
    ]
    fleet, energy = make_fleet(bodies), []
    water = still_water(fleet, WATER)
    for frame in range(minutes * 3600):
        step(fleet, water, FRAME_INTERVAL, UNDAMPED)
        if frame % 20 == 0:
            energy.append([energy_of(fleet, bodies, i) for i in range(3)])
    assert (np.max(energy, axis=0) - energy[0] < 2e-3 * 9.81 * fleet.mass).all()


def test_the_step_is_stable_below_omega_h_of_two_and_not_above():
    hull, density = Hull.box(2.0, 2.0, 0.6), 500.0
    omega = undamped_frequency(hull, density)
    for ratio, stable in ((1.95, True), (2.05, False)):
        fleet = make_fleet([afloat(hull, density, WATER, above=1e-6)])
        rest = afloat(hull, density, WATER).position[2]
        water = still_water(fleet, WATER)
        reach = 0.0
        for _ in range(100):
            step(fleet, water, ratio / omega, UNDAMPED, substeps=1)
            fleet.spin[:], fleet.rotation[:] = 0.0, (1.0, 0.0, 0.0, 0.0)  # roll is faster, and grows from round-off
            reach = max(reach, abs(fleet.position[0, 2] - rest))
        assert (reach < 1e-4) == stable


@pytest.mark.parametrize("density", [10.0, *(pytest.param(d, marks=pytest.mark.stress) for d in (100.0, 1e3)), 2e4])
@pytest.mark.parametrize("size", [0.1, pytest.param(1.0, marks=pytest.mark.stress), 10.0])
@pytest.mark.parametrize("gravity", [0.1, pytest.param(9.81, marks=pytest.mark.stress), 981.0])
def test_the_bound_of_frequency_holds_over_all_parameters(density, size, gravity):
    """The frequency of heave and of roll of every hull at every pose it may float in lies below `frequency_bound`."""
    coefficients = MotionCoefficients(gravity=gravity)
    hulls = [Hull.box(size, size, size), Hull.box(size, size, size / 10), Hull.sphere(size / 2)]
    hulls += [Hull.cylinder(size / 2, size), Hull.cylinder(size / 2, size / 10)]
    fleet = make_fleet([Body(hull, density) for hull in hulls])
    bound = frequency_bound(fleet, 1025.0, coefficients)
    for hull, limit in zip(hulls, bound, strict=True):
        for shortest in (heave_period(hull, density, WATER, gravity), roll_period(hull, density, WATER, gravity)):
            assert 2 * math.pi / shortest <= limit


@pytest.mark.parametrize("seed", range(8))
def test_two_steps_match_the_naive_ones(seed):
    """Two tilted fluids, flow and rise, all forces but the pull; random hull, pose and speeds."""
    rng = np.random.default_rng(seed)
    hull = [
        Hull.box(*rng.uniform(0.3, 2.0, 3)),
        Hull.cylinder(0.4, 1.1),
        Hull.from_arrays(lumpy(rng, Hull.sphere(0.5, 2).vertices) * [1, 0.8, 0.6], Hull.sphere(0.5, 2).faces),
        Hull.sphere(0.5, 2),
    ][seed % 4]
    position, rotation = np.append(rng.uniform(-2, 2, 2), rng.uniform(-0.2, 0.2)), quaternion(rng)
    velocity, spin, flow, lift = rng.normal(size=3), rng.normal(size=3), rng.normal(size=3), rng.normal()
    slopes = rng.normal(0, 0.1, (2, 2))
    given = rng.normal(size=6) if seed % 2 else None
    lines = 100.0 * rng.normal(size=6)
    coefficients = MotionCoefficients(9.0, 0.4, 0.9, 0.8, 0.7)
    body = Body(hull, 600.0, tuple(position), tuple(rotation), tuple(velocity), tuple(spin))
    fleet = make_fleet([body])
    fleet.mooring[0] = lines
    water = make_water(
        fleet,
        [(850.0, 0.3), (1025.0, math.inf)],
        np.array([position[:2] @ slopes[0] + 0.2]),
        slope=slopes[:1],
        velocity=flow[None],
        acceleration=np.array([lift]),
        interface=np.array([position[:2] @ slopes[1] - 5.0 * (seed == 7) - 0.15]),
        interface_slope=slopes[1:],
        excitation=None if given is None else given[None],
    )
    planes = (850.0, 0.2, slopes[0]), (1025.0, -5.0 * (seed == 7) - 0.15, slopes[1])
    step(fleet, water, 0.02, coefficients, substeps=2)
    state = (position, rotation, velocity, spin, None, np.zeros((len(POLES), 6), complex))
    for middle in (0.005, 0.015):
        rise = middle * np.array([flow[2] - flow[:2] @ slopes[0], 0.0])
        risen = [(rho, height + up, slope) for (rho, height, slope), up in zip(planes, rise, strict=True)]
        state = naive_step(hull, 600.0, state, *risen, flow, lift, coefficients, 0.01, given, lines)
    for value, wanted in zip((*fleet[:5], fleet.memory), state, strict=True):
        assert value[0] == pytest.approx(wanted, abs=1e-7)


def test_relief_of_a_plane_is_the_plane():
    hulls = [Hull.box(1.0, 1.5, 0.4), Hull.sphere(0.5, 3)]
    coefficients = MotionCoefficients(added_mass=0.0)
    fleets = [make_fleet([Body(h, 500.0, (3.0 * i, 0, 0)) for i, h in enumerate(hulls)]) for _ in range(2)]
    place = vertices(fleets[0])
    slope = np.array([[0.1, -0.05], [0.02, 0.2]])
    centre = np.repeat(fleets[0].position[:, :2], [len(h.vertices) for h in hulls], axis=0)
    tilt = np.repeat(slope, [len(h.vertices) for h in hulls], axis=0)
    relief = ((place[:, :2] - centre) * tilt).sum(axis=1)
    step(fleets[0], make_water(fleets[0], SPILL, np.zeros(2), slope=slope), FRAME_INTERVAL, coefficients, substeps=1)
    bumpy = make_water(fleets[1], SPILL, np.zeros(2), relief=relief, interface_relief=relief)
    step(fleets[1], bumpy, FRAME_INTERVAL, coefficients, substeps=1)
    assert fleets[0].velocity == pytest.approx(fleets[1].velocity, abs=1e-12)
    assert fleets[0].spin == pytest.approx(fleets[1].spin, abs=1e-12)


def test_free_spin_keeps_its_angular_momentum():
    """A box thrown in the air about its middle axis tumbles, its angular momentum stays."""
    hull = Hull.box(0.3, 1.0, 2.0)
    fleet = make_fleet([Body(hull, 500.0, (0, 0, 1e6), spin=(0.01, 5.0, 0.02))])
    water = still_water(fleet, WATER)

    def momentum():
        turn = rotation_matrix(fleet.rotation[0])
        return turn @ hull.inertia @ turn.T @ fleet.spin[0]

    before = momentum()
    seen = []
    for _ in range(1200):
        step(fleet, water, FRAME_INTERVAL)
        seen.append(fleet.rotation[0].copy())
    assert momentum() == pytest.approx(before, rel=1e-10)
    assert np.ptp(np.array(seen)[:, 1]) > 0.5  # it did tumble


def test_buoyancy_at_rest_is_the_weight():
    fleet = make_fleet([afloat(Hull.box(1.0, 1.0, 0.3), 500.0, SPILL)])
    step(fleet, still_water(fleet, SPILL), FRAME_INTERVAL)
    assert fleet.buoyancy[0] == pytest.approx(fleet.mass[0] * 9.81, rel=1e-9)


def effective_mass(hull, density, rotation, force=1e3):
    """Force over acceleration [kg] of a body in a pose, pushed along the world's x axis from rest under water."""
    fleet = make_fleet([Body(hull, density, (0.0, 0.0, -hull.size[2] / 2.0), rotation)], WATER)
    fleet.mooring[0, 0] = force
    step(fleet, still_water(fleet, WATER), 1e-6, UNDAMPED)
    return force * 1e-6 / fleet.velocity[0, 0]


@pytest.mark.parametrize("yaw", [0, 45, 90, 200])
@pytest.mark.parametrize("lean", [0, 1])
def test_a_capsized_hull_keeps_its_heading(yaw, lean):
    """Upside down it has the added mass along the world's x axis that it has upright, also with a degree of lean."""
    hull, angle = Hull.box(5.0, 1.0, 0.6), math.radians(yaw) / 2.0
    turn = (math.cos(angle), 0.0, 0.0, math.sin(angle))
    over, pitch = (0.0, 1.0, 0.0, 0.0), (math.cos(math.radians(lean) / 2), 0.0, math.sin(math.radians(lean) / 2), 0.0)
    upright, capsized = (effective_mass(hull, 500.0, product(turn, product(pitch, one))) for one in (UPRIGHT, over))
    assert capsized == pytest.approx(upright, rel=0.01)


@pytest.mark.parametrize(("yaw", "known"), [(0, 1606.0), (90, 1912.0)])
def test_a_hull_is_heavier_to_push_aside(yaw, known):
    hull, angle = Hull.box(5.0, 1.0, 0.6), math.radians(yaw) / 2.0
    for over in (UPRIGHT, (0.0, 1.0, 0.0, 0.0)):
        rotation = product((math.cos(angle), 0.0, 0.0, math.sin(angle)), over)
        assert effective_mass(hull, 512.5, rotation) == pytest.approx(known, rel=0.002)


def test_the_heading_of_a_hull_that_stands_on_its_stern_is_that_of_its_side():
    """A turn about the vertical is a turn of the heading, whichever way the body leans: also with x straight up."""
    rng = np.random.default_rng(3)
    for lean in [(math.sqrt(0.5), 0.0, -math.sqrt(0.5), 0.0), *rng.normal(size=(50, 4))]:
        lean = tuple(np.array(lean) / np.linalg.norm(lean))
        turn = rng.uniform(-3.0, 3.0)
        turned = product((math.cos(turn / 2), 0.0, 0.0, math.sin(turn / 2)), lean)
        change = heading_angle(turned) - heading_angle(lean)
        assert math.remainder(change - turn, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-9)


def test_a_pull_above_its_limit_is_the_damped_impulse_of_that_size():
    """(K + m) P = w with |P| = limit h, K the mobility of the point: here of a body without a fluid, far from its
    target."""
    hull, limit, h, rate = Hull.box(2.0, 1.0, 0.6), 800.0, 1 / 60, 12.0
    point, target, place = np.array([0.9, 0.3, 0.25]), np.array([3.0, -4.0, 9.0]), (0.0, 0.0, 5.0)
    layers, after = ((1e-6, math.inf),), []
    for most in (0.0, limit):
        fleet = make_fleet([Body(hull, 500.0, place)], layers)
        fleet.velocity[0], fleet.spin[0] = (0.3, -0.2, 0.1), (0.1, 0.2, -0.3)
        pull(fleet, 0, point, target, most)
        step(fleet, still_water(fleet, layers), h, MotionCoefficients(quadratic_drag=0.0, gravity=1e-3, pull_rate=rate))
        after.append((fleet.velocity[0].copy(), fleet.spin[0].copy()))
    (velocity, spin), (pulled, _) = after
    mass, inertia = 500.0 * hull.volume, 500.0 * hull.inertia
    impulse = mass * (pulled - velocity)
    assert np.linalg.norm(impulse) == pytest.approx(limit * h, rel=1e-9)
    turned = [np.cross(np.linalg.solve(inertia, np.cross(point, axis)), point) for axis in np.eye(3)]
    mobility = np.eye(3) / mass + np.array(turned).T
    s = h * rate * (2.0 + h * rate)
    there = velocity + np.cross(spin, point) + rate / (2.0 + h * rate) * (place + point - target)
    rest = -s / (1.0 + s) * there - mobility @ impulse
    assert rest / np.linalg.norm(rest) == pytest.approx(impulse / np.linalg.norm(impulse), abs=2e-3)
