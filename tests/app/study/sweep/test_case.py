"""One case: measured when asked, diverged to the step, failed without harm."""

import dataclasses
import math
from types import SimpleNamespace

import pytest

import app.scenes.rope.scene
import app.study.sweep.case
from app.scenes import NAMES, scene_named
from app.scenes.quantities import Measure, measured
from app.study.sweep.case import DIVERGED, FAILED, FINISHED, advance_to, run_case
from sim.floating import Hull, equilibrium_draft
from sim.parameters import parameters_of
from sim.springs import simulate
from sim.springs.statics import hanging_chain

SMALL: dict[str, dict[str, object]] = {  # scene -> what makes it cheap; a new scene needs no entry
    "rope": {"plot_energy": True, "plot_tip": True},
    "cloth": {"rows": 6, "cols": 6, "plot_energy": True, "plot_strain": True},
    "square_sea": {"size": "64", "mesh": "32"},
    "radial_sea": {"wave_count": 16, "particles": 100},
}


@pytest.mark.parametrize("name", NAMES)
def test_every_scene_gives_labelled_numbers_and_none_bears_the_name_of_a_parameter(name):
    outcome = run_case(name, SMALL.get(name, {}), (0.0, 0.1))
    assert (outcome.end, outcome.message) == (FINISHED, "")
    assert all(len(values) == 2 for values in outcome.measures.values())
    finite = [v for v in outcome.measures.values() if math.isfinite(v[-1])]
    assert len(finite) >= min(4, len(outcome.measures)) > 0
    assert outcome.measures.keys() == outcome.labels.keys()
    assert not outcome.measures.keys() & parameters_of(scene_named(name).params).keys()
    assert not outcome.measures.keys() & {"time", "case", "end", "message", "diverged_at", "run_time"}
    assert all(meaning for _, meaning in outcome.labels.values())


def test_a_case_takes_the_steps_to_its_time_and_no_more(monkeypatch):
    taken: list[int] = []

    def take(running: object, count: int) -> None:
        taken.append(count)
        assert sum(taken) <= 100

    monkeypatch.setattr(app.study.sweep.case, "advance", take)
    running = SimpleNamespace(time=0.5, step=0.01, take_plot_rows=lambda: [(float(len(taken)),)] * (len(taken) % 2))
    assert advance_to(running, 1.5) == (33.0,)
    assert (sum(taken), max(taken)) == (100, 3)
    assert advance_to(running, 0.5) == ()


def test_a_rope_that_has_come_to_rest_hangs_as_statics_say():
    values = {"time_step": 5e-3, "drag": 20.0, "damping": 50.0, "floor": False, "plot_energy": True}
    found = run_case("rope", values, (60.0,)).measures
    net = app.scenes.rope.scene.build(app.scenes.rope.scene.RopeParams(**values))
    assert found["tip_height"][0] == pytest.approx(hanging_chain(net).x[-1, 2], abs=1e-6)
    assert found["kinetic_energy"][0] < 1e-9


def test_the_rope_of_a_case_is_the_rope_of_the_library():
    found = run_case("rope", {"time_step": 1e-3, "floor": False}, (0.5, 1.0)).measures["tip_height"]
    net = app.scenes.rope.scene.build(app.scenes.rope.scene.RopeParams(floor=False))
    run = simulate(net, duration=1.0, frames=3, step=1e-3, integrator="leapfrog")
    assert found == pytest.approx(run.x[1:, -1, 2], abs=1e-12)


def test_a_divergence_is_dated_to_the_step_and_what_came_before_it_is_kept():
    values = {"integrator": "explicit_euler", "time_step": 0.02, "floor": False}
    outcome = run_case("rope", values, (0.0, 0.2, 100.0))
    assert outcome.end == DIVERGED
    assert "explicit Euler" in outcome.message
    tips = outcome.measures["tip_height"]
    assert math.isfinite(tips[1])
    assert math.isnan(tips[2])
    # It holds until then, and does not a step later.
    assert run_case("rope", values, (outcome.diverged_at,)).end == FINISHED
    assert run_case("rope", values, (outcome.diverged_at + 0.02,)).end == DIVERGED


