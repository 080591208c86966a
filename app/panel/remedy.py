"""The button that follows the advice after a run diverged: a shorter time step, and a new start."""

from collections.abc import Callable

import viser

from app.formats.formatting import time_step
from app.render.viser_types import ViserEvent
from app.scenes.contract import AnyKind, AnySnapshot


class Remedy:
    """The button, in the container that is open where this is made; hidden while nothing is wrong."""

    def __init__(self, gui: viser.GuiApi, kind: AnyKind, follow: Callable[[float], None]) -> None:
        """follow: sets a time step [s] and starts again."""
        self.kind, self.follow = kind, follow
        self.step = 0.0  # [s] that it offers; 0: none
        self.button = gui.add_button("", visible=False)
        self.button.on_click(self.on_click)

    async def on_click(self, event: ViserEvent) -> None:
        """A browser follows the advice."""
        if event.client_id is not None and self.step:
            self.follow(self.step)

    def show(self, snapshot: AnySnapshot) -> None:
        """Offer a step after a run diverged; take the offer back when the run goes on or has such a step."""
        step = 0.0
        if snapshot.status.halted and not snapshot.status.unmade and self.kind.remedy is not None:
            step = self.kind.remedy(snapshot)
        if step == self.step:
            return
        self.step = step
        if step:
            self.button.label = f"Use {time_step(step)} and start again"
        self.button.visible = bool(step)
