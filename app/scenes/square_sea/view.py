"""The drawing of the square sea: water, rain, wave gauge and grid."""

import dataclasses
import functools
import math
from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np
import viser

from app.formats.formatting import metres, number, percent
from app.formats.packing import compile_packing
from app.formats.surface_fields import compile_surface_fields
from app.messages import Command, PointAlong, Snapshot, Vector, finite_vector
from app.render.cameras import all_cameras, place_cameras
from app.render.handles.viser_inside import set_arrays
from app.render.injection import add_data_mesh, injector_of
from app.render.markup.html import bold, fill
from app.render.material import RAIN_HEIGHT, Material, Waterline, as_linear_bytes, blend
from app.render.meshes import ball
from app.render.skies import Sky
from app.render.staff import WaveStaff, upright
from app.render.water import DrawnWater, Tile
from app.scenes.contract import Pieces, SceneView
from app.scenes.measured_sea import files_folder, height_and_period
from app.scenes.square_sea import report
from app.scenes.square_sea.frame import SeaFrame, SeaReadings
from app.scenes.square_sea.parameters import (
    GAUGE_OFFSET_SHARE,
    SURFACE_TENSION,
    VIEW_HEIGHTS,
    SquareSeaParams,
    gauge_home,
    gravity,
    marches,
    rain_settings,
)
from app.scenes.square_sea.quantities import here
from app.scenes.square_sea.rain_view import RainMesh, SprayMesh, spray_settings
from app.scenes.square_sea.tile_mesh import Highest
from sim.particles.rain import rainfall
from sim.particles.rain_rings import ring_flux, ring_wave
from sim.water import SEA_DENSITY

DEFAULTS = SquareSeaParams()
TARGETS = {  # [m] of each view: how far ahead its target is, and the target's height
    "swimmer": (6.0, 0.5),
    "side": (60.0, 0.5),
    "deck": (11.5, 2.2),
    "bridge": (30.0, 3.6),
    "mast": (40.0, 6.0),
    "platform": (120.0, 12.0),
    "gull": (70.0, 0.0),
}
# Of the significant height: where the camera stands beside the wave gauge, and the height of its target there.
GAUGE_VIEW = (-2.0, -6.0, 0.8), 0.5
MIN_GAUGE_VIEW_HEIGHT = 1.0  # [m] of the waves, for the distance of that camera, a multiple of it
CAMERA_SETBACK = 0.14  # of the tile's side: how far the camera stands behind the middle of the tile,
MAX_CAMERA_SETBACK = 20.0  # [m] but no farther than this, so that it is near the rain
OVERCAST_TINT = (0.80, 0.92, 1.02)  # colour filter on the sky where clouds cover all of it
OVERCAST_DEEP = (0.15, 0.33, 0.35)  # colour of deep water there: foam and bubbles make it paler
OVERCAST_FROM = 0.6  # cloud cover from which the sun fades; it is gone where the cover is 1
MAX_CLICK_DISTANCE = 1e5  # [m] of the camera from the origin; a click from farther away is ignored
MAX_RIPPLE_CELLS = 2.5  # longest ripple of the shader, in cells of the mesh: there its waves end
MIN_RIPPLE_LENGTHS = 3.0  # shortest ripple, in capillary lengths 2 pi sqrt(tension/(density gravity))
FOAM_CELLS = 0.9  # size of a patch of foam, in cells of the mesh, so that it hides the facets of the mesh
MAX_RIPPLE_SLOPE = 0.25  # rms, beyond which the shader's ripples look like noise
RAIN_BLUR = 0.9  # of the haze's colour in rain: all of the sky is haze there, and shows the blocks of the photograph
FLOAT_RADIUS, FLOAT_TOP, FLOAT_DRAFT, SPAR_RADIUS, SPAR_TOP = 0.45, 0.5, 0.1, 0.09, 3.0  # [m]
# The wet foot of the float: its least height above the water, what spray wets of it, and the time in which that dries.
LEAST_WET, SPRAYED, DRYING_TIME = 0.04, FLOAT_TOP + 0.002, 25.0  # [m], [m], [s]
WET_COLOUR = (0.56, 0.21, 0.07)
GAUGE_COLOUR, SPAR_COLOUR = (0.94, 0.376, 0.125), (0.96, 0.96, 0.94)


