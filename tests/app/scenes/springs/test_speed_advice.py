"""What the panel proposes where a net of springs is slower than real time."""

import pytest

from app.scenes.springs.net_motion import SolverReport
from app.scenes.springs.speed_advice import accurate_steps, faster_steps, solver_words, step_warnings
from sim.springs import INTEGRATORS
from sim.springs.stability import Gauge


def gauge_of(name, h_omega):
    """The gauge of a step of h_omega / 1000 s."""
    limit = INTEGRATORS[name].limit(0.1)
    return Gauge(1000.0, 0.1, h_omega, limit, limit / 1000.0, h_omega / 1000.0, 1000.0)


@pytest.mark.parametrize(
    ("name", "h_omega", "text"),
    [
        ("leapfrog", 1.0, "fewer points"),
        ("leapfrog", 0.5, "fewer points or a larger step, up to 1/556 s (1.8 ms)"),
        ("rk4", 1.5, "fewer points or leapfrog instead of Runge-Kutta 4"),
        ("rk4", 2.0, "fewer points"),  # with which leapfrog would not hold
        ("implicit_euler", 1.0, "fewer points, a larger step or leapfrog instead of implicit Euler"),
        ("implicit_euler", 5.0, "fewer points or a larger step"),
    ],
)
def test_only_what_holds_and_helps_is_proposed(name, h_omega, text):
    assert faster_steps(INTEGRATORS[name], gauge_of(name, h_omega), "points") == text


def test_a_cloth_is_faster_without_contact_with_itself():
    found = faster_steps(INTEGRATORS["leapfrog"], gauge_of("leapfrog", 1.5), "rows and columns", touches_itself=True)
    assert found == "fewer rows and columns or no contact with itself"


def test_a_proposed_step_is_stable_in_contact_too():
    gauge = gauge_of("leapfrog", 0.5)
    found = [faster_steps(INTEGRATORS["leapfrog"], gauge._replace(landed_step=1.0 / n), "points") for n in (720, 1000)]
    assert found == ["fewer points or a larger step, up to 1/800 s (1.2 ms)", "fewer points"]


@pytest.mark.parametrize(
    ("report", "words"),
    [
        ((50, 0, 0, True), []),
        ((50, 7, 0, True), ["the solver had not settled in 7 of 50 steps: use a smaller time step"]),
        ((50, 1, 0, False), ["the solver had not settled in 1 kick"]),
        ((1, 0, 1, True), ["strands that touch were slowed down in 1 of 1 step, to keep them apart"]),
    ],
)
def test_what_was_wrong_in_the_steps_is_said(report, words):
    assert solver_words(SolverReport(*report), "strands") == words


def test_a_run_without_a_page_is_warned_of_a_step_that_is_stable_but_not_right():
    gauge = gauge_of("leapfrog", 1.0)._replace(accurate_step=5e-4, error=0.034, accurate_method="rk4")
    assert step_warnings(INTEGRATORS["leapfrog"], gauge) == [
        "The time step of 1/1000 s (1 ms) is stable with leapfrog but not right: oscillation and damping are "
        "3.4\u00a0% off. "
        "Right: Runge-Kutta 4 at this step or this method up to 1/2000 s (500 µs)."
    ]
    assert step_warnings(INTEGRATORS["leapfrog"], gauge._replace(error=0.005)) == []
    assert step_warnings(INTEGRATORS["leapfrog"], gauge._replace(step=1.0)) == []  # unstable: the run says so itself


def test_what_is_right_is_named_as_far_as_anything_is():
    gauge = gauge_of("leapfrog", 1.0)._replace(error=0.034)
    assert accurate_steps(gauge._replace(accurate_step=0.0)) == "No method is right at this step."
    assert (
        accurate_steps(gauge._replace(accurate_step=0.0, accurate_method="tr_bdf2")) == "Right: TR-BDF2 at this step."
    )
    assert accurate_steps(gauge._replace(accurate_step=0.05)) == "Right: this method up to 1/20 s (50 ms)."
    both = gauge._replace(accurate_step=0.05, accurate_method="tr_bdf2")
    assert accurate_steps(both) == "Right: TR-BDF2 at this step or this method up to 1/20 s (50 ms)."
    assert accurate_steps(both, briefly=True) == "Right: TR-BDF2 at this step."
