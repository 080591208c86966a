"""`springtide hydrodynamics --compare`: coefficients of the shipped shapes, and motions by them, beside Capytaine's."""

import dataclasses
import math
from typing import NamedTuple

import numpy as np
from rich import get_console
from rich.progress import Progress

from app.commands.hulls.hydrodynamics import require_capytaine
from app.formats import text_tables
from assets.shape_panels import panels_of_shape
from benchmarks.linear_motion import GRAVITY, SEA_DENSITY, first_swings, linear_decay, linear_response
from sim.floating import Body, Hull, MotionCoefficients, equilibrium_draft, make_fleet, step, still_water
from sim.floating.linear.boundary_elements import FREQUENCIES, make_table
from sim.floating.linear.hydrodynamics import LinearHull, lagrange, linear_hull, natural_frequency
from sim.floating.statics.equilibrium import SEA_WATER

COMPARED = (("Box", Hull.box(1.8, 1.8, 1.05)), ("Buoy", Hull.cylinder(0.9, 1.05)), ("Ball", Hull.sphere(0.75)))
COMPARED_DENSITY = 450.0  # [kg/m3]
RATIOS = (0.3, 0.7, 1.0, 1.4, 2.0, 3.0)  # of the frequency of heave, at which responses are compared
AXES = ((2, "heave"), (3, "roll"), (4, "pitch"))
FREE = MotionCoefficients(quadratic_drag=0.0)
NUDGE, DECAY_TIME, INTERVAL = 1e-3, 20.0, 1 / 60  # [m or rad], [s], [s] of the free decay


class Compared(NamedTuple):
    """One number of the program beside Capytaine's."""

    body: str
    quantity: str
    own: float
    capytaine: float
    limit: float  # of their relative difference

    @property
    def difference(self) -> float:
        """Relative difference."""
        return self.own / self.capytaine - 1.0


def shown(row: Compared) -> dict[str, str]:
    """A row of the table."""
    return {
        "body": row.body,
        "quantity": row.quantity,
        "Springtide": f"{row.own:.4f}",
        "Capytaine": f"{row.capytaine:.4f}",
        "difference": f"{row.difference:+.2%}",
        "within": f"{row.limit:.0%}" if abs(row.difference) <= row.limit else f"not within {row.limit:.0%}",
    }


def compare() -> int:
    """Compare the shipped shapes with Capytaine, computed now; returns 0 if all are within their limits, else 1.

    Raises OSError without Capytaine.
    """
    require_capytaine()
    console = get_console()
    rows: list[Compared] = []
    with Progress(console=console, disable=not console.is_terminal) as progress:
        task = progress.add_task("Boundary elements", total=len(COMPARED) * len(FREQUENCIES))
        for name, hull in COMPARED:
            draft = equilibrium_draft(hull, COMPARED_DENSITY, SEA_WATER)
            table = make_table(hull, [draft], lambda: progress.advance(task), panels_of_shape)
            rows += compared(name, hull, Hull.of(dataclasses.replace(hull.shape, table=table), hull))
    text_tables.print_table("", [shown(row) for row in rows])
    print("Periods: of small motions, undamped.")
    print("Decay: ratio of two extremes, a period apart, as simulated.")
    print("Response: height of heave over that of the wave; left out below 0.05.")
    return int(any(abs(row.difference) > row.limit for row in rows))


def compared(name: str, hull: Hull, known: Hull) -> list[Compared]:
    """The numbers of a hull as shipped beside those of the same hull with Capytaine's coefficients, `known`."""
    draft = equilibrium_draft(hull, COMPARED_DENSITY, SEA_WATER)
    own, live = linear_hull(hull, draft), linear_hull(known, draft)
    C, mass = stiffness_of(own), mass_of(hull)
    rows = []
    for axis, quantity in AXES:
        if C[axis, axis] <= 1e-3 * C[2, 2] * own.length**2 and axis > 2:
            continue  # no restoring moment
        inertia, restoring = mass[axis, axis] / SEA_DENSITY, C[axis, axis] / SEA_DENSITY / GRAVITY
        periods = [
            2 * math.pi / math.sqrt(GRAVITY) / natural_frequency(one, axis, inertia, restoring) for one in (own, live)
        ]
        rows.append(Compared(name, f"{quantity} period, s", periods[0], periods[1], 0.02))
        t = INTERVAL * np.arange(1, round(DECAY_TIME / INTERVAL) + 1)
        _, ratio = first_swings(simulated_decay(hull, draft, axis))
        _, wanted = first_swings(linear_decay(live, mass, C, axis, t))
        rows.append(Compared(name, f"{quantity} decay", ratio, wanted, 0.05))
    w = math.sqrt(GRAVITY) * natural_frequency(live, 2, mass[2, 2] / SEA_DENSITY, C[2, 2] / SEA_DENSITY / GRAVITY)
    for ratio in RATIOS:
        responses = [heave_response(one, mass, C, ratio * w) for one in (own, live)]
        if responses[1] > 0.05:
            rows.append(Compared(name, f"response at {ratio:g}", responses[0], responses[1], 0.02))
    return rows


def mass_of(hull: Hull) -> np.ndarray:
    """Mass matrix (6, 6) of the solid."""
    mass = np.zeros((6, 6))
    mass[:3, :3] = COMPARED_DENSITY * hull.volume * np.eye(3)
    mass[3:, 3:] = COMPARED_DENSITY * hull.inertia
    return mass


def stiffness_of(linear: LinearHull) -> np.ndarray:
    """Hydrostatic stiffness (6, 6)."""
    plane, C = linear.plane, np.zeros((6, 6))
    C[2, 2], C[3, 3], C[4, 4] = plane.rise[2], plane.slope[1, 3], -plane.slope[0, 4]
    return SEA_DENSITY * GRAVITY * C


def heave_response(linear: LinearHull, mass: np.ndarray, stiffness: np.ndarray, w: float) -> float:
    """Amplitude of heave over that of a wave of w [rad/s] from ahead."""
    index, weights = lagrange(linear.frequency, w / math.sqrt(GRAVITY))
    X = np.tensordot(weights, linear.excitation[index, 0], 1)
    return float(abs(linear_response(linear, mass, stiffness, SEA_DENSITY * GRAVITY * X, w)[2]))


def simulated_decay(hull: Hull, draft: float, axis: int) -> np.ndarray:
    """Simulated free motion along or about an axis, released at rest."""
    rest, turn = -float(hull.extents[2, 0]) - draft, [1.0, 0.0, 0.0, 0.0]
    if axis > 2:
        turn[axis - 2] = NUDGE / 2
    body = Body(hull, COMPARED_DENSITY, (0.0, 0.0, rest + (NUDGE if axis == 2 else 0.0)), (*turn,))  # type: ignore[arg-type]
    fleet = make_fleet([body], SEA_WATER)
    water, found = still_water(fleet, SEA_WATER), []
    for _ in range(round(DECAY_TIME / INTERVAL)):
        step(fleet, water, INTERVAL, FREE)
        found.append(fleet.position[0, 2] - rest if axis == 2 else 2 * fleet.rotation[0, axis - 2])
    return np.array(found)
