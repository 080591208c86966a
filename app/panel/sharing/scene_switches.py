"""A line on the last link or file of one browser that changed a shared lab, for all browsers, with an undo.

The last change wins. `SceneSwitches` outlives the panels, as a link may open another scene; its entry is
replaced as a whole, on viser's event loop and on the viewer's thread.
"""

import time
from collections.abc import Callable
from typing import NamedTuple

import viser

from app.render.handles.viser_types import ViserEvent
from app.render.markup.html import fill, note
from app.scenes import scene_named
from app.scenes.comparisons import COMPARISONS
from app.scenes.setups import Setup

SHOWN_TIME = 5.0  # [s] for which a change is shown
UNDO = "Undo this change"


class SceneSwitch(NamedTuple):
    """A change of the whole lab."""

    page: str  # word of the page that made it (app/render/js/core/viewer.js)
    scene: str  # shown after it
    subject: Setup | str  # opened: a set-up, or the name of a comparison
    before: Setup  # the former set-up
    end: float = 0.0  # [s] of the monotonic clock until which it is shown; 0: not shown yet

    def words(self) -> str:
        """The line as HTML; each page shows its own sentence."""
        if isinstance(self.subject, str):
            title, name = COMPARISONS[self.subject].title, "side by side"
        else:
            title, name = scene_named(self.subject.scene).title, self.subject.name or self.subject.preset
        what = fill("<b>{}</b>{}", title, f" ({name})" if name else "")
        return note(
            fill(
                '<span class="springtide-switch" data-page="{}">'
                '<span class="springtide-own">You switched everyone to {}.</span>'
                '<span class="springtide-others">Someone else switched everyone to {}.</span></span>',
                self.page, what, what,
            )
        )  # fmt: skip


class SceneSwitches:
    """The last change of one server."""

    def __init__(self) -> None:
        self.latest: SceneSwitch | None = None

    def shown_in(self, scene: str) -> SceneSwitch | None:
        """The change to show in the panel of a scene; its time begins in the panel of the opened scene."""
        change = self.latest
        if change is None or change.scene != scene:
            return None
        now = time.monotonic()
        if change.end == 0.0:
            change = self.latest = change._replace(end=now + SHOWN_TIME)
        if now > change.end:
            self.latest = change = None
        return change


class SwitchNotice:
    """The line in one panel."""

    def __init__(
        self,
        gui: viser.GuiApi,
        scene: str,
        changes: SceneSwitches,
        restore: Callable[[SceneSwitch], None],
        is_undone: Callable[[SceneSwitch], bool],
    ) -> None:
        """Add it to the container that is open. restore: undoes a change. is_undone: a person has done so otherwise."""
        self.scene, self.changes, self.restore, self.is_undone = scene, changes, restore, is_undone
        self.text = gui.add_html("", visible=False)
        self.undo = gui.add_button_group("", (UNDO,), visible=False)
        self.undo.on_click(self.on_undo)

    def draw(self) -> None:
        """Show the change, or none; on the viewer's thread."""
        change = self.changes.shown_in(self.scene)
        if change is not None and self.is_undone(change):
            change = self.changes.latest = None
        if change is not None:
            self.text.content = change.words()
        self.text.visible = change is not None
        self.undo.visible = change is not None

    async def on_undo(self, _: ViserEvent) -> None:
        """Undo the change; the first press counts."""
        change, self.changes.latest = self.changes.latest, None
        if change is not None:
            self.restore(change)