def camera_of(params: SquareSeaParams) -> tuple[Vector, Vector]:
    """Position and target [m] of a view over the tile; its height depends on the waves beside the wave gauge only."""
    view, length = params.view, params.length
    gauge_x, gauge_y = gauge_home(params)
    if view == "gauge":
        hs = max(here(params).height, MIN_GAUGE_VIEW_HEIGHT)
        (x, y, z), target_height = GAUGE_VIEW
        return (gauge_x + x * hs, gauge_y + y * hs, z * hs), (gauge_x, gauge_y, target_height * hs)
    ahead, target_height = TARGETS[view]
    if view == "side":  # across the wind, along the crests of waves that run to +x
        x = (0.5 + GAUGE_OFFSET_SHARE[0]) * length
        return (x, 0.4 * length, VIEW_HEIGHTS[view]), (x, 0.4 * length + ahead, target_height)
    x = 0.5 * length - min(CAMERA_SETBACK * length, MAX_CAMERA_SETBACK)
    return (x, 0.5 * length, VIEW_HEIGHTS[view]), (x + ahead, 0.5 * length, target_height)


@functools.lru_cache(maxsize=8)
def rain_look(rate: float, gravity: float) -> tuple[tuple[float, float, float], float]:
    """The rings and the extinction [1/m] of `Material` in rain of this rate [mm/h]; needed in each frame."""
    length, speed = ring_wave(gravity, SURFACE_TENSION, SEA_DENSITY)
    # Half of what drops take away they diffract by less than a degree: that part hides nothing.
    return (ring_flux(rate, gravity), length, speed), 0.5 * rainfall(rate, gravity).extinction


