"""The block above the tabs, always visible: scene, preset, buttons, state, and the main figures."""

from collections.abc import Callable

import viser

from app.messages import Command, Pause, Play, RunState, Status, StepOnce
from app.panel.controls.remedy import Remedy
from app.panel.settings import SceneSettings
from app.render.handles.channel import Channel, Message
from app.render.handles.viser_types import GuiHandle, ViserEvent
from app.render.markup.html import ERROR_COLOUR, GOOD_COLOUR, WARNING_COLOUR, Html, coloured, fill
from app.scenes.contract import AnySnapshot, AnyView
from app.scenes.setups import write_query
from sim.parameters import in_words

BUSY_SHOWN_FROM = 0.5  # [s] of a step, above which the status line reports it
COMMANDS: dict[str, Command] = {"Play": Play(), "Pause": Pause(), "Step": StepOnce()}
BUTTONS = ("Play", "Pause", "Step", "Reset", "Camera", "Plots", "Undo")
STATE_WORDS = {  # of the status line, with their colours
    RunState.MAKING: ("Running", GOOD_COLOUR),
    RunState.MAKING_PAUSED: ("Paused", WARNING_COLOUR),
    RunState.UNMADE: ("Stopped", ERROR_COLOUR),
    RunState.RUNNING: ("Running", GOOD_COLOUR),
    RunState.PAUSED: ("Paused", WARNING_COLOUR),
    RunState.REPLAYING: ("Slow motion", WARNING_COLOUR),
    RunState.REPLAY_PAUSED: ("Slow motion", WARNING_COLOUR),
    RunState.HALTED: ("Stopped", ERROR_COLOUR),
}


class Head:
    """The block; `page.css` keeps it visible while the rest scrolls, and gives the buttons their icons."""

    def __init__(
        self,
        gui: viser.GuiApi,
        channel: Channel,
        view: AnyView,
        settings: SceneSettings,
        scenes: tuple[str, ...],
        reset_view: Callable[[viser.ClientHandle], None],
    ) -> None:
        """scenes: to choose from. reset_view: puts the camera of a browser where a new one would be."""
        self.view, self.settings, self.scenes, self.reset_view = view, settings, scenes, reset_view
        self.channel = channel
        self.running = True  # as shown by the buttons
        self.told: tuple[object, ...] = ()  # a change of it is shown at once
        self.visited = self.query = ""  # preset known to the page, and its query, for Back and Forward of the browser
        # The page finds the block by the status line in it, which says "springtide-panel".
        with gui.add_folder("Lab") as self.folder:
            self.chooser: GuiHandle | None = None
            if len(scenes) > 1:
                self.chooser = add_scene_chooser(gui, scenes, settings.kind.name, settings.open_first_view_of)
            self.preset = gui.add_dropdown(
                "Preset", settings.presets, hint="Loads all settings and starts again from rest"
            )
            self.preset.on_update(self.on_preset)
            self.buttons = gui.add_button_group("", button_names(running=True))
            self.buttons.on_click(self.on_button)
            self.status = gui.add_html("")
            self.remedy = Remedy(gui, "Use {} and start again", settings.follow)
            self.again: GuiHandle = gui.add_button("Reset with these values", visible=False)
            self.again.on_click(self.on_again)
            self.figures = gui.add_html("")
            self.code_line = gui.add_html("", visible=False)

        channel.listen("run", str, self.press)
        channel.listen("scene", str, self.open_scene)

    async def on_preset(self, event: ViserEvent) -> None:
        """Take the preset that a browser chose; viser also calls this after `show_preset`, without a client."""
        if event.client_id is not None and event.target.value in self.settings.presets:
            try:
                self.settings.load(event.target.value)
            except ValueError as reason:  # a set-up of the user, of another file
                event.client.add_notification("Couldn't open this set-up", str(reason), color="red")
                self.show_preset()

    async def on_button(self, event: ViserEvent) -> None:
        """Carry out the label of the pressed button."""
        self.act(event.target.value, event.client)

    def press(self, message: Message[str]) -> None:
        """Press a button for the page of a comparison, whose own buttons have the same names."""
        if message.value in BUTTONS:
            self.act(message.value, message.client)

    def open_scene(self, message: Message[str]) -> None:
        """Open the scene of a picture."""
        if message.value in self.scenes:
            self.settings.open_first_view_of(message.value)

    def act(self, name: str, client: viser.ClientHandle | None) -> None:
        """Carry out the label of a button. client: its browser."""
        match name:
            case "Plots":
                self.settings.toggle_plots()
            case "Undo":
                self.settings.undo()
            case "Reset":
                self.settings.reset()
            case "Camera":
                if client is not None:
                    self.reset_view(client)
            case _:
                self.settings.post(COMMANDS[name])

    async def on_again(self, event: ViserEvent) -> None:
        """Start again, for a browser."""
        if event.client_id is not None:
            self.settings.reset()

    def show_preset(self) -> None:
        """Show the list of presets, with a separate entry if an effective parameter differs from the loaded one.

        The preset itself can then be chosen again.
        """
        settings, other = self.settings, self.settings.other_name
        options = (*settings.presets, *((other,) if other else ()))
        if self.preset.options != options:
            self.preset.options = options
        self.preset.value = other or settings.loaded
        if self.visited != settings.loaded:
            kind, self.visited = settings.kind, settings.loaded
            preset = self.visited if self.visited in kind.presets else ""
            self.query = write_query(kind, settings.params_of(self.visited), preset)
        # For js/sharing/visited.js, js/panel/acts.js and js/page/veil.js.
        awaited = None if settings.placing is None else settings.placing.act
        acts = {"here": self.query, "undo": settings.undo_words, "redo": settings.redo_words, "awaited": awaited}
        self.channel.tell("acts", acts)

    def is_stale(self, snapshot: AnySnapshot, visitors: int) -> bool:
        """True if the rarely changing parts of the head are out of date."""
        running = snapshot.status.running
        if running != self.running:
            self.running = running
            self.buttons.options = button_names(running=running)
        status = snapshot.status
        last_status, self.told = self.told, (status.state, status.halted, status.outdated, status.run.placed, visitors)
        return self.told != last_status

    def show(self, snapshot: AnySnapshot, busy: float, visitors: int) -> None:
        """Show the state and the figures. busy: [s] that the present tick has taken."""
        kind, status = self.settings.kind, snapshot.status
        is_stable = kind.is_stable is not None and kind.is_stable(snapshot)
        self.status.content = str(status_line(snapshot, busy, visitors, is_stable=is_stable))
        needs_remedy = status.state is RunState.HALTED and not (status.outdated and is_stable)
        self.remedy.show(kind.remedy(snapshot) if needs_remedy and kind.remedy is not None else None)
        can_reset = status.outdated and (is_stable or kind.is_stable is None)
        if self.again.visible != can_reset:
            self.again.visible = can_reset
        self.figures.content = str(fill('<div class="springtide-figures">{}</div>', Html(self.view.figures(snapshot))))

    def show_code(self, line: Html) -> None:
        """Show one line on the state of a student's files."""
        self.code_line.visible = True
        self.code_line.content = str(fill('<div class="springtide-figures">{}</div>', line))


