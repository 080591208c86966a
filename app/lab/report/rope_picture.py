"""A student's rope as a small picture: it falls from the level by the student's functions, beside the reference's."""

from types import ModuleType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from app.formats.formatting import metres
from app.lab.process.rope_march import FILE, Forces, Functions, Segment, march
from app.lab.process.runner import BUSY, RunError, Runner
from app.lab.student.live_net import ROPE
from app.lab.student.saved import Saved
from app.render.markup.html import Html, fill, join

POINTS, LINK = 10, 0.2  # of the rope, and length of a link at rest [m]
TOP = 2.0  # height of the root [m]
POSES, POSE_STEPS, STEP = 5, 48, 1 / 240  # pictures over each other, steps to the next, length of a step [s]
# Material of the lab code's rope in air, without floor and sphere.
FORCES = Forces(1.0, 800.0, 7.0, 1.0, LINK, 10.0)
METHODS = {"step_rk4": "rk4", "step_leapfrog": "leapfrog", "step_euler": "explicit_euler"}  # the first that is begun
WIDTH, HEIGHT = 132, 80  # [px]
SCALE = 30.0  # [px/m]
FAR = 10.0  # [m] from the origin, beyond which a rope has flown apart
SAME = 1e-6  # [m] below which two ropes are the same
NOT_DRAWN = "Not drawn yet: the machine is busy."
REFERENCE_COLOUR, OWN_COLOUR = "#8a939c", "#1c6aa8"


class RopePicture(NamedTuple):
    """A fall of the rope. own: (poses, n, 3) [m], possibly fewer. text: its state in words; "" if nothing is begun."""

    own: NDArray[np.float64] = np.zeros((0, POINTS, 3))
    reference: NDArray[np.float64] = np.zeros((0, POINTS, 3))
    text: str = ""


def start() -> tuple[NDArray[np.float64], NDArray[np.float64], list[Segment]]:
    """Positions and velocities (n, 3) of a level rope at rest, and the segments between poses."""
    x = np.zeros((POINTS, 3))
    x[:, 0], x[:, 2] = LINK * np.arange(POINTS), TOP
    return x, np.zeros_like(x), [Segment(POSE_STEPS, STEP, FORCES, np.zeros((0, 4, 3)))] * POSES


def rope_picture(runner: Runner, saved: Saved) -> RopePicture:
    """The rope of a version of the student's files, by the first of RK4, leapfrog and Euler that is begun."""
    method = next((name for step, name in METHODS.items() if step in saved.begun), "rk4")
    own = ROPE.own_of(saved.begun, method, sphere=False)
    if not own:
        return RopePicture()
    step = ROPE.step_of(method)
    reference = reference_poses(step)
    try:
        motion = runner.march(own, step, *start())
    except RunError as error:
        text = NOT_DRAWN if error.kind == BUSY else "Does not run."
        return RopePicture(reference=reference, text=text)
    inside = int(np.logical_and.accumulate((np.abs(motion.x) < FAR).all(axis=(1, 2))).sum())
    if inside < POSES:
        return RopePicture(
            motion.x[:inside], reference, f"Flies apart within {(inside + 1) * POSE_STEPS * STEP:.1f} s."
        )
    apart = float(np.linalg.norm(motion.x - reference, axis=2).max())
    return RopePicture(
        motion.x, reference, "Matches the reference." if apart < SAME else f"{metres(apart, 2)} from the reference."
    )


def reference_poses(step: str) -> NDArray[np.float64]:
    """Poses (poses, n, 3) [m] of the rope by the reference solutions."""
    return march(Functions(ModuleType(FILE), (), step, {}), *start()).x


def svg(picture: RopePicture) -> Html:
    """The picture: the reference grey, the student's poses the darker the later, the last one with its points."""
    lines = [pose(shape, REFERENCE_COLOUR, 0.9, dash="3 2") for shape in picture.reference[-1:]]
    count = max(1, len(picture.own))
    lines += [pose(shape, OWN_COLOUR, (i + 1) / count) for i, shape in enumerate(picture.own)]
    dots = join(
        fill('<circle cx="{:.1f}" cy="{:.1f}" r="1.7" fill="{}"/>', *place, OWN_COLOUR)
        for place in places(picture.own[-1])
    ) if len(picture.own) else Html()  # fmt: skip
    return fill(
        '<svg class="rope" viewBox="0 0 {w} {h}" width="{w}" height="{h}" role="img"><title>{}</title>{}{}</svg>',
        picture.text, join(lines), dots, w=WIDTH, h=HEIGHT,
    )  # fmt: skip


def places(shape: NDArray[np.float64]) -> list[tuple[float, float]]:
    """Points (n, 3) [m] as places in the picture [px], or beyond its edge."""
    x, y = WIDTH / 2 - 30.0 + SCALE * shape[:, 0], 8.0 + SCALE * (TOP - shape[:, 2])
    return list(zip(x.tolist(), y.tolist(), strict=True))


def pose(shape: NDArray[np.float64], colour: str, opacity: float, dash: str = "none") -> Html:
    """One shape of the rope as a line."""
    points = " ".join(f"{x:.1f},{y:.1f}" for x, y in places(shape))
    return fill(
        '<polyline points="{}" fill="none" stroke="{}" stroke-width="1.6" stroke-opacity="{:.2f}" '
        'stroke-dasharray="{}"/>',
        points, colour, opacity, dash,
    )  # fmt: skip
