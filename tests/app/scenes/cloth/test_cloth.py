"""The cloth scene without a browser: presets, handles, drags, and what it says when it diverges."""

import dataclasses
import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from app.messages import GrabTo, Place, Release
from app.panel.head import status_line
from app.render.colormap import scale_colours
from app.scenes import scene_named
from app.scenes.cloth import SCENE
from app.scenes.cloth.parameters import PRESETS, ClothParams, hidden
from app.scenes.cloth.scene import MAX_SPHERE_SPEED, ClothScene, gusty_wind
from app.scenes.cloth.view import ClothView, checks, faces
from app.scenes.quantities import measured, plotted_quantities, recorded_quantities
from app.scenes.springs.divergence import holding_step
from app.scenes.springs.quantities import STABILITY
from app.server.loop.sim_loop import SimLoop
from sim.parameters import check_record, effect_of_change
from sim.springs import INTEGRATORS
from sim.springs.stability import Gauge
from sim.validation import DivergenceError

SMALL = ClothParams(rows=10, cols=10, time_step=1 / 1200, wind=0.0)
Loop: Any = SimLoop  # of a scene whose types the tests know


def run(scene: ClothScene, seconds: float) -> None:
    for _ in range(round(seconds * 60)):
        scene.advance(max(1, round(1 / 60 / scene.step)))


def marks_of(scene: ClothScene) -> dict[str, str]:
    """The lines under the controls."""
    return ClothView.marks(object.__new__(ClothView), Loop(scene, paused=True).latest)


def change(scene: ClothScene, **changes: object) -> None:
    """Change parameters as the simulation loop does, by what they affect."""
    params = dataclasses.replace(scene.params, **changes)
    Loop(scene, paused=True).runs.take(params, effect_of_change(scene.params, params))


@pytest.mark.parametrize("preset", PRESETS)
def test_a_preset_runs_and_is_drawn(preset):
    scene = ClothScene(check_record(ClothParams, PRESETS[preset]))
    start = scene.frame().points
    run(scene, 0.4)
    frame = scene.frame()
    assert frame.points.dtype == np.float32
    assert np.isfinite(frame.points).all()
    assert np.abs(frame.points - start).max() > 0.02
    assert frame.points[..., 2].min() > -0.02
    gauge = scene.readings().stability
    assert gauge.h_omega < gauge.limit
    assert scene.params.integrator in ("leapfrog", "symplectic_euler")


@pytest.mark.parametrize(
    ("values", "means_nothing", "means_something"),
    [
        ({}, {"sphere_radius", "bob"}, set()),
        ({"sphere": True}, set(), {"sphere_radius", "bob", "friction", "contact_stiffness", "contact_damping"}),
        (
            {"sphere": False, "floor": True, "thickness": 0.0},
            set(),
            {"friction", "contact_stiffness", "contact_damping"},
        ),
        (
            {"sphere": False, "floor": False, "thickness": 0.0},
            {"friction", "contact_stiffness", "contact_damping"},
            set(),
        ),
        ({"sphere": False, "floor": False, "thickness": 0.01}, {"friction"}, {"contact_stiffness", "contact_damping"}),
        ({"wind": 0.0}, {"wind_direction", "gust"}, set()),
        ({"wind": 1.0, "air": 0.0}, {"wind_direction", "gust"}, set()),
        ({"wind": 1.0, "air": 1.0}, set(), {"wind_direction", "gust"}),
        ({"start": "level"}, {"gather"}, set()),
        ({"start": "hanging"}, set(), {"gather"}),
        ({"colour": "strain"}, set(), {"full_strain"}),
    ],
)
def test_a_control_is_hidden_where_it_means_nothing(values, means_nothing, means_something):
    found = hidden(check_record(ClothParams, values))
    assert means_nothing <= found
    assert not means_something & found


