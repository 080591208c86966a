"""The floor under rope and cloth: an endless plane, with a grid on demand."""

import viser

Colour = tuple[int, int, int]


class Ground:
    """viser's grid as a floor."""

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
        """floor: whether it is there; grid: whether its lines are."""
        if (floor, grid) == self.shown:
            return
        self.shown = floor, grid
        self.grid.visible = floor
        self.grid.cell_thickness = self.grid.section_thickness = 1.0 if grid else 0.0
