"""The map of the open scene over step and stiffness: measured on request, drawn in the panel, clickable.

viser has no clickable picture. The map is SVG in an HTML element, whose click handler moves a hidden slider with two
handles. From there on a click is a change like any other, which `app/server/web/guard.py` bounds.
Of viser's private names the handler uses `window.__viserMutable.sendMessage`;
`tests/browser/scenes/test_rope.py` clicks it.
"""

import dataclasses
import itertools
import math
import threading
import traceback
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
import viser
from numpy.typing import NDArray

from app.render.colormap import OUTCOME_COLOURS
from app.render.handles.channel import Channel, Message, finite
from app.render.handles.viser_types import ViserEvent
from app.render.markup.axis import Axis, decades, draw_axes
from app.render.markup.html import note
from app.scenes.contract import SpringParams, StabilityMap
from sim.parameters import Parameter, parameters_of
from sim.springs import INTEGRATORS, Integrator, Net
from sim.springs.analysis.stability_map import MapRow, map_row
from sim.springs.automatic import AUTO, choose_for_step
from sim.validation import ConvergenceError

ROWS, COLS = 20, 28
DECADES = 1.5  # of step and stiffness to each side of the parameters
WORK = 200_000  # largest product of steps and points of a cell
LEFT, TOP, WIDE, HIGH = 40.0, 24.0, 252.0, 168.0  # of the map within its picture
PICTURE = (300.0, 234.0)


class Axes(NamedTuple):
    """Request for a map."""

    params: SpringParams
    parameter: str  # of the stiffness
    steps: NDArray[np.float64]  # (COLS,) [s]
    stiffnesses: NDArray[np.float64]  # (ROWS,) in the parameter's unit

    def is_of(self, params: SpringParams) -> bool:
        """True if nothing but step and stiffness has changed since."""
        moved = {"time_step": params.time_step, self.parameter: getattr(params, self.parameter)}
        return map_values(dataclasses.replace(self.params, **moved)) == map_values(params)


def map_values(params: SpringParams) -> tuple[object, ...]:
    """The values that a map depends on."""
    names = [name for name, parameter in parameters_of(params).items() if parameter.affects != "look"]
    return tuple(getattr(params, name) for name in names)


def span(parameter: Parameter, value: float, count: int) -> NDArray[np.float64]:
    """Values (count,) about `value`, evenly spaced in the logarithm, within the parameter's range."""
    low = max(value / 10.0**DECADES, parameter.log_from)
    high = max(min(value * 10.0**DECADES, parameter.high), 1.01 * low)
    return low * (high / low) ** np.linspace(0.0, 1.0, count)


def axes_of(params: SpringParams, parameter: str) -> Axes:
    """The axes of a map about the present parameters."""
    known = parameters_of(params)
    return Axes(
        params,
        parameter,
        span(known["time_step"], params.time_step, COLS),
        span(known[parameter], getattr(params, parameter), ROWS),
    )


def method_of(params: SpringParams, net: Net) -> Integrator:
    """The running method."""
    if params.integrator == AUTO:
        return choose_for_step(net, params.time_step).integrator
    return INTEGRATORS[params.integrator]


