"""The map of the open scene over step and stiffness: measured on request, drawn in the panel, clickable.

viser has no picture that answers a click. The map is SVG in an HTML element, whose click handler moves a hidden slider
of two handles; from there on a click is a change like any other, bounded by `app/guard.py` and taken by the controls.
Of viser's inner names the handler uses `window.__viserMutable.sendMessage`; `tests/browser/test_rope.py` clicks it.
"""

import dataclasses
import itertools
import math
import threading
from collections.abc import Callable
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.stability import OUTCOMES
from sim.knobs import Knob, knobs
from sim.springs import INTEGRATORS
from sim.springs.growth import outcome
from sim.springs.settle import settled
from sim.springs.stability import critical_step
from sim.springs.state import State

ROWS, COLS = 20, 28
DECADES = 1.5  # of step and of stiffness to each side of where the knobs stand
WORK = 200_000  # steps times points that a cell may take
LEFT, TOP, WIDE, HIGH = 54.0, 8.0, 238.0, 168.0  # of the map within its picture
PICTURE = (300.0, 214.0)


class Axes(NamedTuple):
    """What a map was asked for."""

    params: Any
    knob: str  # of the stiffness
    steps: NDArray[np.float64]  # (COLS,) [s]
    stiffnesses: NDArray[np.float64]  # (ROWS,) in the knob's unit

    def is_of(self, params: Any) -> bool:
        """Whether nothing but step and stiffness has changed since."""
        moved = {"time_step": params.time_step, self.knob: getattr(params, self.knob)}
        return shown(dataclasses.replace(self.params, **moved)) == shown(params)


class Row(NamedTuple):
    """One stiffness of a map."""

    outcomes: NDArray[np.int64]  # (COLS,)
    critical: float  # [s]


def shown(params: Any) -> tuple[Any, ...]:
    """The knobs that a map depends on."""
    aside = ("Look", "Plots", "Race")
    names = [name for name, knob in knobs(params).items() if knob.group not in aside and name != "speed"]
    return tuple(getattr(params, name) for name in names)


def span(knob: Knob, value: float, count: int) -> NDArray[np.float64]:
    """Values (count,) about `value`, evenly in their logarithms, within what the knob allows."""
    low = max(value / 10.0**DECADES, knob.log_from)
    return np.geomspace(low, max(min(value * 10.0**DECADES, knob.hi), 1.01 * low), count)


def axes_of(params: Any, knob: str) -> Axes:
    """The axes of a map about where the knobs stand."""
    known = knobs(params)
    return Axes(
        params,
        knob,
        span(known["time_step"], params.time_step, COLS),
        span(known[knob], getattr(params, knob), ROWS),
    )