def test_a_dragged_particle_follows_and_is_released():
    scene = ClothScene(SMALL)
    run(scene, 0.5)
    index = 7 * 10 + 4
    before = scene.state.x[:, 7, 4].copy()
    target = (float(before[0]), float(before[1]) - 0.4, float(before[2]))
    scene.handle(GrabTo(index, target))
    run(scene, 0.7)
    largest = max(scene.params.pull, 2.0 * scene.net.masses.sum() * scene.params.gravity)
    stiffness = min(largest / 0.1, 0.1 * scene.net.mass / scene.step**2)
    stretch = np.linalg.norm(np.array(target) - scene.state.x[:, 7, 4])
    pull = scene.frame().grab
    assert pull is not None
    assert pull.load == pytest.approx(min(1.0, stretch * stiffness / largest), rel=1e-4)
    assert pull.limit == pytest.approx(largest)
    assert scene.state.x[1, 7, 4] < before[1] - 0.2
    scene.handle(Release())
    run(scene, 0.1)
    assert scene.frame().grab is None


@pytest.mark.parametrize(("pin", "end"), [("pin a", 0), ("pin b", 1)])
def test_a_moved_pin_moves_its_end_of_the_edge(pin, end):
    scene = ClothScene(SMALL)
    run(scene, 0.1)
    ends = scene.state.x[:, 0, [0, -1]].copy()
    x, y, z = ends[:, end]
    scene.handle(Place(pin, (float(x) + 0.3, float(y), float(z))))
    run(scene, 1.0)
    now = scene.state.x[:, 0, [0, -1]]
    assert now[:, 1 - end] == pytest.approx(ends[:, 1 - end], abs=1e-6)
    assert now[:, end] == pytest.approx(ends[:, end] + (0.3, 0.0, 0.0), abs=1e-4)
    middle = 0.5 * (scene.state.x[0, 0, 4] + scene.state.x[0, 0, 5])
    assert middle > 0.5 * (ends[0, 0] + ends[0, 1]) + 0.1
    scene.reset()
    assert scene.state.x[:, 0, [0, -1]] == pytest.approx(ends, abs=1e-9)


def test_the_farther_down_a_pin_is_the_less_it_moves():
    scene = ClothScene(dataclasses.replace(SMALL, pinned="rim", time_step=1e-3))
    before = scene.state.x.copy()
    x, y, z = before[:, 0, -1]
    scene.handle(Place("pin b", (float(x) + 0.3, float(y), float(z))))
    run(scene, 1.0)
    rows, cols = before.shape[1:]
    moved = (scene.state.x - before)[0]
    assert moved[:, -1] == pytest.approx(0.3 * (1.0 - np.arange(rows) / (rows - 1)), abs=1e-4)
    assert moved[0] == pytest.approx(0.3 * np.arange(cols) / (cols - 1), abs=1e-4)
    assert moved[-1] == pytest.approx(np.zeros(cols), abs=1e-9)


def test_no_sweep_records_the_gauge_of_the_time_step():
    assert not {name for name in recorded_quantities(SCENE) if name in STABILITY}
    assert all(not quantity.shown for quantity in plotted_quantities(SCENE).values())


@pytest.mark.parametrize(("rows", "cols"), [(64, 32), (32, 64), (8, 4)])
def test_a_fabric_has_eight_checks_along_its_longer_side(rows, cols):
    fabric = checks(rows, cols).reshape(rows, cols, 3)
    along = fabric[:, 0] if rows > cols else fabric[0]
    changes = np.abs(np.diff(along, axis=0)).max(axis=1) > 0.0
    assert changes.sum() == (2 * 8 if max(rows, cols) >= 16 else max(rows, cols)) - 1


def test_the_fullest_colour_is_that_of_the_strain_that_is_set():
    frame = ClothScene(dataclasses.replace(SMALL, colour="strain", full_strain=4.0)).frame()
    view = object.__new__(ClothView)
    for percent, place in ((0.0, 0.0), (1.0, 0.25), (4.0, 1.0), (7.0, 1.0)):
        strained = frame._replace(strain=np.full_like(frame.strain, 0.01 * percent))
        assert view.colours(strained)[0] == pytest.approx(scale_colours(np.array([place]), 0.0, 1.0)[0], abs=1e-6)


