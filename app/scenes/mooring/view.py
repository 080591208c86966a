"""The mooring seen above and below the water: bed, lines coloured by tension, body, anchors, watch circle, surface."""

import math
from typing import Any, ClassVar, NamedTuple, TypeAlias

import viser

from app.formats.packing import compile_packing
from app.messages import RestartStatistics, Snapshot, Vector
from app.render.cameras import framing_view, point_in_view, set_clipping
from app.render.handles.dragging import GrabLine, drag
from app.render.handles.gizmo import Gizmo
from app.render.skies import light_scene
from app.render.tubes import compile_tube
from app.scenes.contract import Pieces, PostCommand, SceneView
from app.scenes.mooring.arrangement import depth_of, extent, shown_points
from app.scenes.mooring.drawing.bed_view import DrawnBed
from app.scenes.mooring.drawing.body_view import DrawnBody
from app.scenes.mooring.drawing.ends_view import DrawnEnds
from app.scenes.mooring.drawing.lines_view import DrawnLines
from app.scenes.mooring.drawing.watch_view import WatchCircle
from app.scenes.mooring.drawing.water_view import LineRings, SeenWater
from app.scenes.mooring.drawing.waves_view import WaveHeight
from app.scenes.mooring.frame import MooringFrame, MooringReadings
from app.scenes.mooring.parameters import MAX_LINES, MooringParams
from app.scenes.mooring.readings.report import TENSIONS, figures_of, marks_of, notes_of, readout_of
from app.scenes.springs.drawing.html import simple_drawing

ARROW_SIZE, SMALL_ARROW_SIZE = 0.10, 0.05  # in `extent`s
BEARING, PITCH = math.radians(277.0), math.radians(17.5)  # of the first view: across the waves, the horizon high up
FRAME = 0.97, -0.9, 0.4  # half width, lower and upper edge of what it shows, over half the height of the picture
LABEL = -0.15, -0.78  # where it shows the depth, in the same
FAR_VIEW = 40.0  # where the picture ends, and the bed would, in `extent`s
MooringSnapshot: TypeAlias = Snapshot[MooringParams, MooringFrame, MooringReadings]
Shape: TypeAlias = tuple[Any, ...]


class DrawnMooring(NamedTuple):
    """The parts of the picture, in the order in which they are made."""

    bed: DrawnBed
    lines: DrawnLines
    body: DrawnBody
    ends: DrawnEnds
    watch: WatchCircle
    waves: WaveHeight
    water: SeenWater
    rings: LineRings


class MooringView(SceneView[MooringParams, MooringFrame, MooringReadings]):
    """Draws `MooringFrame`s."""

    FIELD_OF_VIEW = 0.8  # [rad]
    WARM_UP: ClassVar[Pieces] = {"drawing": compile_tube, "packing": compile_packing}
    BUTTONS: ClassVar = {TENSIONS: {"Restart the statistics": RestartStatistics()}}

    def __init__(self, server: viser.ViserServer, post: PostCommand) -> None:
        self.server, self.post = server, post
        self.built: Shape = ()
        self.drawn: DrawnMooring | None = None
        light_scene(server, "studio", background=False, environment_intensity=0.4)
        server.scene.configure_default_lights(enabled=True, cast_shadow=False)
        self.grab = GrabLine(server)
        self.gizmos = {
            name: Gizmo(server, post, name, 1.0, position=(0.0, 0.0, 0.0), visible=False)
            for i in range(1, MAX_LINES + 1)
            for name in (f"anchor {i}", f"fairlead {i}")
        }

    def first_view(self, params: MooringParams) -> tuple[Vector, Vector]:
        """Position and target [m] of a camera that has not been moved: near enough that its picture is full."""
        return framing_view(shown_points(params), BEARING, PITCH, self.FIELD_OF_VIEW, FRAME)

    def build(self, frame: MooringFrame) -> DrawnMooring:
        """Make everything for another arrangement."""
        for part in self.drawn or ():
            part.remove()
        server, far = self.server, extent(frame.params)
        label = point_in_view(self.first_view(frame.params), self.FIELD_OF_VIEW, LABEL, -depth_of(frame.params))
        set_clipping(server, 0.002 * far, FAR_VIEW * far)
        return DrawnMooring(
            DrawnBed(server, frame, label), DrawnLines(server, frame), DrawnBody(server, frame, self.on_body),
            DrawnEnds(server, frame), WatchCircle(server, frame), WaveHeight(server), SeenWater(server, frame),
            LineRings(server, frame),
        )  # fmt: skip

    @staticmethod
    def shape_of(frame: MooringFrame) -> Shape:
        """The inputs of a drawing: all that `build` reads, except for those that `show` assigns."""
        p = frame.params
        file = p.moordyn_file, p.file_changes
        return frame.points.shape, file, p.reach, p.depth, p.body, p.size, frame.surface.shape, frame.rest[2]

    async def on_body(self, event: Any) -> None:
        """Grab the body, and pull it."""
        drag(self.post, event, 0)

    def show(self, frame: MooringFrame) -> None:
        """Assign a new frame to the handles; call it where a picture is handed over as one."""
        if self.drawn is None or self.shape_of(frame) != self.built:
            self.drawn, self.built = self.build(frame), self.shape_of(frame)
        for part in self.drawn:
            part.show(frame)
        self.show_handles(frame)
        self.grab.show_pull(frame.grab)

    def show_handles(self, frame: MooringFrame) -> None:
        """The arrows of anchors and fairleads."""
        p, far = frame.params, extent(frame.params)
        for i in range(MAX_LINES):
            is_shown = p.handles and not p.moordyn_file and i < len(frame.points)
            for kind, node, scale in (("anchor", 0, ARROW_SIZE), ("fairlead", -1, SMALL_ARROW_SIZE)):
                gizmo = self.gizmos[f"{kind} {i + 1}"]
                if is_shown and gizmo.handle.scale != scale * far:
                    gizmo.handle.scale = scale * far
                x, y, z = frame.points[i, node].tolist() if is_shown else (0.0, 0.0, 0.0)
                gizmo.show((x, y, z) if is_shown else None)

    def figures(self, snapshot: MooringSnapshot) -> str:
        """The largest tension."""
        return figures_of(snapshot)

    def readout(self, snapshot: MooringSnapshot) -> str:
        """The key of the colours."""
        has_colours = self.drawn is None or self.drawn.lines.has_colours
        return readout_of(snapshot) if has_colours else simple_drawing("tension")

    def marks(self, snapshot: MooringSnapshot) -> dict[str, str]:
        """Parameter -> the line under its control."""
        return marks_of(snapshot)

    def notes(self, snapshot: MooringSnapshot) -> dict[str, str]:
        """Heading -> HTML of the folders below the controls."""
        return notes_of(snapshot)


VIEW = MooringView
