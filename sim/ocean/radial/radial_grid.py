"""A polar grid of fixed topology, dense in the middle and out to the horizon, for seas seen from one place."""

import math

import numpy as np

from sim.numerics.root import narrowed
from sim.validation import argument_error, check_number, check_positive, is_whole_number

LAWS = ("geometric", "power")
FADE = (2.0, 4.0)  # a wave is drawn in full from the second number of cells a wavelength, not at all below the first


class RadialGrid:
    """Rings of `spokes` points about a centre: ring r is points r spokes to (r + 1) spokes.

    The last point is the centre; `start` (rings + 2,) cuts the points into bands: the rings, then the centre alone.
    `ring_law`: exponent of the radii (0: geometric), the first radius [m], ratio of the steps from ring to ring.
    """

    def __init__(
        self,
        rings: int = 128,
        spokes: int = 128,
        inner: float = 0.4,
        radius: float = 4000.0,
        law: str = "geometric",
        power: float = 2.0,
    ) -> None:
        """inner, radius [m] of the first and the last ring.

        law: "geometric", where the steps from ring to ring grow by a constant factor, or "power", r ~ index^power as
        in the lab (inner is then not used). Raises ValueError for values that are not allowed.
        """
        for name, value in (("rings", rings), ("spokes", spokes)):
            if not is_whole_number(value) or not 3 <= value <= 4096:
                raise argument_error(name, value, "a whole number from 3 to 4096")
        if law not in LAWS:
            raise argument_error("law", law, "one of " + ", ".join(LAWS))
        radius = check_positive("radius", radius, "m")
        check_number("inner", inner, "m", 1e-3, radius / rings)
        check_number("power", power, "", 1.0, 8.0)
        self.rings, self.spokes = int(rings), int(spokes)
        index = np.arange(1, rings + 1)
        if law == "power":
            self.radii = radius * (index / rings) ** power
            self.ring_law = (float(power), float(self.radii[0]), 1.0)
        else:
            # r_i = inner (q^i - 1)/(q - 1), so that steps grow by q; q from r_n = radius
            q = step_ratio(radius / inner, rings)
            self.radii = inner * index if q - 1.0 < 1e-9 else inner * (q**index - 1.0) / (q - 1.0)
            self.ring_law = (0.0, float(inner), float(q))
        angle = np.arange(spokes) * (2.0 * math.pi / spokes)
        ring = self.radii[:, None]
        # Every other ring is turned by half a spoke, which makes triangles nearly equilateral.
        turned = angle + (np.arange(rings) % 2)[:, None] * (math.pi / spokes)
        self.x = np.append((ring * np.cos(turned)).ravel(), 0.0).astype(np.float32)
        self.y = np.append((ring * np.sin(turned)).ravel(), 0.0).astype(np.float32)
        gap = np.diff(self.radii, prepend=0.0)
        around = self.radii * (2.0 * math.pi / spokes)
        ring_spacing = np.maximum(gap, around)
        self.spacing = np.append(ring_spacing, ring_spacing[0])  # [m] of each band, the coarser of its two
        self.start = np.append(np.arange(rings + 1) * spokes, rings * spokes + 1).astype(np.uint64)
        self.faces = self.make_faces()

    def __len__(self) -> int:
        """Number of points."""
        return len(self.x)

    def make_faces(self) -> np.ndarray:
        """Triangles (m, 3), counterclockwise from above."""
        n, rings = self.spokes, self.rings
        j = np.arange(n)
        after = (j + 1) % n
        centre = np.full(n, rings * n)
        faces = [np.stack([centre, j, after], axis=1)]
        for r in range(rings - 1):
            a, b, c, d = r * n + j, r * n + after, (r + 1) * n + j, (r + 1) * n + after
            if r % 2 == 0:  # the next ring is ahead by half a spoke
                faces += [np.stack([a, c, b], axis=1), np.stack([b, c, d], axis=1)]
            else:
                faces += [np.stack([a, c, d], axis=1), np.stack([a, d, b], axis=1)]
        return np.concatenate(faces).astype(np.uint32)

    def weights(self, k: np.ndarray) -> np.ndarray:
        """Factor (rings + 1, n), 0 to 1, on waves of wavenumber k (n,) [rad/m] in each band: fades unresolved ones."""
        cells = 2.0 * math.pi / np.maximum(k, 1e-30) / self.spacing[:, None]
        low, high = FADE
        u = np.clip((cells - low) / (high - low), 0.0, 1.0)
        return u * u * (3.0 - 2.0 * u)


def step_ratio(ratio: float, count: int) -> float:
    """q >= 1 with (q^count - 1)/(q - 1) = ratio >= count."""

    def excess(q: float) -> float:
        total = count if q - 1.0 < 1e-12 else math.expm1(min(count * math.log(q), 700.0)) / (q - 1.0)
        return math.log(total / ratio)

    return float(narrowed(excess, 1.0, 64.0)[1])