def measure_row(scene: ModuleType, axes: Axes, stiffness: float) -> Row:
    """What becomes of the scene's net at rest at each step of the map."""
    params = dataclasses.replace(axes.params, **{axes.knob: stiffness})
    net, record = scene.build(params), INTEGRATORS[params.integrator]
    state = State.at_rest(net)
    state.x[:] = settled(net)
    most = min(max(WORK // params.points, 256), 4096)
    outcomes = [outcome(record, net, float(h), state.x, most) for h in axes.steps]
    return Row(np.array(outcomes), critical_step(net, record, state))


class LiveMap:
    """The map in the panel: a button, the picture, and a thread of its own while it is measured."""

    def __init__(
        self, gui: Any, scene: ModuleType, read: Callable[[], Any], knob: Callable[[], str],
        take: Callable[[str, float], None],
    ) -> None:  # fmt: skip
        """read: the knobs as they stand; knob: the name of the stiffness in force; take: sets a knob."""
        self.scene, self.read, self.knob, self.take = scene, read, knob, take
        self.button = gui.add_button(
            "Map of step and stiffness", hint="Measures which steps and stiffnesses hold; click the map to go there"
        )
        self.button.on_click(lambda _: self.ask())
        self.html = gui.add_html("")
        self.click = gui.add_multi_slider(" ", 0.0, 1.0, step=1e-4, initial_value=(0.0, 0.0), visible=False)
        self.click.on_update(lambda event: self.go(event.target.value))
        self.axes: Axes | None = None
        self.rows: list[Row] = []
        self.asked = 0  # how often: a thread that is no longer the latest stops

    def ask(self) -> None:
        """Measure anew, in place of what is being measured."""
        self.asked += 1
        threading.Thread(target=self.measure, args=(self.asked,), name="stability map", daemon=True).start()

    def measure(self, number: int) -> None:
        params = self.read()
        record = INTEGRATORS[params.integrator]
        if record.undamped_only and self.scene.build(params).is_damped:
            self.axes = None
            self.html.content = f'<div style="padding:0 12px">{record.name} takes no damping.</div>'
            return
        axes, rows = axes_of(params, self.knob()), []
        for stiffness in axes.stiffnesses:
            rows.append(measure_row(self.scene, axes, float(stiffness)))
            if self.asked != number:
                return
            self.axes, self.rows = axes, list(rows)
            self.draw()

    def draw(self) -> None:
        """Show the map as far as it is known, with a dot where the knobs stand."""
        axes, rows = self.axes, self.rows
        if axes is not None:
            self.html.content = picture(axes, rows, self.read(), self.click._impl.uuid)

    def go(self, place: tuple[float, ...]) -> None:
        """Set step and stiffness to a place in the map, (0, 0) its lower left corner and (1, 1) its upper right."""
        if self.axes is None:
            return
        for name, values, part in (
            ("time_step", self.axes.steps, place[0]),
            (self.axes.knob, self.axes.stiffnesses, place[1]),
        ):
            self.take(name, float(f"{values[0] * (values[-1] / values[0]) ** min(max(part, 0.0), 1.0):.3g}"))


def short(value: float) -> str:
    """A tick's number: plain where that is short."""
    return f"{value:.3g}" if 1e-3 <= value < 1e3 else f"{value:.1e}".replace("e+0", "e").replace("e-0", "e-")


def place_of(values: NDArray[np.float64], value: float) -> float:
    """Where a value lies between the first and the last, 0 to 1, by logarithms."""
    return math.log(max(value, 1e-300) / values[0]) / math.log(values[-1] / values[0])


def picture(axes: Axes, rows: list[Row], params: Any, slider: str) -> str:
    """The map as HTML. slider: the uuid of what a click moves."""
    colours = list(OUTCOMES.values())
    height, width = HIGH / (ROWS - 1), WIDE / (COLS - 1)
    parts = []
    for i, row in enumerate(rows):
        y = TOP + HIGH - (i + 0.5) * height
        ends = [0, *(np.flatnonzero(np.diff(row.outcomes)) + 1).tolist(), COLS]
        for a, b in itertools.pairwise(ends):
            left, right = max((a - 0.5) * width, 0.0), min((b - 0.5) * width, WIDE)
            parts.append(
                f'<rect x="{LEFT + left:.1f}" y="{y:.1f}" width="{right - left:.1f}" height="{height + 0.3:.1f}" '
                f'fill="{colours[int(row.outcomes[a])]}"/>'
            )
    limits = [
        f"{LEFT + WIDE * place_of(axes.steps, row.critical):.1f},{TOP + HIGH - i * height:.1f}"
        for i, row in enumerate(rows)
        if 0.0 < row.critical < math.inf
    ]
    x = LEFT + WIDE * place_of(axes.steps, params.time_step)
    y = TOP + HIGH * (1.0 - place_of(axes.stiffnesses, getattr(params, axes.knob)))
    known = knobs(params)
    ticks = ""
    for values, unit, across in ((axes.steps, "s", True), (axes.stiffnesses, known[axes.knob].unit, False)):
        for part in (0.0, 0.5, 1.0):
            value = values[0] * (values[-1] / values[0]) ** part
            at = (LEFT + WIDE * part, TOP + HIGH + 12) if across else (LEFT - 4, TOP + HIGH * (1.0 - part) + 4)
            anchor = ("start", "middle", "end")[int(2 * part)] if across else "end"
            ticks += f'<text x="{at[0]:.0f}" y="{at[1]:.0f}" text-anchor="{anchor}">{short(value)}</text>'
        name = f"h [{unit}]" if across else f"k [{unit}]"
        at = (LEFT + WIDE / 2, TOP + HIGH + 25) if across else (8, TOP + HIGH / 2)
        turn = "" if across else f' transform="rotate(-90 {at[0]} {at[1]})"'
        ticks += f'<text x="{at[0]}" y="{at[1]}" text-anchor="middle"{turn}>{name}</text>'
    done = len(rows) == ROWS
    words = " · ".join(
        f'<span style="border-left:9px solid {colour};padding-left:4px">{name}</span>'
        for name, colour in OUTCOMES.items()
    )
    stale = "" if axes.is_of(params) else "<br><b>Of other knobs than now: measure again.</b>"
    progress = "" if done else f"<br>measuring, {len(rows)} of {ROWS} stiffnesses"
    send = (
        "const p=new DOMPoint(event.clientX,event.clientY).matrixTransform(this.getScreenCTM().inverse());"
        f"const x=(p.x-{LEFT})/{WIDE},y=1-(p.y-{TOP})/{HIGH};"
        f"if(x>=0&&x<=1&&y>=0&&y<=1)window.__viserMutable.sendMessage("
        f"{{type:'GuiUpdateMessage',uuid:'{slider}',updates:{{value:[x,y]}}}})"
    )
    clip = f'<clipPath id="springtide-map"><rect x="{LEFT}" y="{TOP}" width="{WIDE}" height="{HIGH}"/></clipPath>'
    return (
        f'<div style="padding:2px 12px 8px;font-size:12px"><svg viewBox="0 0 {PICTURE[0]:.0f} {PICTURE[1]:.0f}" '
        f'class="springtide-map" style="width:100%;cursor:crosshair;font-size:10px" fill="currentColor" '
        f'onclick="{send}">{clip}<g clip-path="url(#springtide-map)" shape-rendering="crispEdges">{"".join(parts)}'
        f'</g><g clip-path="url(#springtide-map)">'
        f'<polyline points="{" ".join(limits)}" fill="none" stroke="#000" stroke-width="1.6"/>'
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="5" fill="#fff" stroke="#000" stroke-width="2"/></g>{ticks}</svg>'
        f"{words} · line: critical step{progress}{stale}</div>"
    )
