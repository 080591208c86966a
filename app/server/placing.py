"""Placing of cameras, by presets, links, undos and divergences; otherwise each camera is its browser's own."""

from typing import TYPE_CHECKING

from app.messages import BaseParams, Vector
from app.panel.settings import Placing
from app.render.cameras import ClientCamera, client_cameras, fit_cameras, place_cameras, place_client_camera
from app.scenes.contract import AnySnapshot, AnyView

if TYPE_CHECKING:
    import viser


class CameraPlacing:
    """Places the cameras of one scene, on the viewer's thread, after the picture of the scene."""

    def __init__(self, server: "viser.ViserServer", view: AnyView, params: BaseParams) -> None:
        """Place all cameras for the first view of these parameters."""
        self.server, self.view = server, view
        self.run = 0  # number of the shown run
        self.placed: Placing | None = None  # the last one carried out
        self.before: dict[int, ClientCamera] = {}  # cameras before they were fitted
        self.fitted: tuple[ClientCamera, ...] = ()  # and after that
        place_cameras(server, *view.first_view(params), view.FIELD_OF_VIEW)

    def update(self, snapshot: AnySnapshot, placing: Placing | None) -> None:
        """Place the cameras for a picture. placing: requested by the settings, once its run is shown."""
        status = snapshot.status
        if status.replayed is not None and status.state.replays:
            self.fit(snapshot.params, status.replayed)
        if status.run.number != self.run:
            self.run = status.run.number
            self.end_fitting()
        if placing is None or placing is self.placed or placing.act != status.run.placed:
            return
        self.placed = placing
        if placing.first_view:
            place_cameras(self.server, *self.view.first_view(snapshot.params), self.view.FIELD_OF_VIEW)
        for camera in placing.cameras:
            place_client_camera(self.server, camera)

    def fit(self, params: BaseParams, corners: tuple[Vector, Vector]) -> None:
        """Show the last moments of a run that diverged. corners: of a box around them [m]."""
        self.before = self.before or {camera.client: camera for camera in client_cameras(self.server)}
        fit_cameras(self.server, self.view.first_view(params), self.view.FIELD_OF_VIEW, corners)
        self.fitted = client_cameras(self.server)

    def end_fitting(self) -> None:
        """Restore the fitted cameras that nobody has moved since."""
        for camera in set(self.fitted) & set(client_cameras(self.server)):
            place_client_camera(self.server, self.before.get(camera.client))
        self.before, self.fitted = {}, ()
