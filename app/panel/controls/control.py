"""One parameter in the panel: its widgets, made from its declaration."""

import math
import threading

import viser

from app.formats.round_step import round_step
from app.panel.settings import SceneSettings
from app.render.handles.viser_types import GuiHandle, ViserEvent
from app.render.markup.html import fill
from sim.parameters import Parameter, Value, in_words, parameters_of, parse_value
from sim.quantities import write_number

SLIDER_STEPS = 400  # at most, over a slider's range


def title(name: str, parameter: Parameter) -> str:
    """Label of the parameter, with its unit."""
    unit = f" [{parameter.unit}]" if parameter.unit else ""
    return (parameter.title or in_words(name)) + unit


def hint_of(name: str, parameter: Parameter) -> str:
    """Meaning, range and command-line name of the parameter."""
    allowed = "" if parameter.choices or parameter.kind is bool else f" Allowed: {parameter.allowed}."
    return f"{parameter.doc}.{allowed} Command line: {name}"


class SliderScale:
    """Scale of a slider: its position for a number and the number at a position, linear or logarithmic."""

    def __init__(self, parameter: Parameter) -> None:
        self.parameter = p = parameter
        if p.log_from:
            self.low, self.high = math.log10(p.log_from), math.log10(p.high)
            self.step = (self.high - self.low) / SLIDER_STEPS
        else:
            self.low, self.high = float(p.low), float(p.high)
            step = round_step((self.high - self.low) / SLIDER_STEPS)
            self.step = max(1.0, round(step)) if p.kind is int else step

    def position(self, value: Value) -> float:
        """Position of the slider for a number."""
        number = float(value)
        at = math.log10(max(number, self.parameter.log_from)) if self.parameter.log_from else number
        return min(max(at, self.low), self.high)

    def value(self, position: float) -> float:
        """The number at a position, which the settings bound: three digits by decades, whole steps otherwise.

        Both ends mean the bounds; the left end of a logarithmic slider is the least value, which may be 0.
        """
        p = self.parameter
        if position <= self.low + 1e-9 * abs(self.low):
            return p.low
        if position >= self.high - 1e-9 * abs(self.high):
            return p.high
        if p.log_from:
            return float(f"{10.0**position:.3g}")
        steps = round(position / self.step)
        return float(f"{steps * self.step:.6g}")


class Control:
    """One parameter's widgets. Its callbacks run on viser's event loop.

    A number has a text field, which takes the typed value exactly or refuses it, and a slider beside it.
    """

    def __init__(
        self,
        gui: viser.GuiApi,
        folder: viser.GuiFolderHandle | viser.GuiTabHandle,
        name: str,
        settings: SceneSettings,
    ) -> None:
        """folder: its container in the panel, within which it is made.

        settings: hold the value, and are set by a browser's input. The control stores no value itself.
        """
        self.gui, self.folder, self.name, self.settings = gui, folder, name, settings
        self.parameter = parameter = parameters_of(settings.params)[name]
        self.visible = True
        self.slider: viser.GuiMultiSliderHandle[float] | None = None
        self.line: viser.GuiHtmlHandle | None = None
        self.text = self.refusal = ""
        self.line_lock = threading.Lock()
        label, hint = title(name, parameter), hint_of(name, parameter)
        value = self.value
        if parameter.choices:
            choice = parameter.title_of(str(value))
            self.field: GuiHandle = gui.add_dropdown(label, parameter.choice_titles, initial_value=choice, hint=hint)
        elif parameter.kind is bool:
            self.field = gui.add_checkbox(label, initial_value=bool(value), hint=hint)
        else:
            self.scale = SliderScale(parameter)
            self.field = gui.add_text(label, write_number(float_or_int(value)), hint=hint)
            # A multi-slider with one handle: it has no number box of its own.
            self.slider = gui.add_multi_slider(
                "",
                self.scale.low,
                self.scale.high,
                step=self.scale.step,
                initial_value=(self.scale.position(value),),
                marks=(),
            )
            self.slider.on_update(self.on_slider)
        self.field.on_update(self.on_field)

    @property
    def value(self) -> Value:
        """The current value."""
        return getattr(self.settings.params, self.name)

    @property
    def content(self) -> Value:
        """Content of the field."""
        value = self.value
        if self.parameter.choices:
            return self.parameter.title_of(str(value))
        return value if self.slider is None else write_number(float_or_int(value))

    async def on_field(self, event: ViserEvent) -> None:
        """Take a browser's value of the field; viser also calls this after `show_value`, without a client."""
        if event.client_id is None:
            return
        sent: object = event.target.value
        if self.parameter.choices:
            self.set(self.parameter.choice_of(str(sent)), event.client_id)
            return
        if self.slider is None:
            self.set(sent, event.client_id)
            return
        try:
            value = parse_value(self.name, self.parameter, str(sent))
        except ValueError as reason:
            self.refuse(str(reason))
        else:
            self.set(value, event.client_id)

    async def on_slider(self, event: ViserEvent) -> None:
        """Take a browser's position of the slider."""
        if event.client_id is None:
            return
        position = float(event.target.value[0])
        # If the slider shows the present value, rounded to its step, the value stays exact.
        if abs(self.scale.position(self.value) - position) > 0.5 * self.scale.step:
            self.set(self.scale.value(position), event.client_id)

    def set(self, value: object, client: int | None = None) -> None:
        """Pass a value to the settings, and show the accepted one. client: the browser that sent it."""
        self.settings.set_all({self.name: value}, client)
        self.show_value()

    def refuse(self, reason: str) -> None:
        """Show why a text was refused, and the present value."""
        self.refusal = reason
        self.field.value = self.content
        self.show_lines()

    def show_value(self) -> None:
        """Show the present value."""
        if self.refusal:
            self.refusal = ""
            self.show_lines()
        self.field.value = self.content
        if self.slider is not None:
            self.slider.value = (self.scale.position(self.value),)

    @property
    def order(self) -> float:
        """Place of its last widget in the folder; that of the line under it is 0.5 more."""
        return (self.slider or self.field).order

    def show(self, visible: bool) -> None:
        """Show or hide all of it."""
        if visible == self.visible:
            return
        with self.line_lock:
            self.visible = visible
            for widget in (self.field, self.slider, self.line):
                if widget is not None:
                    widget.visible = visible

    def remove(self) -> None:
        """Take it from the page."""
        with self.line_lock:
            for widget in (self.field, self.slider, self.line):
                if widget is not None:
                    widget.remove()

    def write(self, text: str) -> None:
        """Write a line, as HTML, under the control."""
        if text != self.text:
            self.text = text
            self.show_lines()

    def show_lines(self) -> None:
        """Write the scene's line under the control, below the reason for which the last text was refused."""
        with self.line_lock:  # the viewer thread writes, the event loop refuses
            if self.line is None:
                if not self.text and not self.refusal:
                    return
                with self.folder:
                    self.line = self.gui.add_html("", order=self.order + 0.5, visible=self.visible)
            refusal = (
                fill('<div class="springtide-refusal" role="alert">{}</div>', self.refusal) if self.refusal else ""
            )
            line = f'<div class="springtide-line">{self.text}</div>' if self.text else ""
            self.line.content = str(refusal) + line


def float_or_int(value: Value) -> float:
    """A numeric parameter's value, an int where it is one. Raises TypeError for anything else."""
    if isinstance(value, bool | str):
        raise TypeError(f"{value!r} is not a number")
    return value
