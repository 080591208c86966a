"""Common parts of the drawings of rope and race: sky, floor, the arrows at the root, and the line of a drag."""

import numpy as np
import viser

from app.messages import Vector
from app.render.cameras import NEAR
from app.render.colormap import SCALE, set_tube_colours
from app.render.dragging import PullLine
from app.render.gizmo import Gizmo
from app.render.meshes import SIDES, smooth_line, sweep
from app.render.surroundings import Surroundings
from app.scenes.contract import PostCommand
from app.scenes.springs.drag import PullFrame
from app.scenes.springs.rope_parameters import ROOT

ROOT_ARROW_LENGTH = 0.34  # [m]


class RopeSurroundings:
    """The handles of all that is drawn around ropes."""

    def __init__(self, server: viser.ViserServer, post: PostCommand, near: float = NEAR) -> None:
        """near: [m] from the camera, where the picture begins."""
        self.surroundings = Surroundings(server, near)
        self.root = Gizmo(server, post, "root", ROOT_ARROW_LENGTH, position=ROOT)
        self.pull = PullLine(server)

    def show(self, floor: bool, grid: bool, root: Vector | None, pull: PullFrame | None, points: np.ndarray) -> None:
        """Assign changes. root: [m] of its arrows; None hides them. points: (n, 3) as drawn [m]; the pull names one."""
        self.surroundings.show(floor, grid)
        self.root.show(root)
        if pull is None:
            self.pull.show(None)
        else:
            self.pull.show((points[pull.particle], pull.target), pull.load)


def compile_tube() -> None:
    """Call the kernels that draw a coloured tube."""
    line, vertices = np.zeros((3, 3)), np.zeros((3 * SIDES + 2, 3), np.float32)
    smooth_line(np.zeros((2, 3), np.float32), 2, line)
    sweep(line, 1.0, SIDES, vertices)
    set_tube_colours(np.ones(1, np.float32), 2, 1.0, SCALE, SIDES, vertices)
