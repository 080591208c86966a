"""What is a browser's, and what is everybody's: docs/architecture.md has the table."""

from typing import Any

import numpy as np
import viser

from app.messages import LastFrame
from app.server.viewer import Viewer
from sim.validation import DivergenceError
from tests import coroutines
from tests.app.channels import text_of
from tests.app.server.visitors import Visitor, until, visitor

PLACE = (1.31, 3.21, 1.89)  # [m] to which a person turns the camera


def camera(browser: Visitor) -> viser.CameraHandle:
    return browser.lab.server.get_clients()[browser.client].camera


def place(browser: Visitor) -> list[float]:
    return [float(c) for c in camera(browser).position]


async def begun(lab: Viewer, number: int) -> None:
    """Another run than that of a number is shown, and its cameras are placed."""
    await until(
        lambda: lab.loop.run.identity.number > number and lab.served.cameras.run == lab.loop.run.identity.number
    )


def test_the_camera_is_a_browsers_and_a_preset_places_all(lab: Viewer) -> None:
    async def look() -> None:
        async with visitor(lab) as first, visitor(lab) as second:
            for browser in (first, second):
                camera(browser).position = PLACE
            buttons = lab.panel.head.buttons
            for act in ("Reset", "Reset", "Undo"):  # in every browser the camera stays where the person has put it
                number = lab.loop.run.identity.number
                await first.send(buttons, act)
                await begun(lab, number)
                assert np.allclose([place(first), place(second)], PLACE)
            await second.send(buttons, "Camera")
            await until(lambda: not np.allclose(place(second), PLACE))
            assert np.allclose(place(first), PLACE)
            camera(second).position = PLACE
            number = lab.loop.run.identity.number
            await first.send(lab.panel.head.preset, "Pendulum")
            await until(lambda: not np.allclose(place(first), PLACE) and not np.allclose(place(second), PLACE))
            await first.send(buttons, "Undo")
            await until(lambda: np.allclose([place(first), place(second)], PLACE))
            number = lab.loop.run.identity.number
            await first.send(buttons, "Reset")
            await begun(lab, number)
            assert np.allclose([place(first), place(second)], PLACE)

    coroutines.run(look())


def test_a_camera_that_was_moved_to_show_a_divergence_goes_back_unless_a_person_moves_it(lab: Viewer) -> None:
    scene: Any = lab.scene
    advance = scene.advance

    def diverge(steps: int) -> None:
        advance(steps)
        low, high = (-50.0, -50.0, -50.0), (50.0, 50.0, 50.0)
        raise DivergenceError("it diverged", (LastFrame(scene.time, scene.frame(), low, high),) * 3)

    async def look() -> None:
        async with visitor(lab) as first, visitor(lab) as second:
            for browser in (first, second):
                camera(browser).position = PLACE
            scene.advance = diverge
            await until(lambda: lab.loop.run.halted and lab.served.shown_serial == lab.loop.latest.serial)
            assert not np.allclose(place(first), PLACE)
            camera(second).position = (4.0, 4.0, 4.0)
            scene.advance = advance
            number = lab.loop.run.identity.number
            await first.send(lab.panel.head.buttons, "Reset")
            await begun(lab, number)
            await until(lambda: np.allclose(place(first), PLACE))
            assert np.allclose(place(second), 4.0)

    coroutines.run(look())


def test_parameters_and_the_run_are_everybodys_and_a_held_slider_is_a_browsers(lab: Viewer) -> None:
    async def look() -> None:
        async with visitor(lab) as first, visitor(lab) as second:
            await first.send(lab.panel.share.channel.field, text_of("held", True))
            await until(lambda: lab.settings.history.hands == {first.client})
            await second.send(lab.panel.controls["stiffness"].field, "1234")
            await until(lambda: vars(lab.settings.params)["stiffness"] == 1234.0)
            await first.send(lab.panel.head.buttons, "Pause")
            await until(lambda: not lab.loop.run.running)
            await second.send(lab.panel.head.buttons, "Play")
            await until(lambda: lab.loop.run.running)
        await until(lambda: not lab.settings.history.hands)  # it has left

    coroutines.run(look())