def measure_row(scene: StabilityMap, axes: Axes, stiffness: float) -> MapRow:
    """Growth of the scene's network at rest at each step of the map."""
    params = dataclasses.replace(axes.params, **{axes.parameter: stiffness})
    net = scene.build(params)
    return map_row(method_of(params, net), net, axes.steps, min(max(WORK // params.points, 256), 4096))


class StabilityMapPanel:
    """The map in the panel: a button, the picture, and a separate thread while it is measured."""

    def __init__(
        self,
        gui: viser.GuiApi,
        scene: StabilityMap,
        read: Callable[[], SpringParams],
        take: Callable[[Mapping[str, float]], None],
        channel: Channel,
    ) -> None:
        """read: the parameters as set now; take: sets parameters at once, on viser's event loop."""
        self.scene, self.read, self.take = scene, read, take
        self.button = gui.add_button(
            "Measure the map", hint="Measures which time steps and stiffnesses are stable; click the map to go there"
        )
        self.html = gui.add_html("")
        self.axes: Axes | None = None
        self.rows: list[MapRow] = []
        self.problem = ""  # reason why the map is missing or incomplete
        self.asked = 0  # number of requests: a thread that is no longer the latest stops

        @self.button.on_click
        async def _(_: ViserEvent) -> None:
            self.ask()

        channel.listen("map", list, self.on_press)

    def ask(self) -> None:
        """Measure again, in place of the running measurement."""
        self.asked += 1
        threading.Thread(target=self.measure, args=(self.asked,), name="stability map", daemon=True).start()

    def close(self) -> None:
        """Stop measuring."""
        self.asked += 1

    def measure(self, number: int) -> None:
        """Measure row by row, in a separate thread; the panel draws the finished rows."""
        params = self.read()
        try:
            net = self.scene.build(params)
            record = method_of(params, net)
            if record.undamped_only and net.is_damped:
                self.axes, self.problem = None, f"{record.name.upper()} allows no damping: set damping and drag to 0."
                return
            axes = axes_of(params, self.scene.stiffness(params))
            rows: list[MapRow] = []
            for stiffness in axes.stiffnesses:
                rows.append(measure_row(self.scene, axes, float(stiffness)))
                if self.asked != number:
                    return
                self.axes, self.rows, self.problem = axes, list(rows), ""
        except ConvergenceError as error:
            if self.asked == number:
                self.problem = f"The map could not be measured: {error}."
        except Exception as error:
            traceback.print_exc()
            if self.asked == number:
                self.problem = f"The map could not be measured: {type(error).__name__}: {error}"

    def draw(self) -> None:
        """Show the finished rows of the map, with a dot at the present parameters; on the viewer thread."""
        axes = self.axes
        image = picture(axes, self.rows, self.read()) if axes is not None else ""
        problem = note(self.problem) if self.problem else ""
        self.html.content = image + problem

    def on_press(self, message: Message[list[object]]) -> None:
        """Go to the place of a press."""
        place = finite(message.value, 2)
        if place is not None:
            self.go(place)

    def go(self, place: tuple[float, ...]) -> None:
        """Set step and stiffness to a place in the map, (0, 0) its lower left corner and (1, 1) its upper right."""
        if self.axes is None:
            return
        self.take({
            name: float(f"{values[0] * (values[-1] / values[0]) ** min(max(part, 0.0), 1.0):.3g}")
            for name, values, part in (
                ("time_step", self.axes.steps, place[0]),
                (self.axes.parameter, self.axes.stiffnesses, place[1]),
            )
        })  # fmt: skip


def drawn_axes(axes: Axes) -> tuple[Axis, Axis]:
    """The axes of step and stiffness within the picture."""
    unit = parameters_of(axes.params)[axes.parameter].unit
    return (
        decades("time step h [s]", axes.steps[0], axes.steps[-1], LEFT, WIDE),
        decades(f"stiffness [{unit}]", axes.stiffnesses[0], axes.stiffnesses[-1], TOP + HIGH, -HIGH),
    )


def picture(axes: Axes, rows: list[MapRow], params: SpringParams) -> str:
    """The map as HTML; a press sends its place within the axes (`js/panel/buttons.js`)."""
    colours = list(OUTCOME_COLOURS.values())
    height, width = HIGH / (ROWS - 1), WIDE / (COLS - 1)
    across, up = drawn_axes(axes)
    parts: list[str] = []
    for i, row in enumerate(rows):
        y = TOP + HIGH - (i + 0.5) * height
        ends = [0, *(np.flatnonzero(np.diff(row.outcomes)) + 1).tolist(), COLS]
        for a, b in itertools.pairwise(ends):
            left, right = max((a - 0.5) * width, 0.0), min((b - 0.5) * width, WIDE)
            parts.append(
                f'<rect x="{LEFT + left:.1f}" y="{y:.1f}" width="{right - left:.1f}" height="{height + 0.3:.1f}" '
                f'fill="{colours[int(row.outcomes[a])]}"/>'
            )
    limits, right = (
        " ".join(
            f"{across.at(math.log10(step)):.1f},{TOP + HIGH - i * height:.1f}"
            for i, step in enumerate(steps)
            if 0.0 < step < math.inf
        )
        for steps in ([row.critical for row in rows], [row.accurate for row in rows])
    )
    x = across.at(math.log10(params.time_step))
    y = up.at(math.log10(max(getattr(params, axes.parameter), 1e-300)))
    done = len(rows) == ROWS
    words = " · ".join(
        f'<span style="border-left:9px solid {colour};padding-left:4px">{name}</span>'
        for name, colour in OUTCOME_COLOURS.items()
    )
    stale = "" if axes.is_of(params) else "<br><b>Settings have changed: measure again.</b>"
    progress = "" if done else f"<br>measuring: {len(rows)} of {ROWS} rows"
    clip = f'<clipPath id="springtide-map"><rect x="{LEFT}" y="{TOP}" width="{WIDE}" height="{HIGH}"/></clipPath>'
    return (
        f'<div class="springtide-note"><svg viewBox="0 0 {PICTURE[0]:.0f} {PICTURE[1]:.0f}" '
        f'class="springtide-map" role="img" aria-label="Stability over time step and stiffness" fill="currentColor" '
        f'data-springtide-act="map" data-axes="{LEFT} {TOP} {WIDE} {HIGH}">'
        f'{clip}<g clip-path="url(#springtide-map)" shape-rendering="crispEdges">{"".join(parts)}</g>'
        f'<g clip-path="url(#springtide-map)">'
        f'<polyline points="{limits}" fill="none" stroke="#000" stroke-width="1.6"/>'
        f'<polyline points="{right}" fill="none" stroke="#000" stroke-width="1.6" stroke-dasharray="5 3"/>'
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="5" fill="#fff" stroke="#000" stroke-width="2"/></g>'
        f"{draw_axes(across, up, grid=False)}</svg>"
        f"{words}<br>Line: critical step by theory; dashed: right to 1 % up to there. "
        f"Dot: the settings now. Click to go there.{progress}{stale}</div>"
    )