class SquareSeaView(SceneView[SquareSeaParams, SeaFrame, SeaReadings]):
    """Draws `SeaFrame`s."""

    FIELD_OF_VIEW = 0.65  # [rad]
    WARM_UP: ClassVar[Pieces] = {"packing": compile_packing, "fields of the surface": compile_surface_fields}

    def __init__(self, server: viser.ViserServer, post: Callable[[Command], None]) -> None:
        self.server, self.post = server, post
        self.water: DrawnWater | None = None
        self.rain: RainMesh | None = None
        self.spray: SprayMesh | None = None
        self.gauge: WaveGaugeMesh | None = None
        self.staff: WaveStaff | None = None
        self.mark: viser.LabelHandle | None = None
        self.marked: Highest | None = None  # crest that the mark is on
        self.mesh_shape: tuple[int, float] = (0, DEFAULTS.length)  # vertices along a side, length [m]
        self.view = DEFAULTS.view
        self.sky = Sky(server)
        self.sky_material = self.material = Material()
        self.made_of: tuple[object, ...] = ()  # arguments of the material
        self.last: SeaFrame | None = None
        server.scene.on_click()(self.on_click)  # type: ignore[arg-type]  # it takes coroutines, as on_drag does

    def first_view(self, params: SquareSeaParams) -> tuple[Vector, Vector]:
        """Position and target [m] of a camera that has not been moved."""
        return camera_of(params)

    async def on_click(self, event: Any) -> None:
        """Report the point under the mouse to the scene."""
        origin, direction = finite_vector(event.ray_origin, MAX_CLICK_DISTANCE), finite_vector(event.ray_direction)
        if origin is not None and direction is not None:
            self.post(PointAlong(origin, direction))

    def show(self, frame: SeaFrame) -> None:
        """Assign a new frame to the handles; call it where a picture is handed over as one."""
        p = frame.params
        sky = p.sky, math.radians(p.sun)
        if self.sky.shown != sky:
            self.sky_material = self.sky.set(*sky)
        made_of = p, frame.slope_resolved
        if made_of != self.made_of:
            self.made_of = made_of
            self.sky.show_stars(is_clear=p.clouds < OVERCAST_FROM)
            material = self.material_of(frame)
        else:
            material = self.material
        mesh_shape = len(frame.vertices), p.length
        if self.water is None or mesh_shape != self.mesh_shape:
            n, length = mesh_shape
            if self.water is not None:
                self.water.remove()
                self.move_cameras(self.mesh_shape[1], length)
            self.water = DrawnWater(self.server, "/sea", Tile(n, n, length), material)
            self.mesh_shape = mesh_shape
        elif material is not self.material and material != self.material:
            self.water.set_material(material)
        self.material = material
        if p.view != self.view:
            self.view = p.view
            place_cameras(self.server, *camera_of(p))
        if self.last is None or frame.vertices is not self.last.vertices:
            frame.sent.numbers = self.water.set_surface(frame.vertices, frame.slopes, frame.foam, frame.time)
            self.show_rain(frame)
            self.show_spray(frame)
            self.show_gauge(frame)
            self.mark_highest(frame)
        self.last = frame

    def material_of(self, frame: SeaFrame) -> Material:
        """The material under this sky. Its ripples have the part of Cox and Munk's slope that the mesh lacks."""
        p = frame.params
        measured = min(0.003, 0.0015 * p.wind_speed) + 0.00512 * p.wind_speed
        missing = max(measured - frame.slope_resolved - 2.0 * self.sky_material.roughness**2, 0.001)
        cell, g = p.length / len(frame.vertices), gravity(p)
        capillary = 2.0 * math.pi * math.sqrt(SURFACE_TENSION / (SEA_DENSITY * g))
        overcast = min(max((p.clouds - OVERCAST_FROM) / (1.0 - OVERCAST_FROM), 0.0), 1.0)
        tint, deep = (
            blend(clear, grey, overcast)
            for clear, grey in (
                (self.sky_material.sky_tint, OVERCAST_TINT),
                (self.sky_material.deep_color, OVERCAST_DEEP),
            )
        )
        fold, blur, limit = self.sky_material.sky_fold
        rings, extinction, sun_left = (0.0, 1.0, 1.0), 0.0, 1.0
        if p.rain > 0.0:
            rings, extinction = rain_look(p.rain, g)
            sun_left = math.exp(-extinction * RAIN_HEIGHT)
            blur = RAIN_BLUR
        return dataclasses.replace(
            self.sky_material,
            sky_fold=(fold, blur, limit),
            rain_rings=rings,
            rain_extinction=extinction,
            clouds=p.clouds,
            sky_tint=tint,
            deep_color=deep,
            sun_strength=self.sky_material.sun_strength * (1.0 - 0.93 * overcast) * sun_left,
            sun_disc=(1.0 - overcast) ** 2 * sun_left,
            cloud_darkness=0.25 + 0.45 * overcast,
            exposure=self.sky_material.exposure * p.daylight,
            haze_distance=p.visibility,
            ripple_slope=round(min(math.sqrt(missing), MAX_RIPPLE_SLOPE), 3),
            ripple_length=MAX_RIPPLE_CELLS * cell,
            ripple_shortest=MIN_RIPPLE_LENGTHS * capillary,
            ripple_direction=math.radians(p.wind_direction),
            gravity=g,
            foam_scale=max(FOAM_CELLS * cell, 0.4),
            gauge_place=(0.0, 0.0, 0.0) if frame.gauge is None else (*frame.gauge[:2], 1.0),
            wireframe=p.grid,
        )

    def show_rain(self, frame: SeaFrame) -> None:
        """Draw the rain; its meshes are made for one number of drops, and one rain."""
        rain = frame.rain
        settings = rain_settings(frame.params)
        if self.rain is not None and (
            rain is None or len(rain.drops) != self.rain.count or settings != self.rain.settings
        ):
            self.rain.remove()
            self.rain = None
        if rain is not None:
            if self.rain is None:
                self.rain = RainMesh(self.server, rain, settings, self.material.exposure)
            self.rain.show(rain)

    def show_spray(self, frame: SeaFrame) -> None:
        """Draw the spray in browsers with shaders; its mesh is made for one wind."""
        settings = None if injector_of(self.server) is None else spray_settings(frame.params)
        if self.spray is not None and self.spray.settings != settings:
            self.spray.remove()
            self.spray = None
        if self.spray is None and settings is not None:
            self.spray = SprayMesh(self.server, settings, self.material.exposure)
        if self.spray is not None:
            self.spray.show(frame.foam)

    def show_gauge(self, frame: SeaFrame) -> None:
        """Draw the wave gauge where it is shown: a buoy, or in a nonlinear sea a staff."""
        if marches(frame.params):
            self.show_staff(frame)
            return
        if self.staff is not None:
            self.staff.remove()
            self.staff = None
        if self.gauge is None and frame.gauge is not None:
            self.gauge = WaveGaugeMesh(self.server)
        if self.gauge is not None:
            self.gauge.show(frame.gauge, frame.time, reach_at(frame))
            assert self.water is not None
            self.water.set_waterlines(waterlines_of(frame.gauge))

    def show_staff(self, frame: SeaFrame) -> None:
        """Draw the staff at the wave gauge; it is made for one place and one height of the waves."""
        place = None if frame.gauge is None else (*frame.gauge[:2], here(frame.params).height)
        if self.gauge is not None:
            self.gauge.show(None, frame.time, 0.0)
        if self.staff is not None and self.staff.place != place:
            self.staff.remove()
            self.staff = None
        if self.staff is None and place is not None:
            self.staff = WaveStaff(self.server, place)
        assert self.water is not None
        self.water.set_waterlines([] if self.staff is None else [self.staff.waterline])

    def mark_highest(self, frame: SeaFrame) -> None:
        """Mark the highest crest since the start, at its place and height."""
        highest = frame.highest
        if highest == self.marked:
            return
        self.marked = highest
        if self.mark is None:
            self.mark = self.server.scene.add_label("/highest", "", anchor="bottom-center")
        self.mark.visible = highest is not None
        if highest is not None:
            self.mark.text = f"{number(highest.place[2])} m at {highest.time:.0f} s"
            self.mark.position = highest.place

    def move_cameras(self, old: float, new: float) -> None:
        """Move every camera from over a tile of side `old` [m] to as far from the middle of one of side `new` [m]."""
        for camera in all_cameras(self.server):
            if old != new:
                position, target = np.asarray(camera.position), np.asarray(camera.look_at)
                place = 0.5 * new + np.clip(position[:2] - 0.5 * old, -new, new)
                there = np.array([*place, position[2]])
                # viser moves the target along with the position, so that both are set.
                camera.position, camera.look_at = there, there + target - position

    def figures(self, snapshot: Snapshot) -> str:
        """Height and period of the waves."""
        measured = snapshot.readings.report
        if measured is None:
            return ""
        waves, theory, p = measured.measured, measured.theory, snapshot.frame.params
        highest = snapshot.frame.highest
        text = fill(
            "Waves: {} high, {} s apart", bold(metres(waves.significant_height)), bold(number(waves.peak_period))
        )
        if highest is not None:
            return fill("{}<br>{}", text, report.highest_text(highest))
        if not p.spectrum_file or not theory.whole > 0.0:
            return text
        height, period = height_and_period(p)
        held = percent(theory.statistics.significant_height / theory.whole, 3)
        return fill("{}. File: {} m, {} s; the tile holds {}.", text, number(height), number(period), held)

    def marks(self, snapshot: Snapshot) -> dict[str, str]:
        """Parameter -> the line under its control."""
        return report.marks(snapshot)

    def notes(self, snapshot: Snapshot) -> dict[str, str]:
        """Heading -> HTML of the folders below the controls."""
        return {"Measured on this sea": report.readout(snapshot), **files_folder(snapshot.frame.params)}

    def close(self) -> None:
        """Remove the click callback, which viser keeps when it removes the nodes of a scene."""
        self.server.scene.remove_click_callback(self.on_click)


