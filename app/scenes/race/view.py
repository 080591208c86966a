"""The race as drawn: a tube for each rope in its own colour, the reference runs translucent, a label on each root."""

import math
from typing import ClassVar, TypeAlias

import numpy as np
import viser

from app.messages import Snapshot, Vector
from app.render.colormap import lifted, rgb
from app.render.handles.viser_inside import set_arrays, update_node
from app.render.injection import injector_of
from app.render.tubes import compile_tube
from app.scenes.charts import PALETTE
from app.scenes.contract import Pieces, PostCommand
from app.scenes.race.entrants import RaceReadings
from app.scenes.race.html import errors_line, results_table
from app.scenes.race.parameters import RaceParams
from app.scenes.race.scene import RaceFrame
from app.scenes.springs.drawing.html import step_mark
from app.scenes.springs.drawing.ropes_view import RopesDrawing, RopesView
from app.scenes.springs.drawing.view import Translucent
from app.scenes.springs.net_motion import rope_lengths
from app.scenes.springs.rope_parameters import ROOT, ROPE_RADIUS, build_rope

TUBE_RADIUS = 0.75 * ROPE_RADIUS  # [m]
REFERENCE_RADIUS = 0.9 * TUBE_RADIUS  # [m], so that a rope without error hides its reference run
REFERENCE_COLOUR = (70, 76, 88)
REFERENCE_OPACITY = 0.4
COLOUR_SCALE = 0.6  # of a colour's numbers, so that a rope lit from all sides has the colour it has in the charts
DARK_LIFT = 0.15  # fraction of white that a black rope would get on a dark floor, where dark blue would hardly be seen
FAILED_OPACITY = 0.35  # of a rope that has stopped
LABEL_SCALE = 1.1  # of a label, over viser's own size: letters of 13 pixels
LABEL_SHARE = 0.075  # height of a row of labels, over that of the first view: those of 200 pixels can still be read
FIRST_LABEL, LABEL_AIR = 0.4, 1.3  # rows from a root to the lowest label, and from the highest to the picture's edge

BEARING = math.cos(0.22), math.sin(0.22)  # of the first view: far enough aside to tell the ropes apart
ELEVATION = 0.05  # [rad] of the first view
NEAR = 1.0  # [m] from the camera, where the picture begins: nearer, and depth is too coarse for ropes that far away
SHOWN_SWING = 1.0  # fraction of the length of a rope to either side that the first view shows: where it starts, level
PULL_OF_FALL = 3.0  # of a rope that falls and swings, over its weight: stretches it by as much as the first view shows
MAX_STRETCH = 3.0  # [m] that the first view shows
BELOW_FLOOR = 0.15  # [m] below a floor that the first view shows: a rope sinks into it, and has a radius
SHOWN_ASPECT = 1.25  # width over height of what the first view shows at least (`js/page/camera.js`)

RaceSnapshot: TypeAlias = Snapshot[RaceParams, RaceFrame, RaceReadings]


def material_colour(index: int, *, dark: bool = False) -> tuple[int, int, int]:
    """The colour of a rope's material; dark: on a dark floor."""
    colour = np.array([rgb(PALETTE[index])], float)
    red, green, blue = np.rint(lifted(colour, DARK_LIFT) if dark else COLOUR_SCALE * colour)[0].astype(int).tolist()
    return red, green, blue


def linear_colour(colour: tuple[int, int, int]) -> np.ndarray:
    """An sRGB colour in linear numbers, 0 to 255: viser takes the colours of instances and of lines as such."""
    return 255.0 * (np.array(colour) / 255.0) ** 2.2


def label_heights(count: int) -> np.ndarray:
    """Heights (count,) of the labels over the roots, in rows: the first half goes to the left, outer ones are lower."""
    left = np.arange(count)
    return FIRST_LABEL + np.minimum(left, left[::-1])


def label_rows(count: int) -> float:
    """Rows from the roots to the upper edge of the first view."""
    return float(label_heights(count).max()) + LABEL_AIR


