"""The fraction of the largest stable step that the panel shows: the worst of the last seconds, in plain words."""

import html
import re
from dataclasses import replace

import pytest

from app.scenes.rope.parameters import RopeParams
from app.scenes.rope.scene import RopeScene as Rope
from app.scenes.springs.drawing.html import stability_bar
from app.scenes.springs.recent_gauges import SPAN
from sim.springs.stability import critical_step
from sim.validation import DivergenceError


def text_of(scene: Rope) -> str:
    """The first line, as it is read."""
    line = re.search(r'springtide-step-share">(.*?)</span>', stability_bar(scene.readings().stability))
    assert line is not None
    return html.unescape(re.sub("<[^>]*>", "", line[1])).replace("\xa0", " ")


def test_the_line_has_one_number_and_no_symbol() -> None:
    scene = Rope(RopeParams(time_step=1 / 120))
    share = 100.0 / 120.0 / critical_step(scene.net, "leapfrog")
    assert text_of(scene) == f"Step: {float(f'{share:.2g}'):g} % of the largest stable"
    assert "hω" in stability_bar(scene.readings().stability)  # behind the (i)


def test_the_worst_of_the_last_seconds_is_shown_until_they_are_over() -> None:
    """A rope that falls from level is stretched most as it passes below; the share at each moment wanders."""
    scene = Rope(RopeParams(damping=0.5, drag=0.0))
    now = [(0.0, scene.readings().stability.share)]
    take = scene.recent.worst

    def noted(t, readings):
        now.append((t, readings.stability.share))
        return take(t, readings)

    scene.recent.worst = noted  # type: ignore[method-assign]
    while scene.time < 3 * SPAN:
        scene.advance(6)
        assert scene.readings().stability.share == max(share for t, share in now if t >= now[-1][0] - SPAN)
    shares = [share for _, share in now]
    assert max(shares) > 1.05 * min(shares)  # what the line would show otherwise


def test_another_step_another_run_and_another_moment_forget_the_last_seconds() -> None:
    scene = Rope(RopeParams(damping=0.5, drag=0.0))
    first = scene.readings().stability.share
    scene.advance(240)
    kept = scene.keep()
    assert len(scene.recent.readings) > 1
    scene.change_forces(replace(scene.params, time_step=1 / 240))
    assert len(scene.recent.readings) == 1
    scene.params = replace(scene.params, time_step=1 / 60)
    scene.resume(kept)
    assert len(scene.recent.readings) == 1
    scene.reset()
    assert len(scene.recent.readings) == 1
    assert scene.readings().stability.share == pytest.approx(first, rel=1e-12)


def test_a_divergence_says_the_number_of_the_line() -> None:
    scene = Rope(RopeParams(integrator="explicit_euler"))
    with pytest.raises(DivergenceError) as error:
        scene.advance(600)
    said = re.search(r"was (\S+ %) of the largest stable", str(error.value).replace("\xa0", " "))
    assert said is not None
    assert text_of(scene).startswith(f"Step: {said[1]} of the largest stable")


def test_the_least_accurate_of_the_last_seconds_counts_with_the_worst_share() -> None:
    recent = Rope(RopeParams()).recent
    recent.clear()
    first = Rope(RopeParams(integrator="implicit_euler")).readings()
    gauge = first.stability._replace(error=0.02, accurate_step=0.008, accurate_method="rk4")
    recent.worst(0.0, first._replace(stability=gauge))
    later = recent.worst(1.0, first._replace(stability=gauge._replace(error=0.015, accurate_step=0.011)))
    assert (later.stability.error, later.stability.accurate_step, later.stability.accurate_method) == (
        0.02,
        0.008,
        "rk4",
    )
    over = recent.worst(2.0 + SPAN, first._replace(stability=gauge._replace(error=0.001)))
    assert over.stability.error == 0.001