class WaveGaugeMesh:
    """The wave gauge: a buoy with a spar and a ball, 3 m high, whose float is wet up to where water reached lately.

    Each part is a batch of one: a slow page places nodes before it draws the new vertices of the water, but the
    instances of a batch together with them.
    """

    def __init__(self, server: viser.ViserServer) -> None:
        vertices, faces = ball(8)
        parts = {
            "spar": (*upright(SPAR_RADIUS, -1.2, SPAR_TOP), SPAR_COLOUR),
            "float": (*upright(FLOAT_RADIUS, -FLOAT_DRAFT, FLOAT_TOP), GAUGE_COLOUR),
            "ball": (0.3 * vertices + (0.0, 0.0, SPAR_TOP), faces, GAUGE_COLOUR),
            "foot": (
                *upright(1.01 * FLOAT_RADIUS, 0.0, 1.0),
                WET_COLOUR,
            ),  # of height 1, scaled to that of the wet part
        }
        self.parts = {
            name: server.scene.add_batched_meshes_simple(
                f"/gauge/{name}",
                mesh.astype(np.float32),
                triangles,
                batched_wxyzs=np.array([[1.0, 0.0, 0.0, 0.0]], np.float32),
                batched_positions=np.zeros((1, 3), np.float32),
                batched_scales=np.ones((1, 3), np.float32),
                batched_colors=as_linear_bytes(colour),
                lod="off",
                flat_shading=name != "ball",
            )
            for name, (mesh, triangles, colour) in parts.items()
        }
        if injector_of(server) is not None:
            add_data_mesh(server, "/gauge/foot/wet", np.zeros((1, 3)))
        self.wet, self.time = 0.0, 0.0  # [m] above the water, at a time [s]

    def show(self, position: Vector | None, time: float, reach: float) -> None:
        """Draw it at a position [m]; None hides it. reach: [m] above it that the water reaches at this time [s]."""
        passed = time - self.time
        dried = FLOAT_TOP * passed / DRYING_TIME if passed >= 0.0 else self.wet  # a run that began again is dry
        self.wet, self.time = max(self.wet - dried, reach), time
        for name, part in self.parts.items():
            part.visible = position is not None
            if position is not None:
                set_arrays(part, batched_positions=np.array([position]))
            if position is not None and name == "foot":
                x, y, z = position
                scales = np.array([[1.0, 1.0, FLOAT_DRAFT + self.wet]])
                set_arrays(part, batched_positions=np.array([(x, y, z - FLOAT_DRAFT)]), batched_scales=scales)


def reach_at(frame: SeaFrame) -> float:
    """Height [m] above the wave gauge's water that waves along its float, and spray of fresh foam there, reach now."""
    if frame.gauge is None:
        return 0.0
    n, spray = len(frame.foam), spray_settings(frame.params)
    i, j = (round(c / frame.params.length * n) % n for c in frame.gauge[:2])
    if spray is not None and frame.foam[i, j] > spray.least_foam:
        return SPRAYED
    return min(LEAST_WET + FLOAT_RADIUS * float(np.hypot(*frame.slopes[i, j])), FLOAT_TOP)


def waterlines_of(gauge: Vector | None) -> list[Waterline]:
    """Float and spar of a wave gauge at this position [m], as the water mirrors them, or None."""
    if gauge is None:
        return []
    x, y, z = gauge
    return [
        Waterline((x, y), 0.0, (0.0, 0.0), radius, z + top, color=colour)
        for radius, top, colour in ((FLOAT_RADIUS, FLOAT_TOP, GAUGE_COLOUR), (SPAR_RADIUS, SPAR_TOP, SPAR_COLOUR))
    ]


VIEW = SquareSeaView
