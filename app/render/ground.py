"""The floor under rope and cloth: an infinite plane, with grid lines where they are wanted."""

import viser

Colour = tuple[int, int, int]  # sRGB, 0 to 255


class Ground:
    """viser's grid as a floor. Colours of the plane, of the lines every 0.25 m, and of those every 1 m."""

    def __init__(self, server: viser.ViserServer, plane: Colour, cells: Colour, sections: Colour) -> None:
        self.shown: tuple[bool, bool] | None = None
        self.grid = server.scene.add_grid(
            "/floor",
            width=24.0,
            height=24.0,
            infinite_grid=True,
            cell_size=0.25,
            section_size=1.0,
            cell_color=cells,
            section_color=sections,
            plane_color=plane,
            plane_opacity=1.0,
            fade_distance=26.0,
            shadow_opacity=0.3,
        )

    def show(self, floor: bool, grid: bool) -> None:
        """floor: whether to draw the plane; grid: whether to draw its lines."""
        if (floor, grid) == self.shown:
            return
        self.shown = floor, grid
        self.grid.visible = floor
        self.grid.cell_thickness = self.grid.section_thickness = 1.0 if grid else 0.0
