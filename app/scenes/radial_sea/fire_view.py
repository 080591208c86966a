"""Fire, smoke and the jet's oil as soft blobs: viser's Gaussian splats. One buffer is sent for each frame.

A splat is eight words: centre (3 x float32), one of the renderer's own, covariance (6 x float16), colour (4 x uint8).
"""

import numpy as np
import viser

from app.render.node_arrays import set_arrays

MAX_FIRE_SPLATS, MAX_OIL_SPLATS = 2000, 900
HEAT = (0.0, 0.15, 0.26, 0.34, 0.5, 0.8, 1.0)  # of a parcel, at which it has the colour below
HEAT_COLOURS = (
    (52, 48, 46),
    (38, 34, 32),
    (60, 32, 20),
    (214, 62, 10),
    (255, 132, 22),
    (255, 196, 70),
    (255, 246, 190),
)
SPLAT_SHARE = 0.3  # standard deviation of a splat of smoke over the radius of the plume
FADED_SHARE = 0.4  # of the plume's length in time, in which its end fades out
FULL_SMOKE_RADIUS = 30.0  # [m] of the plume, from which on smoke is thinner
SUN_STRENGTHS, SMOKE_LIGHT = (0.5, 2.5), (0.4, 1.0)  # night and dawn, and the share of its colours that smoke has then
OIL_COLOUR = (34, 22, 12)
OIL_WIDTH, OIL_HEIGHT = 0.34, 0.55  # [m] standard deviations of a splat of oil
OIL_OPACITY = 0.9


class Flames:
    """One node of splats; those not in use are transparent."""

    def __init__(self, server: viser.ViserServer, name: str) -> None:
        n = MAX_FIRE_SPLATS + MAX_OIL_SPLATS
        covariances = np.tile(0.01 * np.eye(3, dtype=np.float32), (n, 1, 1))
        self.handle = server.scene.add_gaussian_splats(
            name, np.zeros((n, 3)), covariances, np.zeros((n, 3)), np.zeros((n, 1)), visible=False
        )
        self.buffer = np.array(self.handle.buffer)
        random = np.random.default_rng(0)
        self.variety = np.stack([random.uniform(0.5, 1.3, MAX_FIRE_SPLATS), random.uniform(0.55, 1.5, MAX_FIRE_SPLATS)])

    def show(self, fire: tuple[np.ndarray, np.ndarray] | None, jet: np.ndarray | None, sun: float) -> None:
        """Draw a fire, positions (3, n) [m] with heat, age over life, radius of the plume [m] and age over the longest
        life (4, n), and a jet, positions (m, 3) [m]. sun: its strength, by which smoke is lit.
        """
        visible = fire is not None or jet is not None
        if self.handle.visible != visible:
            self.handle.visible = visible
        if not visible:
            return
        self.buffer[:, 7] = 0
        if fire is not None:
            every = max(1, -(-fire[0].shape[1] // MAX_FIRE_SPLATS))
            x, (heat, age, spread, along) = fire[0][:, ::every].T, fire[1][:, ::every]
            rgb = np.stack([np.interp(heat, HEAT, [c[i] for c in HEAT_COLOURS]) for i in range(3)], axis=1)
            # Flames are dense and small. Smoke is as wide as its plume, thinner with its width, and fades in the end;
            # each splat has a size and a shade of its own, so that the outline is ragged.
            size, shade = self.variety[:, : len(x)]
            light = np.interp(sun, SUN_STRENGTHS, SMOKE_LIGHT)
            rgb = np.where((heat < HEAT[2])[:, None], rgb * (light * shade)[:, None], rgb)
            opacity = np.interp(heat, (0.0, 0.1, 0.3, 1.0), (0.55, 0.6, 0.6, 0.8))
            opacity *= np.minimum(1.0, FULL_SMOKE_RADIUS / np.maximum(spread, 1.0))
            opacity *= np.clip(4.0 * (1.0 - age), 0.0, 1.0) * np.clip((1.0 - along) / FADED_SHARE, 0.0, 1.0)
            width = size * SPLAT_SHARE * spread * np.interp(heat, (0.0, 0.3, 1.0), (1.0, 0.9, 0.7))
            height = width * np.interp(heat, (0.0, 0.3, 1.0), (0.9, 1.3, 2.0))
            self.put(0, x, width, height, rgb, np.where(age < 0.0, 0.0, opacity))
        if jet is not None and len(jet):
            chosen = jet[:: max(1, -(-len(jet) // MAX_OIL_SPLATS))]
            n = len(chosen)
            colours, opacity = np.tile(OIL_COLOUR, (n, 1)), np.full(n, OIL_OPACITY)
            self.put(MAX_FIRE_SPLATS, chosen, np.full(n, OIL_WIDTH), np.full(n, OIL_HEIGHT), colours, opacity)
        set_arrays(self.handle, buffer=self.buffer)

    def put(
        self, start: int, x: np.ndarray, width: np.ndarray, height: np.ndarray, rgb: np.ndarray, opacity: np.ndarray
    ) -> None:
        """Set splats from `start` on: centres (n, 3), standard deviations across and upwards (n,) [m]."""
        n = len(x)
        rows = self.buffer[start : start + n]
        rows[:, :3] = np.ascontiguousarray(x, np.float32).view(np.uint32)
        cov = np.zeros((n, 6), np.float16)
        cov[:, 0] = cov[:, 3] = width**2
        cov[:, 5] = height**2
        rows[:, 4:7] = cov.view(np.uint32)
        rgba = np.empty((n, 4), np.uint8)
        rgba[:, :3] = np.clip(rgb, 0, 255)
        rgba[:, 3] = np.clip(255.0 * opacity, 0, 255)
        rows[:, 7] = rgba.view(np.uint32)[:, 0]