def test_the_sphere_pushes_the_cloth():
    scene = ClothScene(dataclasses.replace(SMALL, sphere=True, gather=1.0))
    run(scene, 0.2)
    scene.handle(Place("sphere", (0.0, 0.3, 1.2)))
    run(scene, 1.0)
    sphere = np.array(scene.frame().sphere)
    gap = np.linalg.norm(scene.state.x - sphere[:3, None, None], axis=0).min() - sphere[3]
    assert scene.state.x[1].max() > 0.3
    assert gap > 0.0


def test_a_sphere_that_is_pulled_through_the_curtain_takes_the_cloth_along():
    """Dragged far beyond the cloth: it moves at its largest speed, and no particle gets into the drawn sphere."""
    scene = ClothScene(dataclasses.replace(ClothParams(), sphere=True, wind=0.0))
    run(scene, 0.3)
    scene.handle(Place("sphere", (0.0, 50.0, 1.2)))
    sphere = before = np.array(scene.frame().sphere)
    fastest, least = 0.0, np.inf
    for _ in range(20):
        scene.advance(round(1 / 60 / scene.step))
        sphere = np.array(scene.frame().sphere)
        fastest = max(fastest, (sphere[1] - before[1]) * 60)
        before = sphere
        least = min(least, np.linalg.norm(scene.state.x - sphere[:3, None, None], axis=0).min() / sphere[3])
    assert 0.9 * MAX_SPHERE_SPEED < fastest <= MAX_SPHERE_SPEED
    assert least > 0.99
    # The part of the cloth that the sphere met lies in front of it.
    near = np.abs(scene.state.x[0]) + np.abs(scene.state.x[2] - 1.2) < 0.1
    assert near.any()
    assert (scene.state.x[1][near] > sphere[1]).all()


def test_friction_holds_the_tablecloth_until_a_hand_pulls_it_off_the_sphere() -> None:
    """Its middle does not creep; its edges still swing, and so move what lies by less than 0.2 mm."""
    scene = ClothScene(check_record(ClothParams, PRESETS["Tablecloth"]))
    sphere = scene.net.sphere
    assert sphere is not None
    run(scene, 4.0)
    before = scene.state.x.copy()
    run(scene, 2.0)
    lies = before[2] > sphere[2] + 0.8 * sphere[3]
    assert lies.sum() > 60
    assert np.linalg.norm(scene.state.x - before, axis=0)[lies].max() < 2e-4
    corner = scene.state.x[:, 0, 0].copy()
    for _ in range(150):
        corner += np.array([-0.7, -0.7, 0.2]) / 60
        scene.handle(GrabTo(0, (float(corner[0]), float(corner[1]), float(corner[2])), 1))
        run(scene, 1 / 60)
    scene.handle(Release(1))
    run(scene, 1.0)
    assert scene.state.x[2].max() < 0.2


def test_a_new_grid_keeps_the_shape():
    scene = ClothScene(SMALL)
    run(scene, 0.3)
    old = scene.state.x.copy()
    change(scene, rows=19, cols=28)
    assert scene.state.x[:, ::2, ::3] == pytest.approx(old, abs=1e-12)
    run(scene, 0.2)


def test_an_explosion_keeps_the_last_good_state_and_names_a_step_that_holds():
    scene = ClothScene(dataclasses.replace(SMALL, integrator="explicit_euler", time_step=0.01))
    with pytest.raises(DivergenceError, match=r"of the largest stable one for explicit Euler"):
        run(scene, 20.0)
    assert np.isfinite(scene.frame().points).all()


def test_where_the_chosen_method_takes_no_damping_another_runs_and_the_panel_says_so():
    scene = ClothScene(dataclasses.replace(SMALL, integrator="pefrl"))
    run(scene, 0.1)
    assert scene.motion.integrator == "leapfrog"
    assert "allows no damping" in scene.readings().note
    assert "allows no damping" in marks_of(scene)["integrator"]
    change(scene, damping=0.0, air=0.0, floor=False)
    run(scene, 0.1)
    assert scene.motion.integrator == "pefrl"
    assert scene.readings().note == marks_of(scene)["integrator"] == ""


