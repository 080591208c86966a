"""One parameter in the panel: its widgets, made from its declaration."""

import math
from collections.abc import Callable

import viser

from app.render.viser_types import GuiHandle, ViserEvent
from sim.parameters import Parameter, Value, clamp_value

SLIDER_STEPS = 400  # of a logarithmic slider


def title(name: str, parameter: Parameter) -> str:
    """The parameter's name in words, with its unit."""
    unit = f" [{parameter.unit}]" if parameter.unit else ""
    return name.replace("_", " ").capitalize() + unit


def decade_marks(low: float, high: float) -> tuple[tuple[float, str], ...]:
    """Marks at decades between two logarithms, about four of them, written short."""
    prefixes = {-9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
    decades = range(math.ceil(low - 1e-9), math.floor(high + 1e-9) + 1)
    every = max(1, math.ceil((high - low) / 4))
    marks: list[tuple[float, str]] = []
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
    """One parameter's widgets. Its callbacks run on viser's event loop."""

    def __init__(
        self,
        gui: viser.GuiApi,
        folder: viser.GuiFolderHandle,
        name: str,
        parameter: Parameter,
        value: Value,
        changed: Callable[[str, Value], None],
    ) -> None:
        """folder: its container in the panel, within which it is made. changed: called with what a browser sets.

        The control holds no value of its own: its widget shows it, and the panel's record of parameters has it.
        """
        self.gui, self.folder = gui, folder
        self.name, self.parameter, self.changed = name, parameter, changed
        self.visible = True
        self.slider: viser.GuiMultiSliderHandle[float] | None = None
        self.mark: viser.GuiHtmlHandle | None = None
        label, hint = title(name, parameter), f"{parameter.doc} ({name}: {parameter.allowed})"
        if parameter.choices:
            self.field: GuiHandle = gui.add_dropdown(label, parameter.choices, initial_value=str(value), hint=hint)
        elif parameter.kind is bool:
            self.field = gui.add_checkbox(label, initial_value=bool(value), hint=hint)
        elif parameter.log_from:
            self.field, self.slider = self.make_logarithmic(label, hint, float(value))
        elif parameter.kind is int:
            self.field = gui.add_slider(
                label, int(parameter.low), int(parameter.high), step=1, initial_value=int(value), hint=hint
            )
        else:
            step = nice_step(parameter.low, parameter.high)
            self.field = gui.add_slider(
                label, parameter.low, parameter.high, step=step, initial_value=float(value), hint=hint
            )
        self.field.on_update(self.on_field)

    def make_logarithmic(
        self, label: str, hint: str, value: float
    ) -> tuple[GuiHandle, viser.GuiMultiSliderHandle[float]]:
        """A number field, and a slider over the logarithm below it."""
        p = self.parameter
        step = 1 if p.kind is int else 10.0 ** (math.floor(math.log10(p.log_from)) - 2)  # three digits of the smallest
        field = self.gui.add_number(
            label, round(value) if p.kind is int else value, min=p.low, max=p.high, step=step, hint=hint
        )
        low, high = math.log10(p.log_from), math.log10(p.high)
        # A multi-slider with one handle: it has no number box, which would show the logarithm.
        slider = self.gui.add_multi_slider(
            " ",
            low,
            high,
            step=(high - low) / SLIDER_STEPS,
            initial_value=(self.slider_position(value),),
            marks=decade_marks(low, high),
            hint=f"{label}, logarithmic",
        )
        slider.on_update(self.on_slider)
        return field, slider

    def slider_position(self, value: Value) -> float:
        """Where the logarithmic slider stands for a number."""
        return math.log10(max(float(value), self.parameter.log_from))

    async def on_field(self, event: ViserEvent) -> None:
        """A browser has set the field; viser also calls this for what `show_value` assigns, without a client."""
        if event.client_id is not None:
            self.set(event.target.value)

    async def on_slider(self, event: ViserEvent) -> None:
        """A browser has moved the logarithmic slider."""
        if event.client_id is None:
            return
        position = float(event.target.value[0])
        # At its left end the slider means the least value, which may be 0.
        at_end = position <= math.log10(self.parameter.log_from) + 1e-9
        value = self.parameter.low if at_end else float(f"{10.0**position:.3g}")
        if abs(self.slider_position(self.field.value) - position) > 1e-3:
            self.set(value)

    def set(self, value: object) -> None:
        """Take a value, bounded to what is allowed, show it, and pass it on."""
        good = clamp_value(self.parameter, value)
        self.show_value(good)
        self.changed(self.name, good)

    def show_value(self, value: Value) -> None:
        """Show a value that was set by other means."""
        if self.field.value != value:
            self.field.value = value
        if self.slider is not None:
            position = (self.slider_position(value),)
            if self.slider.value != position:
                self.slider.value = position

    def show(self, visible: bool) -> None:
        """Show or hide all of it."""
        if visible == self.visible:
            return
        self.visible = visible
        for widget in (self.field, self.slider, self.mark):
            if widget is not None:
                widget.visible = visible

    def write(self, text: str) -> None:
        """Write a line under the control."""
        if self.mark is None:
            if not text:
                return
            with self.folder:
                order = (self.slider or self.field).order + 0.5
                self.mark = self.gui.add_html("", order=order, visible=self.visible)
        style = "font-size:11px;opacity:.7;padding:0 12px;margin-top:-6px"
        self.mark.content = f'<div style="{style}">{text}</div>' if text else ""
