"""The kinds of solves of a simulation thread, and the commands that cancel them."""

from typing import Literal, NamedTuple


class Activity(NamedTuple):
    """One solve. A new beginning of the scene cancels each of them."""

    kind: Literal["none", "steps", "beginning", "forces", "frame"]
    may_end: bool = False  # cancelled by all that asks for another solve, too


NOTHING = Activity("none")
STEPS = Activity("steps", may_end=True)  # the scene's frame is that of a whole step, also in the middle of one
BEGINNING = Activity("beginning")  # where it fails, there is no scene to run
OTHER_FORCES = Activity("forces")  # the scene's parameters are the old or the new ones
