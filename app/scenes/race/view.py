"""A race as drawn: a tube a rope in its own colour, the references as translucent ones, a flag on each."""

from collections.abc import Callable
from typing import Any

import numpy as np
import viser

from app.render.colormap import PALETTE, rgb
from app.render.meshes import ball, smooth_line, sweep, tube_faces
from app.scenes.race.report import RaceFrame
from app.scenes.rope.parameters import THICKNESS

RINGS = 90  # about as many rings as a rope is drawn with
SIDES = 8
RADIUS = 0.75 * THICKNESS
CORE = 0.9 * RADIUS  # [m] of the reference, which is hidden in a rope that is where it should be
GHOST_COLOUR = (70, 76, 88)
SHADE = 0.6  # of a colour's numbers, so that lit from all sides it looks as it does in the charts
FADED = 0.35  # opacity of a rope that is out
POLE = 0.16  # [m] from a root to its label, and between the heights of labels, lest they overlap


def shaded(rope: int) -> tuple[int, int, int]:
    """The colour of a rope's material."""
    red, green, blue = (round(SHADE * part) for part in rgb(PALETTE[rope]))
    return red, green, blue


class RaceDrawing:
    """The handles of one race, made for its ropes and points, then assigned to."""

    def __init__(self, server: viser.ViserServer, race: RaceFrame, drag: Callable[[Any], Any]) -> None:
        """drag: what a drag of a bead calls with viser's event, whose instance counts along rope after rope."""
        self.server = server
        self.ropes, n, _ = race.ropes.shape
        self.shape = race.ropes.shape
        self.between = max(1, RINGS // (n - 1))
        rings = (n - 1) * self.between + 1
        self.line = np.zeros((rings, 3))
        self.each = rings * SIDES + 2
        faces = tube_faces(rings, SIDES)
        scene = server.scene
        self.tubes = [
            scene.add_mesh_simple(
                f"/race/rope_{i + 1}", self.tube(race.ropes[i], RADIUS), faces, color=shaded(i), side="double"
            )
            for i in range(self.ropes)
        ]
        self.cores = np.zeros((self.ropes * self.each, 3), np.float32)
        self.ghosts = scene.add_mesh_simple(
            "/race/ghosts",
            self.cores,
            np.concatenate([faces + i * self.each for i in range(self.ropes)]).astype(np.uint32),
            color=GHOST_COLOUR,
            opacity=0.4,
            cast_shadow=False,
            visible=False,
        )
        points = race.ropes.reshape(-1, 3)
        # Colours of instances are taken as linear ones.
        colours = np.repeat([255.0 * (np.array(shaded(i)) / 255.0) ** 2.2 for i in range(self.ropes)], n, axis=0)
        self.beads = scene.add_batched_meshes_simple(
            "/race/points",
            *ball(6),
            batched_wxyzs=np.tile([1.0, 0.0, 0.0, 0.0], (len(points), 1)),
            batched_positions=points,
            batched_scales=np.full(len(points), min(1.5 * THICKNESS, 0.3 / n + 0.8 * THICKNESS), np.float32),
            batched_colors=colours.astype(np.uint8),
            lod="off",
        )
        self.beads.on_drag("left")(drag)
        self.poles = scene.add_line_segments(
            "/race/poles",
            self.flags(race),
            colors=np.repeat([[rgb(colour)] for colour in PALETTE[: self.ropes]], 2, axis=1).astype(np.uint8),
            thickness=2.0,
            thickness_units="screen",
        )
        self.labels = [
            scene.add_label(f"/race/label_{i + 1}", text, font_screen_scale=0.8, anchor="bottom-left")
            for i, text in enumerate(race.labels)
        ]
        self.roots: np.ndarray | None = None
        self.out = (False,) * self.ropes

    def tube(self, points: np.ndarray, radius: float) -> np.ndarray:
        """(vertices, 3) of a tube along points (n, 3) [m]."""
        vertices = np.zeros((self.each, 3), np.float32)
        smooth_line(np.ascontiguousarray(points), self.between, self.line)
        sweep(self.line, radius, SIDES, vertices)
        return vertices

    def flags(self, race: RaceFrame) -> np.ndarray:
        """(ropes, 2, 3): from each root up to its label [m], the farther the higher."""
        poles = np.repeat(race.ropes[:, :1], 2, axis=1)
        poles[:, 1, 2] += POLE * (1.0 + np.arange(self.ropes))
        return poles

    def show(self, race: RaceFrame, show_points: bool) -> None:
        """Assign a new frame; call inside `server.atomic()`."""
        for i, tube in enumerate(self.tubes):
            if race.out[i] and self.out[i]:
                continue  # it is held where it was
            tube.vertices = self.tube(race.ropes[i], RADIUS)
            if race.out[i] != self.out[i]:
                tube.opacity = FADED if race.out[i] else None
        self.out = race.out
        self.ghosts.visible = race.ghosts is not None
        if race.ghosts is not None:
            for i in range(self.ropes):
                self.cores[i * self.each : (i + 1) * self.each] = self.tube(race.ghosts[i], CORE)
            self.ghosts.vertices = self.cores
        self.beads.visible = show_points
        if show_points:
            self.beads.batched_positions = race.ropes.reshape(-1, 3)
        flags = self.flags(race)
        if self.roots is None or not np.array_equal(self.roots, flags[:, 0]):
            self.roots = flags[:, 0]
            self.poles.points = flags
            for label, flag in zip(self.labels, flags, strict=True):
                label.position = tuple(flag[1])
        for label, text in zip(self.labels, race.labels, strict=True):
            if label.text != text:
                label.text = text

    def remove(self) -> None:
        """Take it all out of the scene."""
        for handle in (*self.tubes, *self.labels, self.ghosts, self.beads, self.poles):
            handle.remove()