def shown_height(params: RaceParams) -> float:
    """Height [m] of the first view: of all ropes, as far as they swing, and of their labels."""
    depth = (params.ropes - 1) * params.spacing
    across = BEARING[0] * 2.0 * params.length * SHOWN_SWING + BEARING[1] * depth
    length, stretch = rope_lengths(build_rope(params, ROOT))  # of rope 1, the softest
    fall = length + min(PULL_OF_FALL * stretch, MAX_STRETCH)
    if params.floor:
        fall = min(fall, ROOT[2] + BELOW_FLOOR)
    fall += 0.5 * depth * ELEVATION  # the nearest rope is drawn lower
    return max(fall / (1.0 - LABEL_SHARE * label_rows(params.ropes)), across / SHOWN_ASPECT)


class RootLabels:
    """A label over each root, on a pole."""

    def __init__(self, server: viser.ViserServer, frame: RaceFrame, row: float) -> None:
        """row: height [m] of a row of labels."""
        count = len(frame.labels)
        self.places = self.poles_of(frame, row)
        self.poles = server.scene.add_line_segments(
            "/race/poles",
            self.places,
            colors=np.repeat([[linear_colour(rgb(colour))] for colour in PALETTE[:count]], 2, axis=1).astype(np.uint8),
            thickness=2.0,
            thickness_units="screen",
        )
        self.handles = [
            server.scene.add_label(
                f"/race/label_{i + 1}",
                text,
                position=tuple(self.places[i, 1].tolist()),
                font_screen_scale=LABEL_SCALE,
                anchor="bottom-right" if i < count // 2 else "bottom-left",
            )
            for i, text in enumerate(frame.labels)
        ]

    def poles_of(self, frame: RaceFrame, row: float) -> np.ndarray:
        """(ropes, 2, 3): from each root up to its label [m]. row: height [m] of a row of labels."""
        poles = np.repeat(frame.ropes[:, :1], 2, axis=1)
        poles[:, 1, 2] += row * label_heights(len(poles))
        return poles

    def show(self, frame: RaceFrame, row: float) -> None:
        """Assign a new frame. row: height [m] of a row of labels."""
        places = self.poles_of(frame, row)
        if not np.array_equal(self.places, places):
            self.places = self.poles.points = places
            for label, pole in zip(self.handles, places.tolist(), strict=True):
                label.position = tuple(pole[1])
        for label, text in zip(self.handles, frame.labels, strict=True):
            if label.text != text:
                label.text = text

    def remove(self) -> None:
        """Remove everything from the scene."""
        for handle in (*self.handles, self.poles):
            handle.remove()


class RacingRopes(RopesDrawing):
    """Ropes in a colour each, with a label at each root."""

    RADIUS = TUBE_RADIUS
    RINGS = 90
    SIDES = 8
    BEADS = "/race/points"
    BEAD_ROWS = 6

    def __init__(self, server: viser.ViserServer, frame: RaceFrame, row: float, dark: set[int]) -> None:
        """row: height [m] of a row of labels. dark: browsers that draw on a dark floor."""
        super().__init__(server, frame, frame.ropes, [f"/race/rope_{i + 1}" for i in range(len(frame.ropes))])
        self.labels = RootLabels(server, frame, row)
        self.shown_failed = (False,) * len(frame.ropes)
        faces, each = self.tube.faces, self.tube.shape[0]
        self.all_faces = np.concatenate([faces + i * each for i in range(len(frame.ropes))]).astype(np.uint32)
        self.dark = dark
        self.darken()

    def make_tube(self, frame: RaceFrame, number: int, name: str) -> viser.MeshHandle:
        """The node of a rope's tube."""
        return self.server.scene.add_mesh_simple(
            name, self.vertices[number], self.tube.faces, color=material_colour(number), side="double"
        )

    def bead_colours(self, *, dark: bool = False) -> np.ndarray:
        """Colours (ropes points, 3) of the beads, none grabbed. dark: on a dark floor."""
        count, points, _ = self.points.shape
        ropes = [linear_colour(material_colour(i, dark=dark)) for i in range(count)]
        return np.repeat(ropes, points, axis=0).astype(np.uint8)

    def show(self, frame: RaceFrame) -> None:
        """Assign a new frame; called while a picture is handed over as one."""
        self.shape_tubes(frame.ropes)
        for i, tube in enumerate(self.tubes):
            set_arrays(tube, vertices=self.vertices[i])
            if frame.failed[i] != self.shown_failed[i]:
                tube.opacity = FAILED_OPACITY if frame.failed[i] else None
        self.shown_failed = frame.failed
        if self.show_beads(frame.params.show_points, frame.grab):
            self.darken()

    def darken(self) -> None:
        """Draw ropes and beads as on a dark floor for the browsers that have one."""
        for number, client in self.server.get_clients().items():
            if number in self.dark:
                self.set_dark(client, True)

    def set_dark(self, client: viser.ClientHandle, dark: bool) -> None:
        """Draw ropes and beads as on a dark floor, or light again, for one browser. The nodes stay the server's."""
        for i, tube in enumerate(self.tubes):
            update_node(client, tube.name, color=material_colour(i, dark=dark))
        update_node(client, self.beads.name, batched_colors=self.with_grabbed(self.bead_colours(dark=dark)))

    def remove(self) -> None:
        """Remove everything from the scene."""
        super().remove()
        self.labels.remove()