def test_drafts_are_archimedes():
    values = {"waves": False, "spill": "layer", "thickness": 0.3, "bodies": 3, "density": 500.0, "size": 1.0}
    found = run_case("radial_sea", values, (2.0,)).measures
    from sim.ocean.fluids.fluids import fluids

    oil = fluids()["Alaska North Slope 2002"].density
    water = found["box_draft_at_rest"][0]
    draft = equilibrium_draft(Hull.box(1.2, 1.2, 0.7), 500.0, layers=[(oil, 0.3), (1025.0, math.inf)])
    assert water == pytest.approx(draft, abs=2e-3)
    assert found["box_mean_draft"][0] == pytest.approx(water, abs=1e-3)


def test_bodies_that_are_not_there_have_no_draft():
    found = run_case("radial_sea", {"bodies": 1, "waves": False}, (0.1,)).measures
    assert math.isfinite(found["red_buoy_draft"][0])
    assert math.isnan(found["box_draft"][0])


def test_a_mooring_in_calm_water_is_at_rest_and_one_with_too_long_a_step_diverges():
    values = {"wave_height": 0.0, "segments": 12, "lines": 2}
    found = run_case("mooring", values, (0.0, 2.0)).measures
    assert found["largest_tension"][1] == pytest.approx(found["largest_tension"][0], rel=1e-6)
    assert found["largest_offset"][1] == pytest.approx(0.0, abs=1e-6)
    assert found["slack_fraction"] == [0.0, 0.0]
    outcome = run_case("mooring", {**values, "time_step": 4.0 * found["critical_step"][0]}, (0.0, 20.0))
    assert outcome.end == DIVERGED
    assert outcome.measures["largest_tension"][0] == found["largest_tension"][0]
    assert math.isnan(outcome.measures["largest_tension"][1])


def test_what_a_scene_raises_is_the_outcome(monkeypatch):
    def burst(self, steps):
        raise MemoryError("no room for it")

    monkeypatch.setattr(app.scenes.rope.scene.RopeScene, "advance", burst)
    outcome = run_case("rope", {}, (0.0, 1.0))
    assert outcome.end == FAILED
    assert outcome.message == "MemoryError: no room for it"
    assert math.isfinite(outcome.measures["tip_height"][0])
    assert math.isnan(outcome.measures["tip_height"][1])


def test_a_scene_without_a_table_gives_its_plot_rows():
    kind = dataclasses.replace(scene_named("cloth"), quantities={})
    row = (0.5, *range(len(kind.series)))
    found = measured(kind, None, row)
    assert found["gravity_energy"] == Measure(3, "J", "Energy: gravity")
    assert found["largest_strain"].unit == "%"
    assert all(math.isnan(measure.value) for measure in measured(kind, None).values())


def test_an_integrator_that_would_be_replaced_is_a_failed_case(monkeypatch):
    @dataclasses.dataclass
    class Stub:
        params: object
        note: str = "pefrl allows no damping, so leapfrog runs instead"

    kind = dataclasses.replace(app.scenes.rope.SCENE, make=Stub)
    monkeypatch.setattr(app.scenes.rope, "SCENE", kind)
    outcome = run_case("rope", {}, (1.0,))
    assert (outcome.end, outcome.message) == (FAILED, Stub.note)


def test_a_case_looks_for_divergence_thirty_times_a_second(monkeypatch):
    counts = []

    def noted(running, count):
        counts.append(count)
        advance(running, count)

    advance = app.study.sweep.case.advance
    monkeypatch.setattr(app.study.sweep.case, "advance", noted)
    run_case("rope", {"time_step": 1e-3}, (0.5,))
    assert counts == [33] * 15 + [5]
