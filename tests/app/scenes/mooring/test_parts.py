"""Parts of the mooring scene by themselves: its lines, restoring curves, tables and meshes."""

import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.render.injection import disable_shaders
from app.scenes.mooring.arrangement import body_of, build, extent, first_places, line_types, sections
from app.scenes.mooring.body_scene import MooringScene
from app.scenes.mooring.drawing.body_view import DrawnBody
from app.scenes.mooring.drawing.square import square_faces, square_points
from app.scenes.mooring.drawing.watch_view import LABELLED, WatchCircle
from app.scenes.mooring.drawing.water_view import LineRings, SeenWater
from app.scenes.mooring.drawing.waves_view import WaveHeight
from app.scenes.mooring.files.from_file import mooring_of, slack_of
from app.scenes.mooring.frame import EndStatistics
from app.scenes.mooring.parameters import MooringParams
from app.scenes.mooring.readings.excursion import Excursion
from app.scenes.mooring.readings.report import tension_table
from app.scenes.mooring.readings.restoring import CurveInputs
from app.scenes.mooring.scene import needs
from sim.mooring import Line, Point, System
from sim.mooring.rest.statics import at_rest
from sim.water import Water

FILES = Path(__file__).parents[3] / "sim" / "mooring" / "moordyn" / "files"
SMALL: dict[str, Any] = {"segments": 12, "lines": 2, "steady_force": 10.0, "time_step": 1 / 120, "wave_height": 0.0}


@pytest.fixture(scope="module")
def scene() -> MooringScene:
    return MooringScene(MooringParams(**SMALL))


def test_a_line_has_the_coefficients_of_its_controls():
    plain, lifted = line_types(MooringParams(diameter=0.07, added_mass=0.9, drag_across=1.4, drag_along=0.3))
    across_and_along = plain.added_across, plain.added_along, plain.drag_across, plain.drag_along
    assert (plain.diameter, *across_and_along) == (0.07, 0.9, 0.0, 1.4, 0.3)
    assert lifted._replace(name=plain.name, diameter=plain.diameter) == plain


def test_the_ends_of_the_floats_begin_on_the_straight_line_from_anchor_to_fairlead():
    params = MooringParams(floats=True, **SMALL)
    places, body = first_places(params), body_of(params, None)
    system, parts = build(params, places, body, None), len(sections(params))
    points = {point.id: np.array(point.position) for point in system.points}
    assert parts == 3
    for first, anchor in zip((10, 20), places.anchors, strict=True):
        assert points[first] == pytest.approx(anchor)
        for j in (1, 2):
            assert points[first + j] == pytest.approx(points[first] + j / 3 * (points[first + 9] - points[first]))


def level_tension(lines: tuple[Line, ...], span: float, rise: float, depth: float) -> float:
    """Horizontal part [N] of a line's tension at the fairlead, `rise` [m] over its anchor and `span` [m] away."""
    first, last = lines[0].start, lines[-1].end
    points = [Point(first, "fixed", (0.0, 0.0, -depth)), Point(last, "coupled", (span, 0.0, rise - depth))]
    points += [Point(line.end, "free", (0.5 * span, 0.0, 0.5 * rise - depth)) for line in lines[:-1]]
    rest = System(lines, tuple(points), Water(depth)).at_rest()
    way = rest.x[lines[-1].id][-1] - rest.x[lines[-1].id][-2]
    return float(rest.tension[lines[-1].id][-1] * way[0] / np.linalg.norm(way))