def test_the_readings_give_the_cost_of_an_implicit_step():
    scene = ClothScene(dataclasses.replace(SMALL, integrator="implicit_euler", time_step=1 / 60, stiffness=1e5))
    run(scene, 0.5)
    assert (scene.tuner.threads, scene.tuner.step_time) == (1, {1: 0.0, 2: 0.0})  # too small for a trial of two
    assert 1.0 <= scene.readings().corrections <= 25.0
    assert scene.readings().stability.limit == np.inf


@pytest.mark.parametrize("name", [name for name, record in INTEGRATORS.items() if record.implicit])
def test_corrections_are_the_force_evaluations_of_the_solver(name):
    scene = ClothScene(dataclasses.replace(SMALL, integrator=name, time_step=1 / 120))
    before = scene.state.force_evals
    scene.advance(2)
    each = (scene.state.force_evals - before) / 2
    assert scene.readings().corrections == each - {"tr_bdf2": 1}.get(name, 0)
    change(scene, integrator="rk4", time_step=1 / 1200)
    scene.advance(2)
    assert scene.readings().corrections == 0.0


def test_a_cloth_that_falls_far_has_not_diverged():
    scene = ClothScene(dataclasses.replace(SMALL, pinned="free", floor=False, air=0.0, gravity=100.0, start="level"))
    run(scene, 1.5)
    height = scene.state.x[2]
    assert height.max() < -100.0
    assert np.ptp(height) < 0.5


def test_one_step_a_frame_is_taken_while_it_takes_longer_than_a_frame_and_dropped_time_is_shown():
    """By a clock that counts 0.3 s for each implicit step: never more than one step a frame, however many are due."""
    spent = 0.0

    class ExpensiveScene(ClothScene):
        def advance(self, steps: int) -> None:
            nonlocal spent
            super().advance(steps)
            spent += 0.3 * steps

    params = dataclasses.replace(SMALL, integrator="implicit_euler", time_step=1 / 240, stiffness=1e5)
    loop = Loop(ExpensiveScene(params), effort=lambda: spent)
    for _ in range(12):
        before = loop.run.counts["steps"]
        loop.tick(0.3)
        assert loop.run.counts["steps"] - before <= 1
    assert loop.latest.status.capped
    assert "slower than set" in status_line(loop.latest)
    assert "Faster: fewer rows and columns" in status_line(loop.latest)
    assert loop.run.fixed_step.dropped > 100
    assert "corrections a step" in ClothView.readout(object.__new__(ClothView), loop.latest)


def test_a_solver_that_has_not_settled_is_told_with_the_steps_and_a_smaller_step_helps():
    share = []
    for step in (1 / 60, 1 / 240):
        scene = ClothScene(ClothParams(integrator="implicit_euler", stiffness=1e5, time_step=step))
        scene.advance(round(1.0 / step))
        readings = scene.readings()
        unsettled, steps = readings.solver.unsettled, readings.solver.steps
        assert steps == round(1.0 / step)
        share.append(unsettled / steps)
        words = ClothView.readout(object.__new__(ClothView), Loop(scene, paused=True).latest)
        said = f"had not settled in {unsettled} of {steps} steps: use a smaller time step"
        assert (said in words) is (unsettled > 0)
    assert share[0] > 0.0 == share[1]


def test_the_mesh_has_two_triangles_a_cell_with_the_same_orientation():
    found = faces(4, 6)
    assert found.shape == (2 * 3 * 5, 3)
    i, j = np.divmod(np.arange(24), 6)
    points = np.stack([j, i, 0 * i], 1)
    a, b, c = (points[found[:, k]] for k in range(3))
    assert len(set(np.sign(np.cross(b - a, c - a)[:, 2]))) == 1


