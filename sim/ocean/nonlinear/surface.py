"""The surface of nonlinear waves at one time, with the fields of `sim.ocean.tile.surface`."""

import numpy as np

from sim.ocean.nonlinear.modes import Modes
from sim.ocean.nonlinear.padded_transforms import PaddedTransforms
from sim.ocean.tile.surface import field


class NonlinearSurface:
    """Fields (n, m) of places, which do not move: there is no displacement. Each is computed when first read."""

    def __init__(self, modes: Modes, transforms: PaddedTransforms, eta: np.ndarray, t: float) -> None:
        """eta: spectrum (rows, columns) of the elevation."""
        self.modes, self.transforms, self.eta, self.t = modes, transforms, eta, t
        self.fields: dict[str, np.ndarray] = {}

    @field
    def height(self) -> np.ndarray:
        """Elevation (n, m) [m]."""
        return self.transforms.field_of(self.eta)

    @property
    def mean_height(self) -> float:
        """Mean [m] of `height`."""
        return float(self.eta[0, 0].real)

    @field
    def displacement(self) -> np.ndarray:
        """(n, m, 2) zeros [m]."""
        return np.zeros((*self.modes.size, 2))

    @field
    def slope(self) -> np.ndarray:
        """Slope (n, m, 2) along x and y."""
        ky = self.modes.ky[:, None]
        return np.stack([self.transforms.field_of(1j * k * self.eta) for k in (self.modes.kx, ky)], axis=-1)

    @field
    def jacobian(self) -> np.ndarray:
        """1 minus the field of k eta, (n, m): by how much the motion of the water presses the surface together.

        To first order that is the Jacobian of the displacement that linear waves are drawn with, and at a crest k eta
        is the downward acceleration over g, by which waves break (Longuet-Higgins 1969, Proc. R. Soc. Lond. A 310:151).
        """
        return 1.0 - self.transforms.field_of(self.modes.k * self.eta)