def button_names(*, running: bool) -> tuple[str, ...]:
    """Labels of the buttons: the first names its next action."""
    return "Pause" if running else "Play", *BUTTONS[2:]


def add_scene_chooser(
    gui: viser.GuiApi, scenes: tuple[str, ...], scene: str | None, open_scene: Callable[[str], None]
) -> GuiHandle:
    """The list of scenes, each with its name in words."""
    names = {in_words(name): name for name in scenes}
    chooser = gui.add_dropdown("Scene", tuple(names), initial_value=None if scene is None else in_words(scene))

    @chooser.on_update
    async def _(event: ViserEvent) -> None:
        if event.client_id is not None:
            open_scene(names[event.target.value])

    return chooser


def stop_words(status: Status, *, is_stable: bool) -> str:
    """Reason for a stop. It is that of the parameters at that moment, and says nothing of others.

    is_stable: a run with the present parameters would be stable.
    """
    if not status.outdated:
        return status.halted
    return f"The run stopped with other values.{' These values are stable.' if is_stable else ''} Reset starts again."


def status_line(snapshot: AnySnapshot, busy: float = 0.0, visitors: int = 1, *, is_stable: bool = False) -> Html:
    """State of the run, clock, pace, reason for a stop, and number of browsers that share the lab.

    is_stable: a run with the present parameters would be stable.
    """
    s = snapshot.status
    is_slow = s.running and s.pace < 1.0
    word = coloured(*(("Slow motion", WARNING_COLOUR) if is_slow else STATE_WORDS[s.state]))
    state = fill('<span class="springtide-state">{}</span>', word)
    pace = Html()
    if s.running and s.actual_speed is not None:
        pace = fill("×{:.2f}", s.actual_speed)
        if s.capped:
            slower = coloured("slower than set", WARNING_COLOUR)
            pace = fill("{}: ×{:.2f} instead of ×{:g}", slower, s.actual_speed, s.speed * s.pace)
    return fill(
        '<div class="springtide-panel" data-state="{}" data-snapshot="{}" data-placed="{}" title="{}">'
        "{} t = {:.2f} s{}{}{}{}{}{}{}</div>",
        "running" if s.running else "paused",
        snapshot.serial,  # so that a repeated text is seen to be new
        s.run.placed,
        f"Simulated time over real time, at {s.frame_rate:.0f} frames a second" if s.running else "",
        state,
        s.time,
        fill('<span class="springtide-speed"> · {}</span>', pace) if pace else "",
        fill("<br>The run diverged. These are its last steps.") if s.state.replays else "",
        fill("<br>This step has taken {:.1f} s so far.", busy) if busy >= BUSY_SHOWN_FROM else "",
        fill("<br>Faster: {}.", s.faster) if s.faster else "",
        fill("<br>That run is no longer in memory, so this one starts at t = 0.") if s.restarted else "",
        fill("<br>{} browsers share this lab.", visitors) if visitors > 1 else "",
        fill('<div class="springtide-stopped" role="alert">{}</div>', stop_words(s, is_stable=is_stable))
        if s.state.has_stopped
        else "",
    )