def test_plot_rows_and_arrays_have_the_columns_of_plots_and_files():
    scene = ClothScene(SMALL)
    run(scene, 0.3)
    rows = scene.take_plot_rows()
    assert len(rows) > 3
    assert all(len(row) == 1 + len(SCENE.series) for row in rows)
    np.testing.assert_allclose(rows[-1][1], sum(rows[-1][2:6]))
    assert scene.take_plot_rows() == ()
    assert scene.arrays()["x"][0].shape == (10, 10, 3)


LOOKS = ({"grid": False}, {"colour": "strain"}, {"speed": 0.5}, {"full_strain": 2.0}, {"plot_energy": True},
         {"plot_strain": True}, {"plot_energy": False}, {"speed": 1.0})  # fmt: skip


def test_a_change_of_look_leaves_the_energy_account_alone_bit_for_bit_and_costs_no_stability_check(monkeypatch):
    """Compared where both have taken the same number of steps, as another speed takes other steps in a frame."""
    params = dataclasses.replace(SMALL, wind=3.0, gust=0.0)
    alone, changed = ClothScene(params), ClothScene(params)
    loops = [Loop(scene, clock=lambda: 0.0, effort=lambda: 0.0) for scene in (alone, changed)]
    accounts: list[dict[int, tuple[float, ...]]] = [{}, {}]
    for frame in range(80):
        if frame % 9 == 5:
            with monkeypatch.context() as patch:
                patch.setattr("app.scenes.springs.net_motion.gauge", None)  # a call would fail
                loops[1].runs.take(dataclasses.replace(changed.params, **LOOKS[frame // 9 % len(LOOKS)]), "look")
        for loop, account in zip(loops, accounts, strict=True):
            loop.tick(1 / 60)
            scene, state = loop.scene, loop.scene.state
            account[state.steps] = (state.dissipated, state.work, scene.motion.energy_error())
    common = accounts[0].keys() & accounts[1].keys()
    assert changed.params.colour == "strain"
    assert len(common) > 30
    assert all(accounts[0][steps] == accounts[1][steps] for steps in common)
    assert alone.state.dissipated > 0.1


CHANGES = (
    {"stiffness": 1500.0}, {"gravity": 4.0}, {"density": 0.6}, {"pinned": "corners"}, {"rows": 12}, {"width": 1.2},
)  # fmt: skip


@pytest.mark.parametrize("changes", CHANGES, ids=lambda changes: next(iter(changes)))
def test_a_change_of_forces_is_booked_as_work_and_not_as_an_error(changes):
    scene = ClothScene(dataclasses.replace(SMALL, gather=1.0, air=0.0, integrator="rk4", time_step=1 / 4800))
    run(scene, 0.5)
    state, initial, before = scene.state, scene.motion.account.initial, scene.motion.energy_error()
    stored, dissipated = scene.motion.stored_energy(), state.dissipated
    change(scene, **changes)
    if "density" in changes or "gravity" in changes:
        assert abs(scene.motion.stored_energy() - stored) > 0.5
    assert (scene.motion.account.initial, state.dissipated) == (initial, dissipated)
    assert scene.motion.energy_error() == pytest.approx(before, abs=1e-9)
    run(scene, 0.5)
    assert abs(scene.motion.energy_error()) < 1e-3


def test_a_large_cloth_keeps_its_account_from_when_the_plot_is_opened():
    """The account would cost more than the steps themselves, and the drape would no longer run in real time."""
    scene = ClothScene(ClothParams(rows=60, cols=60, integrator="symplectic_euler", time_step=1 / 4800))
    scene.advance(20)
    assert scene.state.dissipated == 0.0
    scene.advance(200)
    assert np.isnan(scene.take_plot_rows()[-1][6])  # what was dissipated is not known
    change(scene, plot_losses=True)
    scene.advance(20)
    assert scene.state.dissipated > 0.0


@pytest.mark.parametrize("step", [1e-4, 1 / 60])
def test_a_pull_is_as_stiff_as_the_step_allows(step):
    scene = ClothScene(dataclasses.replace(SMALL, time_step=step, pull=30.0))
    for index in (74, 0):  # inside, and at a corner
        mass = scene.net.masses.flat[index]
        stiffness, damping, largest = scene.grab_spring(index)
        assert largest == 30.0
        assert stiffness == pytest.approx(min(30.0 / 0.1, 0.1 * mass / step**2))
        assert damping == pytest.approx(0.5 * math.sqrt(stiffness * mass))


def test_a_hand_pulls_at_least_twice_the_weight_and_an_implicit_method_follows_it_at_a_long_step() -> None:
    """A corner of a stiff curtain."""
    scene = ClothScene(
        ClothParams(rows=12, cols=12, stiffness=1e5, integrator="implicit_euler", time_step=1 / 60, wind=0.0, pull=0.1)
    )
    run(scene, 1.0)
    weight = scene.net.masses.sum() * 9.81
    index = 11 * 12
    before = scene.state.x.reshape(3, -1)[:, index].copy()
    target = before + (0.0, -0.3, 0.15)
    scene.handle(GrabTo(index, tuple(target.tolist())))
    run(scene, 1.5)
    stiffness, _, largest = scene.grab_spring(index)
    assert (stiffness, largest) == pytest.approx((2.0 * weight / 0.1, 2.0 * weight))
    assert np.linalg.norm(scene.state.x.reshape(3, -1)[:, index] - target) < 0.05


def test_plot_rows_are_measures_with_the_units_of_their_charts():
    table, row = plotted_quantities(SCENE), dict(zip(SCENE.series, range(1, 8), strict=True))
    found = {name: (q.value(row), q.unit, q.meaning) for name, q in table.items()}
    assert found["kinetic"] == (2, "J", "Energy: kinetic")
    assert found["gravity_energy"] == (4, "J", "Energy: gravity")  # not the parameter
    assert found["largest_strain"] == (7, "%", "largest strain")


def test_a_sweep_records_what_the_plots_of_the_cloth_show() -> None:
    scene = ClothScene(dataclasses.replace(SMALL, plot_losses=True))
    scene.advance(20)
    scene.take_plot_rows()
    scene.add_plot_row()
    row = dict(zip(SCENE.series, scene.take_plot_rows()[-1][1:], strict=True))
    plotted = {name: quantity.value(row) for name, quantity in plotted_quantities(SCENE).items()}
    found = measured(SCENE, scene)
    assert plotted["dissipated"] > 0.0
    # A plot has its kind of energy in its title; in the table of quantities a name says it itself.
    named = {name: f"{name}_energy" for name in ("total", "kinetic", "elastic", "contact", "dissipated")}
    named |= {"gravity_energy": "potential_energy", "largest_strain": "largest_strain"}
    assert {name: found[named[name]].value for name in plotted} == plotted


def test_gusts_blow_along_across_and_up_by_their_shares():
    params = dataclasses.replace(SMALL, wind=8.0, gust=0.5, wind_direction=90.0)
    across, along, up = np.array([gusty_wind(params, t) for t in np.linspace(0.0, 400.0, 40_001)]).T
    assert along.mean() == pytest.approx(8.0, rel=0.01)
    assert along.std() == pytest.approx(8.0 * 0.5 * math.sqrt((0.3**2 + 0.2**2) / 2.0), rel=0.01)
    assert np.abs(across).max() == pytest.approx(8.0 * 0.5 * 0.35, rel=1e-3)
    assert up.max() == pytest.approx(8.0 * 0.5 * 0.15, rel=1e-3)


@pytest.mark.parametrize("name", ["rope", "cloth"])
def test_the_remedy_of_a_scene_is_a_step_at_which_it_holds(name):
    gauge = Gauge(100.0, 0.0, 4.0, 2.0, 0.02, 0.04, 100.0)
    snapshot = SimpleNamespace(params=SimpleNamespace(time_step=0.04), readings=SimpleNamespace(stability=gauge))
    advice = scene_named(name).remedy(snapshot)
    assert advice == holding_step(0.04, gauge)
    assert (advice.name, 0.005 < advice.value <= 0.02) == ("time_step", True)