@pytest.mark.parametrize("floats", [False, pytest.param(True, marks=pytest.mark.long)])
def test_the_curve_is_the_sum_of_the_lines_each_by_itself(floats):
    scene = MooringScene(MooringParams(**{**SMALL, "floats": floats, "direction": 30.0}))
    moved = scene.attached.anchors[0]
    moved.position = moved.target = tuple(np.add(moved.position, (0.0, 5.0, 0.0)).tolist())
    scene.take_system()
    inputs = scene.curve_inputs()
    offset, force = inputs.curve(scene.rows)
    wave = np.array(inputs.wave)
    for i in range(0, len(offset), 4):
        alone = 0.0
        for k, (anchor, fairlead) in enumerate(zip(*scene.attached.places, strict=True)):
            x, y, rise = np.add(scene.excursion.rest, fairlead) - anchor
            away = -np.array([x, y]) - offset[i] * wave
            parts = tuple(line for line in inputs.system.lines if line.id // 10 == k + 1)
            span = float(np.linalg.norm(away))
            alone -= level_tension(parts, span, float(rise), scene.params.depth) * float(away @ wave) / span
        assert force[i] == pytest.approx(alone, rel=1e-4, abs=1e-4 * np.abs(force).max())


def test_the_curve_of_a_file_goes_as_far_as_its_line_and_along_the_waves():
    path = FILES / "chain.txt"
    mooring = mooring_of(str(path))
    (line,) = mooring.system.lines
    ends = {point.id: point.position for point in mooring.system.points}
    x, y, z = np.subtract(ends[line.end], ends[line.start])
    straight = math.sqrt(line.length**2 - z * z)
    inputs = CurveInputs(mooring.system, (0.6, 0.8), slack_of(mooring.system)[0], mooring.extent, 0.0)
    offset, force = inputs.curve(mooring.rows)
    assert offset[-1] == pytest.approx(1.05 * (straight - math.hypot(x, y)), rel=0.2)
    assert offset[0] == -offset[-1]
    for i in (5, len(offset) // 2, len(offset) - 6):
        away = offset[i] * np.array([0.6, 0.8, 0.0])
        rest = at_rest(mooring.system, {line.end: np.add(ends[line.end], away)})
        pull = rest.tension[line.id][-1] * (rest.x[line.id][-2] - rest.x[line.id][-1])
        pull /= np.linalg.norm(rest.x[line.id][-2] - rest.x[line.id][-1])
        assert force[i] == pytest.approx(-float(pull[:2] @ (0.6, 0.8)), rel=1e-3, abs=1.0)


def test_anchors_are_marked_whose_line_pulls_upwards(scene):
    before = scene.tensions.uplift
    scene.tensions.uplift = np.array([0.0, 5.0])
    assert scene.frame().uplift.tolist() == [False, True]
    scene.tensions.uplift = before


def test_the_table_of_tensions_numbers_lines_from_1():
    ends = [(1e3, EndStatistics(5e2, 8e2, 2e3, 1e2)), (3e3, EndStatistics(1e3, 2e3, 4e3, 3e2, 5e3))]
    text = str(tension_table("at the anchor", ends, MooringParams(breaking_load=0.0)))
    cells = [part.split("</td>")[0].split(">")[-1] for part in text.split("<td")[1:]]
    assert cells[:6] == ["1", "1", "0.5", "0.8", "2", "0.1"]
    assert (cells[6], cells[7], cells[13]) == ("–", "2", "5")  # the first has too few peaks for three hours


@pytest.mark.parametrize(("method", "pieces"), [("leapfrog", ("leapfrog",)), ("rk4", ("leapfrog", "rk4"))])
def test_a_scene_needs_leapfrog_and_its_own_method(method, pieces):
    assert needs(MooringParams(integrator=method)) == pieces


def test_the_path_begins_at_the_start():
    excursion = Excursion(np.array([1.0, 2.0, -3.0]))
    excursion.measure(0.0, np.array([4.0, 6.0, 0.0]), counts=False)
    assert excursion.path.tolist() == [[4.0, 6.0]]
    assert (excursion.offset, excursion.farthest, excursion.largest) == (5.0, 5.0, 0.0)  # the statistics are asked


@pytest.mark.parametrize("rows", [2, 3, 7])
def test_the_triangles_of_a_square_cover_it_once_and_face_up(rows):
    points, faces = square_points(rows), square_faces(rows)
    a, b, c = (points[faces[:, k]] for k in range(3))
    areas = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    assert len(faces) == 2 * (rows - 1) ** 2
    assert areas == pytest.approx(np.full(len(faces), 4.0 / len(faces)))
    middles = {tuple(np.round((a + b + c)[k] / 3.0, 9)) for k in range(len(faces))}
    assert len(middles) == len(faces)


def test_the_body_is_drawn_as_slices_of_its_hull(scene, server):
    body = DrawnBody(server, scene.frame(), lambda event: None)
    vertices, faces = body.handle.vertices, body.handle.faces
    assert vertices.dtype == np.float32
    assert np.ptp(vertices, axis=0) == pytest.approx((scene.params.size, scene.params.size, 1.0), rel=0.01)
    assert faces.max() == len(vertices) - 1
    assert faces.dtype == np.uint32


@pytest.mark.parametrize("has_shaders", [True, False])
def test_the_water_opens_about_the_body_where_pages_draw_by_shaders(scene, server, has_shaders):
    if not has_shaders:
        disable_shaders(server)
    water = SeenWater(server, scene.frame())
    assert (water.around is not None) is has_shaders


def test_the_watch_circle_is_a_circle_about_the_place_of_rest_as_wide_as_the_farthest_offset(scene, server):
    scene.advance(1)
    frame = scene.frame()
    frame = frame._replace(rest=(3.0, -2.0, 0.0), offset=1.5, params=dataclasses.replace(frame.params, watch=True))
    watch = WatchCircle(server, frame)
    watch.show(frame)
    pieces = next(handle.points for part, handle, height in watch.parts if part == "circle" and height == 0.0)
    np.testing.assert_allclose(np.hypot(*(pieces[..., :2] - (3.0, -2.0)).T), 1.5, rtol=1e-6)
    lengths = np.linalg.norm(pieces[:, 1] - pieces[:, 0], axis=-1)
    assert lengths.sum() == pytest.approx(2.0 * math.pi * 1.5, rel=1e-3)
    assert np.ptp(lengths) < 1e-6
    np.testing.assert_allclose(pieces[-1, 1], pieces[0, 0], atol=1e-6)
    assert not any(name.visible for name, _ in watch.names)
    wide = 1.01 * LABELLED * extent(frame.params)
    watch.show(frame._replace(offset=wide))
    for name, height in watch.names:
        assert name.visible
        np.testing.assert_allclose(name.position, (3.0 + wide, -2.0, height))
    watch.show(frame._replace(offset=wide, params=dataclasses.replace(frame.params, watch=False)))
    assert not any(name.visible for name, _ in watch.names)
    watch.remove()


def test_a_staff_beside_the_body_is_as_high_as_the_waves(server: Any, scene: MooringScene) -> None:
    frame, waves = scene.frame(), WaveHeight(server)

    def show(height: float) -> None:
        waves.show(frame._replace(params=dataclasses.replace(frame.params, wave_height=height)))

    show(0.0)
    assert waves.staff is None
    for height in (2.0, 12.0):
        show(height)
        assert waves.staff is not None
        bands = waves.staff.handles[0]
        low, high = np.array(bands.batched_positions)[[0, -1], 2]
        assert low <= -1.5 * height
        assert 2.0 * height <= high + bands.vertices[:, 2].max() < 3.0 * height
        same = waves.staff
        show(height)
        assert waves.staff is same
    show(0.0)
    assert waves.staff is None


def test_a_ring_lies_on_the_water_around_each_place_where_a_line_passes_through_it(
    server: Any, scene: MooringScene
) -> None:
    frame = scene.frame()
    rows, nodes = len(frame.surface), frame.points.shape[1]
    axis = np.linspace(-0.5, 0.5, rows) * frame.side
    sea = (0.5 + 0.02 * axis[:, None] - 0.03 * axis).astype(np.float32)  # a plane
    place = np.array([4.0, -7.0, 0.5 + 0.02 * 4.0 + 0.03 * 7.0])
    way = np.array([0.3, -0.2, 1.0])
    through = place + np.linspace(-9.0, 5.0, nodes)[:, None] * way
    under = through - (0.0, 0.0, 20.0)
    frame = frame._replace(surface=sea, points=np.stack([through, under]).astype(np.float32))
    rings = LineRings(server, frame)
    assert not rings.handle.visible
    rings.show(frame)
    assert rings.handle.visible
    pieces = np.asarray(rings.handle.points, float)
    np.testing.assert_allclose(np.linalg.norm(pieces - place, axis=-1), rings.radius, rtol=1e-5)
    np.testing.assert_allclose(pieces[..., 2], place[2], atol=1e-5)
    np.testing.assert_allclose(pieces[1:, 0], pieces[:-1, 1], atol=1e-6)
    rings.show(frame._replace(points=np.stack([through, through[::-1] + (1.0, 0.0, 0.02)]).astype(np.float32)))
    two = np.asarray(rings.handle.points, float)
    np.testing.assert_allclose(two[len(pieces) :], pieces + (1.0, 0.0, 0.02), atol=1e-5)
    rings.show(frame._replace(params=dataclasses.replace(frame.params, surface=False)))
    assert not rings.handle.visible
    rings.show(frame._replace(points=np.stack([under, under]).astype(np.float32)))
    assert not rings.handle.visible
    rings.remove()
