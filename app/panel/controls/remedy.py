"""Buttons that follow an advice: a value of a parameter, and a restart."""

from collections.abc import Callable, Mapping

import viser

from app.panel.controls.control import Control
from app.render.handles.viser_types import ViserEvent
from app.scenes.contract import Advice


class Remedy:
    """The button, made in the open container; hidden without an advice."""

    def __init__(
        self, gui: viser.GuiApi, label: str, follow: Callable[[Advice], None], order: float | None = None
    ) -> None:
        """label: with the value in place of {}. follow: sets the parameter and starts again."""
        self.label, self.follow = label, follow
        self.advice: Advice | None = None
        self.button = gui.add_button("", visible=False, order=order)
        self.button.on_click(self.on_click)

    async def on_click(self, event: ViserEvent) -> None:
        """Follow the advice for a browser."""
        if event.client_id is not None and self.advice is not None:
            self.follow(self.advice)

    def show(self, advice: Advice | None) -> None:
        """Offer an advice, or none."""
        if advice == self.advice:
            return
        self.advice = advice
        if advice is not None:
            self.button.label = self.label.format(advice.words)
        self.button.visible = advice is not None


class ControlRemedies:
    """The buttons under the controls of parameters, each made when a value of its parameter is first advised."""

    def __init__(self, gui: viser.GuiApi, controls: Mapping[str, Control], follow: Callable[[Advice], None]) -> None:
        """controls: by name. follow: sets a parameter and starts again."""
        self.gui, self.controls, self.follow = gui, controls, follow
        self.made: dict[str, Remedy] = {}  # by parameter

    def show(self, advice: Advice | None) -> None:
        """Offer an advice under the control of its parameter, or none."""
        if advice is not None and advice.name not in self.made:
            control = self.controls[advice.name]
            with control.folder:
                self.made[advice.name] = Remedy(self.gui, "Use {}", self.follow, control.order + 0.7)
        for name, remedy in self.made.items():
            remedy.show(advice if advice is not None and advice.name == name else None)
