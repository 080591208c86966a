"""The square sea as pictures that tile: displacement and foam, as OpenEXR in metres or as PNG with a scale.

A picture has one pixel for each point of the solved grid. Column i, counted from the left, is x = i length/size; row j,
counted from the bottom, is y = j length/size. The point after the last is the first again.
"""

import dataclasses
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import imageio.v3 as imageio
import numpy as np
from numpy.typing import NDArray

from app.scenes.square_sea.parameters import SquareSeaParams, solved_points
from app.scenes.square_sea.scene import SquareSeaScene
from app.study.export.sequence import file_name

FORMATS = ("exr", "exr16", "png")
MAX_FOAM_INTERVAL = 1 / 30  # [s] between two moments at which foam is made: crests pass between rarer ones
ZERO, LEVELS = 32768, 32767  # of a 16-bit picture: the pixel that stands for 0, and the pixels above it
PARTS = ("x", "y", "z")


def picture(field: NDArray[Any]) -> NDArray[Any]:
    """A field [i, j] of x and y as the rows of a picture, from the top down."""
    return np.ascontiguousarray(np.flip(np.swapaxes(field, 0, 1), axis=0))


class SeaPictures:
    """One run of the square sea; see `app.study.export.sequence.Sequence`."""

    def __init__(self, params: SquareSeaParams, interval: float, form: str) -> None:
        """interval: [s] between two frames. form: one of FORMATS."""
        self.form = form
        self.steps = math.ceil(interval / MAX_FOAM_INTERVAL * (1.0 - 1e-9))  # between two frames
        self.step = interval / self.steps
        # Foam on the grid of the displacement, and nothing of what only the panel shows.
        panel = {"statistics": False, "plot_wave_gauge": False, "plot_wave_spectrum": False}
        self.params = dataclasses.replace(params, mesh=params.size, **panel)
        self.passes = 2 if form == "png" else 1
        self.length, self.size = params.length, solved_points(params)
        self.bytes_per_frame = 4 * self.size**2 * (2 if form in ("png", "exr16") else 4)
        self.unit_per_pixel = dict.fromkeys(PARTS, 0.0)  # [m], of a PNG

    def frames(self, start: float, count: int) -> Iterator[tuple[float, NDArray[np.float32], NDArray[np.float32]]]:
        """(time [s], displacement (size, size, 3) [m], foam (size, size) 0 to 1) of each frame."""
        scene = SquareSeaScene(self.params, step=self.step)
        until = math.ceil(start / self.step * (1.0 - 1e-9))
        for _ in range(until):
            scene.advance(1)
            scene.frame()
        for number in range(count):
            for _ in range(self.steps if number else 0):
                scene.advance(1)
                scene.frame()
            foam = scene.frame().foam
            fields = scene.fields()
            displacement = np.zeros((self.size, self.size, 3), np.float32)
            if fields.displacement is not None:
                displacement[..., :2] = fields.displacement
            displacement[..., 2] = np.float32(self.params.amplitude) * fields.height
            yield scene.time, displacement, foam

    def write(self, folder: Path, start: float, count: int) -> Iterator[float | None]:
        """Write the pictures. Of PNG the run is made twice, as the scale is that of the largest value of all."""
        if self.form == "png":
            largest = np.zeros(3)
            for _, displacement, _ in self.frames(start, count):
                largest = np.maximum(largest, np.abs(displacement).max(axis=(0, 1)))
                yield None
            self.unit_per_pixel = dict(zip(PARTS, (largest / LEVELS).tolist(), strict=True))
        for number, (time, displacement, foam) in enumerate(self.frames(start, count), 1):
            if self.form == "png":
                self.write_png(folder, number, displacement, foam)
            else:
                write_exr(folder / file_name("displacement", number, "exr"), "RGB", self.rounded(picture(displacement)))
                write_exr(folder / file_name("foam", number, "exr"), "Y", self.rounded(picture(foam)))
            yield time

    def rounded(self, pixels: NDArray[np.float32]) -> NDArray[Any]:
        """Pixels in the precision of the format."""
        return pixels.astype(np.float16) if self.form == "exr16" else pixels

    def write_png(
        self, folder: Path, number: int, displacement: NDArray[np.float32], foam: NDArray[np.float32]
    ) -> None:
        """Write four grey pictures of 16 bits."""
        for part, name in enumerate(PARTS):
            unit = self.unit_per_pixel[name]
            levels = displacement[..., part].astype(np.float64) / unit if unit > 0.0 else np.zeros(foam.shape)
            pixels = picture(np.rint(levels) + ZERO).astype(np.uint16)
            imageio.imwrite(folder / file_name(f"displacement_{name}", number, "png"), pixels)
        pixels = picture(np.rint(foam.astype(np.float64) * 65535.0)).astype(np.uint16)
        imageio.imwrite(folder / file_name("foam", number, "png"), pixels)

    def about(self) -> dict[str, Any]:
        """Size, places and units."""
        meaning = {
            "displacement": "x, y (horizontal) and z (up) of the water from its rest position",
            "foam": "fraction of foam, 0 to 1",
        }
        if self.form == "png":
            scales = {name: {"unit": "m", "zero": ZERO, "step": unit} for name, unit in self.unit_per_pixel.items()}
            files = {f"displacement_{name}.####.png": scale for name, scale in scales.items()}
            files["foam.####.png"] = {"unit": "0 to 1", "zero": 0, "step": 1.0 / 65535.0}
            value = "(pixel - zero) step"
        else:
            kind = "16-bit float" if self.form == "exr16" else "32-bit float"
            files = {
                "displacement.####.exr": {"unit": "m", "channels": {"R": "x", "G": "y", "B": "z"}, "type": kind},
                "foam.####.exr": {"unit": "0 to 1", "channels": {"Y": "foam"}, "type": kind},
            }
            value = "pixel"
        return {
            "meaning": meaning,
            "files": files,
            "value": value,
            "size": self.size,
            "length": self.length,
            "length_unit": "m",
            "pixels": "column i from the left: x = i length/size; row j from the bottom: y = j length/size; it tiles",
        }


def write_exr(path: Path, channels: str, pixels: NDArray[Any]) -> None:
    """Write pixels (rows, columns) or (rows, columns, 3), float32 or float16, as OpenEXR. Raises OSError."""
    import OpenEXR

    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    try:
        OpenEXR.File(header, {channels: pixels}).write(str(path))
    except RuntimeError as error:
        raise OSError(f"{path.name}: {error}") from None
