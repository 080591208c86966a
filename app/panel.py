"""The control panel, generated from a scene's knobs. The simulation polls `read`; callbacks touch only the panel."""

import html
import math
import time
from collections.abc import Callable
from types import ModuleType
from typing import Any

import viser

from app.ledger import Works, table
from app.messages import Command, Reset, Snapshot, StepOnce, TogglePlay
from app.plots import Plots
from sim.knobs import Knob, check, clamp_value, knobs

STATUS_EVERY = 0.25  # [s]
MARKS_EVERY = 0.5  # [s]
LEDGER_EVERY = 2.0  # [s]
OPEN_GROUPS = 2  # the first groups of knobs start open


def title(name: str, knob: Knob) -> str:
    unit = f" [{knob.unit}]" if knob.unit else ""
    return name.replace("_", " ").capitalize() + unit


def decade_marks(low: float, high: float) -> tuple[tuple[float, str], ...]:
    """Marks at decades between two logarithms, about four of them, written short."""
    prefixes = {-9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
    decades = range(math.ceil(low - 1e-9), math.floor(high + 1e-9) + 1)
    every = max(1, math.ceil((high - low) / 4))
    marks = []
    for d in decades[:: every if every < 3 else 3]:
        power = 3 * math.floor(d / 3)
        plain = -2 <= d <= 2
        marks.append((float(d), f"{10.0**d:g}" if plain else f"{10 ** (d - power)}{prefixes[power]}"))
    return tuple(marks)


def nice_step(low: float, high: float) -> float:
    """A slider's step: a round number, some 200 to 500 of them over the range."""
    rough = (high - low) / 500
    decade = 10.0 ** math.floor(math.log10(rough))
    return next(m * decade for m in (1, 2, 5, 10) if m * decade >= rough * 0.999)


class Control:
    """One knob's widgets: a value shown and taken, whatever it is made of."""

    def __init__(
        self, gui: viser.GuiApi, folder: Any, name: str, knob: Knob, value: Any, changed: Callable[[str, Any], None]
    ) -> None:
        """Made inside `folder`, its container in the panel."""
        self.gui, self.folder = gui, folder
        self.name, self.knob, self.value, self.changed = name, knob, value, changed
        self.slider: Any = None
        label, hint = title(name, knob), f"{knob.doc} ({name}: {knob.allowed})"
        if knob.choices:
            self.field: Any = gui.add_dropdown(label, knob.choices, initial_value=value, hint=hint)
        elif knob.kind is bool:
            self.field = gui.add_checkbox(label, initial_value=value, hint=hint)
        elif knob.log_from:
            whole = knob.kind is int
            self.field = gui.add_number(
                label, value, min=knob.lo, max=knob.hi, step=1 if whole else self.precision(), hint=hint
            )
            low, high = math.log10(knob.log_from), math.log10(knob.hi)
            # A multi-slider with one handle: it has no number box, which would show the logarithm.
            self.slider = gui.add_multi_slider(
                " ",
                low,
                high,
                step=(high - low) / 400,
                initial_value=(self.place(value),),
                marks=decade_marks(low, high),
                hint=f"{label}, logarithmic",
            )
            self.slider.on_update(self.on_slider)
        elif knob.kind is int:
            self.field = gui.add_slider(label, int(knob.lo), int(knob.hi), step=1, initial_value=value, hint=hint)
        else:
            step = nice_step(knob.lo, knob.hi)
            self.field = gui.add_slider(label, knob.lo, knob.hi, step=step, initial_value=value, hint=hint)
        self.field.on_update(self.on_field)
        self.mark: Any = None

    def precision(self) -> float:
        """Decimals of the number field: three digits of the smallest value of interest."""
        return 10.0 ** (math.floor(math.log10(self.knob.log_from)) - 2)

    def place(self, value: float) -> float:
        """Where the logarithmic slider stands for a value."""
        return math.log10(max(value, self.knob.log_from))

    async def on_field(self, event: Any) -> None:
        self.take(event.target.value)

    async def on_slider(self, event: Any) -> None:
        at = float(event.target.value[0])
        # At its left end the slider means the least value, which may be 0.
        value = self.knob.lo if at <= math.log10(self.knob.log_from) + 1e-9 else float(f"{10.0**at:.3g}")
        if abs(self.place(self.value) - at) > 1e-3:
            self.take(value)

    def take(self, value: Any) -> None:
        """Take a value from a browser or from a preset, show it everywhere, and pass it on if it is new."""
        good = clamp_value(self.knob, value)
        if good == self.value:
            return
        self.value = good
        self.changed(self.name, good)
        # Assigning runs the callbacks again; they find nothing new.
        self.field.value = good
        if self.slider is not None:
            self.slider.value = (self.place(good),)

    def show(self, visible: bool) -> None:
        for widget in (self.field, self.slider, self.mark):
            if widget is not None:
                widget.visible = visible

    def write(self, text: str) -> None:
        """A line under the control."""
        if self.mark is None:
            if not text:
                return
            with self.folder:
                self.mark = self.gui.add_html("", order=(self.slider or self.field).order + 0.5)
        style = "font-size:11px;opacity:.7;padding:0 12px;margin-top:-6px"
        self.mark.content = f'<div style="{style}">{text}</div>' if text else ""


class Panel:
    """The panel of one scene."""

    def __init__(
        self,
        server: viser.ViserServer,
        scene: ModuleType,
        picture: ModuleType,
        params: Any,
        post: Callable[[Command], None],
        *,
        work: Callable[[], Works],
        scenes: tuple[str, ...] = (),
        open_scene: Callable[[str], None] = lambda name: None,
    ) -> None:
        self.scene, self.picture, self.post = scene, picture, post
        self.gui = server.gui
        self.params = params
        self.status_at = self.marks_at = self.ledger_at = 0.0
        self.halted = ""
        self.server = server
        self.plots = Plots(server, scene)
        gui = self.gui
        name = scene.__name__.rpartition(".")[2]
        if len(scenes) > 1:
            chooser = gui.add_dropdown("Scene", scenes, initial_value=name)
            chooser.on_update(lambda event: open_scene(event.target.value))
        gui.add_html(
            '<div style="padding:0 12px 4px;font-size:12px;line-height:1.45;opacity:.85">'
            f"{scene.HELP}<br><b>Space</b> play or pause · <b>N</b> step · <b>R</b> reset · <b>P</b> plots · "
            "<b>G</b> grid · <b>1-9</b> presets</div>"
        )
        self.preset = gui.add_dropdown("Preset", tuple(scene.PRESETS), hint="Sets every knob and starts over")
        self.preset.on_update(self.on_preset)
        self.buttons = gui.add_button_group(" ", ("Play / pause", "Step", "Reset"))
        self.buttons.on_click(self.on_button)
        self.status = gui.add_html("")
        self.readout = gui.add_html("")
        self.controls: dict[str, Control] = {}
        groups: dict[str, Any] = {}
        for knob_name, knob in knobs(params).items():
            if knob.group not in groups:
                groups[knob.group] = gui.add_folder(knob.group, expand_by_default=len(groups) < OPEN_GROUPS)
            with groups[knob.group]:
                value = getattr(params, knob_name)
                self.controls[knob_name] = Control(gui, groups[knob.group], knob_name, knob, value, self.on_change)
        self.notes: dict[str, Any] = {}
        self.work = work
        self.map: Any = None
        with gui.add_folder("Advanced", expand_by_default=False):
            if hasattr(picture, "stiffness_knob"):
                from app.stability.live import LiveMap  # no sea imports what springs need

                self.map = LiveMap(gui, scene, self.read, lambda: picture.stiffness_knob(self.params), self.set)
            gui.add_html(note("What this scene did since it was opened, and what it did not have to do."))
            self.ledger = gui.add_html("")
        self.hide()
        self.add_keys()

    def add_keys(self) -> None:
        """Keyboard and command palette. W A S D Q E and the arrows already move the camera."""
        actions: list[tuple[str, Any, Callable[[], None]]] = [
            ("Play or pause", "space", lambda: self.post(TogglePlay())),
            ("Single step", "N", lambda: self.post(StepOnce())),
            ("Reset", "R", lambda: self.post(Reset())),
            ("Plots", "P", self.toggle_plots),
            ("Grid", "G", self.toggle_grid),
        ]
        for number, preset in enumerate(self.scene.PRESETS, 1):
            key = str(number) if number <= 9 else None  # the rest in the command palette and the list only
            actions.append((f"Preset: {preset}", key, lambda preset=preset: self.load(preset)))
        for label, key, action in actions:
            command = self.gui.add_command(label, hotkey=key)

            @command.on_trigger
            async def _(_: Any, action: Callable[[], None] = action) -> None:
                action()

    def read(self) -> Any:
        """The knobs as they stand; polled by the simulation once a frame."""
        return self.params

    def set(self, name: str, value: Any) -> None:
        """Set one knob, as its control would."""
        self.controls[name].take(value)

    def on_change(self, name: str, value: Any) -> None:
        # One new frozen record a change: whoever reads sees all of it or nothing.
        self.params = type(self.params)(**{**vars(self.params), name: value})
        self.hide()

    def hide(self) -> None:
        hidden = self.scene.hidden(self.params)
        for name, control in self.controls.items():
            control.show(name not in hidden)

    async def on_preset(self, event: Any) -> None:
        self.load(event.target.value)

    def load(self, preset: str) -> None:
        """Every knob as the preset has it, and the scene from its start."""
        params = check(type(self.params), self.scene.PRESETS[preset])
        for name, control in self.controls.items():
            control.take(getattr(params, name))
        if self.preset.value != preset:
            self.preset.value = preset
        self.post(Reset())

    async def on_button(self, event: Any) -> None:
        self.post({"Play / pause": TogglePlay(), "Step": StepOnce(), "Reset": Reset()}[event.target.value])

    def toggle_plots(self) -> None:
        shown = [c for name, c in self.controls.items() if name.startswith("plot_")]
        on = not any(c.value for c in shown)
        for control in shown:
            control.take(on)

    def toggle_grid(self) -> None:
        control = self.controls["grid"]
        control.take(not control.value)

    def update(self, snapshot: Snapshot, sent: float) -> None:
        """Show how the loop fares, and that a frame took `sent` [s] to hand over; at a few hertz, as it is HTML."""
        now = time.monotonic()
        self.plots.update(snapshot, self.params)
        if snapshot.status.halted != self.halted:
            self.halted = snapshot.status.halted
            self.status_at = 0.0
            if self.halted:
                self.notify(self.halted)
        if now - self.status_at >= STATUS_EVERY:
            self.status_at = now
            self.status.content = status_line(snapshot, sent)
            readout = self.picture.readout(snapshot)
            self.readout.content = f'<div style="padding:2px 12px 6px;font-size:12px">{readout}</div>'
        if now - self.marks_at >= MARKS_EVERY:
            self.marks_at = now
            for name, text in self.picture.marks(snapshot).items():
                self.controls[name].write(text)
            if hasattr(self.picture, "notes"):
                self.write_notes(self.picture.notes(snapshot))
            if self.map is not None:
                self.map.draw()
        if now - self.ledger_at >= LEDGER_EVERY:
            self.ledger_at = now
            self.ledger.content = note(table(self.work()))

    def write_notes(self, notes: dict[str, str]) -> None:
        """Foldable texts below the controls, as HTML: made once, then kept up to date."""
        for heading, text in notes.items():
            if heading not in self.notes:
                with self.gui.add_folder(heading, expand_by_default=False):
                    self.notes[heading] = self.gui.add_html("")
            self.notes[heading].content = note(text)

    def notify(self, text: str) -> None:
        for client in self.server.get_clients().values():
            client.add_notification("Paused", text, color="red", auto_close_seconds=10.0)


def note(text: str) -> str:
    """Text in small print, as HTML."""
    return f'<div style="padding:2px 12px 8px;font-size:12px">{text}</div>'


def status_line(snapshot: Snapshot, sent: float) -> str:
    """Running or not, the clock, real-time factors, rates; and why it halted."""
    s = snapshot.status
    state = "Running" if s.running else "Paused"
    colour = "#2b8a3e" if s.running else "#e67700"
    capped = ' <b style="color:#c92a2a">[CAPPED]</b>' if s.capped else ""
    box = "margin-top:6px;padding:6px 8px;border-left:3px solid #c92a2a;background:rgba(201,42,42,.1)"
    halted = f'<div style="{box}">{html.escape(s.halted)}</div>' if s.halted else ""
    return (
        '<div style="padding:0 12px 4px;font-size:12px">'
        f'<b style="color:{colour}">{state}</b> t = {s.time:.2f} s<br>'
        f"real time ×{s.actual:.2f} of ×{s.speed:g}{capped} · {s.rate:.0f} frames/s · "
        f"solve {s.solve * 1e3:.2f} ms · send {sent * 1e3:.2f} ms{halted}</div>"
    )