class RaceView(RopesView[RaceParams, RaceFrame, RaceReadings]):
    """Draws `RaceFrame`s."""

    FIELD_OF_VIEW = 0.06  # [rad], from so far away that all ropes look equally large
    WARM_UP: ClassVar[Pieces] = {"drawing": compile_tube}

    def __init__(self, server: viser.ViserServer, post: PostCommand) -> None:
        super().__init__(server, post, NEAR)
        injector_of(server)  # so that the page may draw labels by scripts of its own (`js/scene/labels.js`)
        self.references = Translucent(server, "/race/references", color=REFERENCE_COLOUR, opacity=REFERENCE_OPACITY)
        self.params: RaceParams | None = None  # that the height of a row of labels [m] is of
        self.label_row = 0.0
        self.dark: set[int] = set()  # browsers that draw on a dark floor

    def first_view(self, params: RaceParams) -> tuple[Vector, Vector]:
        """Position and target [m] of a camera that has not been moved: all ropes, as far as they swing, and labels."""
        depth, height = (params.ropes - 1) * params.spacing, shown_height(params)
        distance = 0.5 * height / math.tan(0.5 * self.FIELD_OF_VIEW) + 0.5 * BEARING[0] * depth
        above = LABEL_SHARE * height * label_rows(params.ropes)
        x, y, z = target = 0.0, 0.0, ROOT[2] + above - 0.5 * height
        flat = distance * math.cos(ELEVATION)
        return (x + BEARING[1] * flat, y - BEARING[0] * flat, z + distance * math.sin(ELEVATION)), target

    def draw(self, frame: RaceFrame) -> RacingRopes:
        """A drawing for the number of ropes and points of a frame."""
        return RacingRopes(self.server, frame, self.label_row, self.dark)

    def show(self, frame: RaceFrame) -> None:
        """Assign a new frame to the handles; call it where a picture is handed over as one."""
        if frame.params is not self.params:
            self.params, self.label_row = frame.params, LABEL_SHARE * shown_height(frame.params)
        self.show_ropes(frame, frame.ropes)
        self.ropes.labels.show(frame, self.label_row)
        if frame.references is None:
            self.references.hide()
        else:
            tubes = [self.ropes.tube.vertices(points, REFERENCE_RADIUS) for points in frame.references]
            self.references.show(np.concatenate(tubes), self.ropes.all_faces)

    def figures(self, snapshot: RaceSnapshot) -> str:
        """The ropes that are nearest to the reference and farthest from it."""
        return errors_line(snapshot.readings)

    def marks(self, snapshot: RaceSnapshot) -> dict[str, str]:
        """Parameter -> the line under its control: the largest step of rope 1 that is stable."""
        gauge = snapshot.readings.results[0].gauge
        return {"time_step": step_mark(gauge.critical_step, gauge.accurate_step, gauge.landed_step)}

    def notes(self, snapshot: RaceSnapshot) -> dict[str, str]:
        """The table of results."""
        return {"Results": results_table(snapshot.readings)}

    def set_dark(self, client: viser.ClientHandle, dark: bool) -> None:
        """Draw sky, floor and ropes dark, or light again, for one browser."""
        super().set_dark(client, dark)
        (self.dark.add if dark else self.dark.discard)(client.client_id)
        if self.ropes is not None:
            self.ropes.set_dark(client, dark)


VIEW = RaceView
