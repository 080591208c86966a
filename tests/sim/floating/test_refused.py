"""What the library of floating bodies refuses: the error names the argument, the value, and what is allowed."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from sim.floating import (
    SHAPES,
    Body,
    Hull,
    MotionCoefficients,
    equilibrium_draft,
    heave_period,
    make_fleet,
    make_water,
    pressure_force,
    pull,
    roll_period,
    step,
    still_water,
    submerged,
)

BOX = Hull.box(1.0, 1.0, 1.0)
WATER = [(1025.0, math.inf)]
SPILL = [(850.0, 0.2), (1025.0, math.inf)]
NAN, INF = math.nan, math.inf


def cube(size: float, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> np.ndarray:
    return BOX.vertices * size + np.array([x, y, z])


def of_parts(*parts: tuple[np.ndarray, np.ndarray]) -> Hull:
    vertices = np.concatenate([points for points, _ in parts])
    return Hull.from_arrays(vertices, np.concatenate([faces + 8 * i for i, (_, faces) in enumerate(parts)]))


def step_box(*arguments, coefficients: MotionCoefficients | None = None, **named) -> None:
    fleet = make_fleet([Body(BOX)])
    step(fleet, still_water(fleet, WATER), *arguments, coefficients or MotionCoefficients(), **named)


def pull_box(*arguments) -> None:
    pull(make_fleet([Body(BOX)]), *arguments)


def water_of(*arguments, **named) -> None:
    make_water(make_fleet([Body(BOX)]), *arguments, **named)


HERE = (0.0, 0.0, 0.0)
REFUSED: list[tuple[str, str, Callable[[], object]]] = [
    ("added", "-100", lambda: heave_period(BOX, 500.0, WATER, added=-100)),
    ("added", "nan", lambda: heave_period(BOX, 500.0, WATER, added=NAN)),
    ("added", "-1", lambda: roll_period(BOX, 500.0, WATER, added=-1)),
    ("axis", "1.0", lambda: roll_period(BOX, 500.0, WATER, axis=1.0)),  # type: ignore[arg-type]
    ("axis", "True", lambda: roll_period(BOX, 500.0, WATER, axis=True)),
    ("layers", "'850'", lambda: equilibrium_draft(BOX, 500.0, [("850", "0.2"), ("1025", "inf")])),  # type: ignore[list-item]
    ("layers", "True", lambda: equilibrium_draft(BOX, 500.0, [(True, INF)])),
    ("layers", "None", lambda: equilibrium_draft(BOX, 500.0, None)),  # type: ignore[arg-type]
    ("hull", "None", lambda: equilibrium_draft(None, 500.0)),  # type: ignore[arg-type]
    ("hull", "None", lambda: submerged(None)),  # type: ignore[arg-type]
    ("hull", "None", lambda: heave_period(None, 500.0)),  # type: ignore[arg-type]
    ("hull", "None", lambda: make_fleet([Body(None)])),  # type: ignore[arg-type]
    ("faces", "inside out", lambda: of_parts((cube(1), BOX.faces), (cube(0.5, 3, 0, 0), BOX.faces[:, ::-1]))),
    ("faces", "overlap", lambda: of_parts((cube(1), BOX.faces), (cube(1, 0.5, 0, 0), BOX.faces))),
    ("faces", "overlap", lambda: of_parts((cube(1), BOX.faces), (cube(1, 0.9, 0.9, 0.9), BOX.faces))),
    ("faces", "0.4", lambda: Hull.from_arrays(BOX.vertices, BOX.faces + 0.4)),
    ("faces", "'a'", lambda: Hull.from_arrays(BOX.vertices, np.full((4, 3), "a"))),
    ("frequency", "True", lambda: Hull.sphere(1.0, True)),
    ("size", "True", lambda: Hull.of_shape(SHAPES["box"], True)),
    ("density", "-1", lambda: pressure_force(BOX, density=-1)),
    ("density", "nan", lambda: pressure_force(BOX, density=NAN)),
    ("gravity", "nan", lambda: pressure_force(BOX, gravity=NAN)),
    ("position", "'abc'", lambda: submerged(BOX, "abc")),
    ("surface", "nan", lambda: submerged(BOX, surface=NAN)),
    ("duration", "True", lambda: step_box(True)),
    ("duration", "'a'", lambda: step_box("a")),
    ("substeps", "1.7", lambda: step_box(0.01, substeps=1.7)),
    ("substeps", "True", lambda: step_box(0.01, substeps=True)),
    ("gravity", "True", lambda: step_box(0.01, coefficients=MotionCoefficients(gravity=True))),
    ("restitution", "'a'", lambda: step_box(0.01, coefficients=MotionCoefficients(restitution="a"))),  # type: ignore[arg-type]
    ("bodies[0].density", "True", lambda: make_fleet([Body(BOX, True)])),
    ("bodies[0].position", "'a'", lambda: make_fleet([Body(BOX, 500.0, ("a", 0, 0))])),  # type: ignore[arg-type]
    ("body", "0.5", lambda: pull_box(0.5, HERE, HERE, 1.0)),
    ("body", "False", lambda: pull_box(False, HERE, HERE, 1.0)),
    ("limit", "'a'", lambda: pull_box(0, HERE, HERE, "a")),
    ("limit", "True", lambda: pull_box(0, HERE, HERE, True)),
    ("point", "'abc'", lambda: pull_box(0, "abc", HERE, 1.0)),
    ("level", "nan", lambda: still_water(make_fleet([Body(BOX)]), WATER, NAN)),
    ("lead", "nan", lambda: water_of(WATER, np.zeros(1), lead=NAN)),
    ("height", "'a'", lambda: water_of(WATER, np.array(["a"]))),
]  # fmt: skip


@pytest.mark.parametrize(("name", "value", "call"), REFUSED, ids=[f"{row[0]}={row[1]}" for row in REFUSED])
def test_a_bad_argument_is_refused_by_name(name: str, value: str, call: Callable[[], object]) -> None:
    with pytest.raises(ValueError, match="is not allowed; allowed: ") as error:
        call()
    text = str(error.value)
    assert name in text.partition(":")[0]
    assert value in text.partition("; allowed")[0]


def test_what_is_allowed_stays_allowed() -> None:
    """A generator of layers, numpy's whole numbers, parts that touch or are apart, a hollow, a face without area."""
    pairs = (pair for pair in SPILL)
    assert equilibrium_draft(BOX, 500.0, pairs) == equilibrium_draft(BOX, 500.0, SPILL)  # type: ignore[arg-type]
    assert len(Hull.sphere(1.0, np.int64(4)).faces) == 320  # type: ignore[arg-type]
    assert of_parts((cube(1), BOX.faces), (cube(0.5, 3, 0, 0), BOX.faces)).volume == pytest.approx(1.125)
    assert of_parts((cube(1), BOX.faces), (cube(1, 1, 0, 0), BOX.faces)).volume == pytest.approx(2.0)
    assert of_parts((cube(1), BOX.faces), (cube(0.5), BOX.faces[:, ::-1])).volume == pytest.approx(0.875)
    a, b, c = BOX.faces[0]
    split = np.concatenate([BOX.faces[1:], [[a, 8, c], [8, b, c], [a, b, 8]]])  # 8 is on the edge from a to b
    points = np.concatenate([cube(1), [(cube(1)[a] + cube(1)[b]) / 2], cube(0.5, 3, 0, 0)])
    assert Hull.from_arrays(points, np.concatenate([split, BOX.faces + 9])).volume == pytest.approx(1.125)
