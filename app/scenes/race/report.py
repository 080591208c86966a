"""The race in words and numbers: what each rope is called, where it is drawn, and the table of the standings."""

import html
import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.render.colormap import PALETTE
from app.scenes.race.race import Lane, Race, RaceReadings, Standing
from app.scenes.rope.parameters import Params

ROUND_OFF = 1e-10  # [J] below which an energy is none


class RaceFrame(NamedTuple):
    """What the viewer draws of a race."""

    ropes: NDArray[np.float32]  # (ropes, points, 3) [m], side by side
    ghosts: NDArray[np.float32] | None  # the same of the references, or None where there are none to show
    labels: tuple[str, ...]
    out: tuple[bool, ...]


def fraction(step: float) -> str:
    """A step [s] in a few characters: 1/240 s where it is nearly one, ms otherwise."""
    whole = round(1.0 / step)
    if whole >= 10 and abs(whole * step - 1.0) < 1e-4 and whole <= 10_000:
        return f"1/{whole} s"
    return f"{1e3 * step:.3g} ms"


def name(lane: Lane | Standing, risen: bool) -> str:
    """A rope in words; risen: with its stiffness, as they differ."""
    integrator = lane.record.name if isinstance(lane, Lane) else lane.integrator
    words = f"{lane.number} {integrator}, {fraction(lane.step)}"
    return f"{words}, k {lane.stiffness:g}" if risen else words


def place_of(lane: int, params: Params) -> float:
    """Where a rope, counted from 0, is drawn along y [m]."""
    return (lane - 0.5 * (params.ropes - 1)) * params.spacing


def race_picture(race: Race, params: Params) -> RaceFrame:
    """What to draw of a race."""
    apart = np.array([(0.0, place_of(i, params), 0.0) for i in range(len(race.lanes))])[:, None]
    ghosts = race.ghost_points() if params.ghost else None
    labels = []
    for lane in race.lanes:
        words = name(lane, race.ratio != 1.0)
        if lane.out:  # first what matters, as a label may reach out of view
            words = f"{lane.number} {lane.out.partition(':')[0]}: {words.partition(' ')[2]}"
        labels.append(words)
    return RaceFrame(
        (race.points() + apart).astype(np.float32),
        None if ghosts is None else (ghosts + apart).astype(np.float32),
        tuple(labels),
        tuple(bool(lane.out) for lane in race.lanes),
    )


def race_arrays(race: Race) -> dict[str, tuple[NDArray[np.float64], str]]:
    """The race for a file: name -> (array, unit)."""
    ghosts = np.stack([ghost.x.T for ghost in race.ghosts])
    return {
        "x": (race.points(), "m"),
        "reference": (ghosts, "m: one, or one a rope where their stiffnesses differ"),
        "separation": (np.array([ghost.separation for ghost in race.ghosts]), "m, of each reference from its shadow"),
        "error": (np.array([race.error(lane) for lane in race.lanes]), "m, NaN where rope or reference is out"),
        "energy": (np.array([lane.total() for lane in race.lanes]), "J, stored"),
        "taken": (np.array([lane.taken() for lane in race.lanes]), "J, by the method"),
    }


def metres(value: float) -> str:
    """A length in the unit it is read in."""
    for unit, size in (("m", 1.0), ("mm", 1e-3), ("µm", 1e-6), ("nm", 1e-9)):
        if value >= 0.9995 * size:
            return f"{value / size:.3g} {unit}"
    return f"{value:.1e} m"


def seconds(value: float) -> str:
    return f"{1e6 * value:.3g} µs" if value < 1e-3 else f"{1e3 * value:.3g} ms"


def error_in_words(s: Standing) -> str:
    """The distance from the reference, as far as the reference can tell."""
    if math.isnan(s.certain):
        return "nothing to compare with"
    if s.error < s.certain:
        return f"off by under {metres(s.certain)}"
    return f"off by <b>{metres(s.error)}</b>"


def row(s: Standing, risen: bool) -> str:
    """One rope: its name, and below what it costs and how good it is."""
    dot = f'<span style="color:{PALETTE[s.number - 1]};font-size:15px;line-height:11px">●</span>'
    limit = "any" if math.isinf(s.gauge.limit) else f"{s.gauge.limit:.3g}"
    colour = "inherit" if s.gauge.h_omega <= s.gauge.limit else "#c92a2a"
    head = f"<div>{dot} <b>{html.escape(name(s, risen))}</b></div>"
    gauge = f'<span style="color:{colour}">h ω {s.gauge.h_omega:.3g} of {limit}</span>'
    newton = f" · Newton {s.corrections:.1f} a step" if s.corrections else ""
    if s.out:
        fate = f'<span style="color:#c92a2a">{html.escape(s.out)}</span>'
    else:
        took = s.taken if abs(s.taken) > ROUND_OFF else 0.0
        fate = f"{error_in_words(s)} · method {'took' if took >= 0 else 'gave'} {abs(took):.2g} J"
    cost = f"{gauge} · {s.evals / s.step:.0f} forces/s · {seconds(s.cost)} a step{newton}"
    return f'{head}<div style="padding-left:17px;font-size:11px;margin-bottom:5px"><div>{fate}</div>{cost}</div>'


def standings(g: RaceReadings) -> str:
    """The table of the race, as HTML."""
    risen = len({s.stiffness for s in g.standings}) > 1
    rows = "".join(row(s, risen) for s in g.standings)
    if g.no_ghost:
        note = f"There is no reference: {html.escape(g.no_ghost)}."
    elif g.horizon is not None:
        note = (
            f"<b>Chaos took the reference at t = {g.horizon:.1f} s</b>: a start 0.1 nm away had by then parted by a "
            "hundredth of the rope, so errors mean nothing from there on. Reset begins anew."
        )
    else:
        certain = max((s.certain for s in g.standings), default=0.0)
        note = f"Grey: dopri5 at 1e-10. A second one, begun 0.1 nm away, says it tells errors above {metres(certain)}."
    return f'{rows}<div style="font-size:11px;opacity:.75">{note}</div>'
