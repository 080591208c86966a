"""The pendulum as a rod and a ball."""

from collections.abc import Callable

import numpy as np
import viser

from app.messages import Command, Snapshot
from app.render.surroundings import Surroundings, set_dark
from app.scenes.contract import SceneView
from app.scenes.pendulum.parameters import PendulumParams
from app.scenes.pendulum.scene import PendulumFrame, PendulumReadings

PIVOT = (0.0, 0.0, 2.0)  # [m]


class PendulumView(SceneView[PendulumParams, PendulumFrame, PendulumReadings]):
    """Draws `PendulumFrame`s."""

    FIELD_OF_VIEW = 1.0  # [rad]
    CAMERA = (0.5, -4.0, 2.0), (0.0, 0.0, 1.3)  # position, target [m]

    def __init__(self, server: viser.ViserServer, post: Callable[[Command], None]) -> None:
        self.surroundings = Surroundings(server)
        self.rod = server.scene.add_line_segments(
            "/rod", np.zeros((1, 2, 3), np.float32), colors=(90, 90, 90), thickness=0.02
        )
        self.bob = server.scene.add_icosphere("/bob", radius=0.1, color=(176, 58, 72))

    def show(self, frame: PendulumFrame) -> None:
        bob = np.add(PIVOT, frame.bob)
        self.rod.points = np.array([[PIVOT, bob]], np.float32)
        self.bob.position = tuple(bob.tolist())
        self.surroundings.show(True, frame.grid)

    def figures(self, snapshot: Snapshot) -> str:
        return f"small swings take <b>{snapshot.readings.period:.2f} s</b>"

    def set_dark(self, client: viser.ClientHandle, dark: bool) -> None:
        set_dark(client, dark)


VIEW = PendulumView
