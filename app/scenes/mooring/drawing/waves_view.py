"""A staff beside the body, by which one sees how high the waves are."""

import viser

from app.messages import Vector
from app.render.staff import WaveStaff
from app.scenes.mooring.arrangement import extent
from app.scenes.mooring.frame import MooringFrame

PLACE = (-0.24, 0.1)  # x, y from where the body rests, in `extent`s: beside and behind it in the first view


class WaveHeight:
    """The staff, in waves only."""

    def __init__(self, server: viser.ViserServer) -> None:
        self.server = server
        self.staff: WaveStaff | None = None

    def show(self, frame: MooringFrame) -> None:
        """Draw it for the present waves: it is made for one place and one height."""
        height, far, (x, y, _) = frame.params.wave_height, extent(frame.params), frame.rest
        place: Vector | None = (x + PLACE[0] * far, y + PLACE[1] * far, height) if height > 0.0 else None
        if self.staff is not None and self.staff.place != place:
            self.remove()
        if self.staff is None and place is not None:
            self.staff = WaveStaff(self.server, place)

    def remove(self) -> None:
        """Remove it from the scene."""
        if self.staff is not None:
            self.staff.remove()
            self.staff = None
