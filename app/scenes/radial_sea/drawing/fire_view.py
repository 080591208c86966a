"""Fire, smoke and the jet's oil as soft blobs: viser's Gaussian splats. One buffer is sent for each frame.

A splat is eight words: centre (3 x float32), one of the renderer's own, covariance (6 x float16), colour (4 x uint8).
`js/scene/smoke.js` gives splats of smoke rough edges and rounds them by the sun's light.
"""

import math

import numpy as np
import viser

from app.render.handles.viser_inside import set_arrays
from app.render.material import Material
from app.scenes.radial_sea.frame import JetParcels
from app.scenes.radial_sea.oil.well_blowout import FIRE, JET_VELOCITY, SMOKE_LIFE
from sim.particles.fire import share_left
from sim.particles.plume import soot_made

MAX_FIRE_SPLATS, MAX_OIL_SPLATS = 1500, 900
HEAT = (0.0, 0.15, 0.26, 0.34, 0.5, 0.8, 1.0)  # of a parcel, at which it has the colour below
HEAT_COLOURS = np.array([
    (104, 98, 92),
    (58, 50, 45),
    (60, 32, 20),
    (214, 62, 10),
    (255, 132, 22),
    (255, 196, 70),
    (255, 246, 190),
])  # fmt: skip
SPLAT_SHARE = 0.3  # standard deviation of a splat of smoke over the radius of the plume
THINNEST = 0.01  # [m] least radius of the plume that opacity is calculated with: at its source the radius is 0
FADED_SHARE = 0.9  # of the plume's length in time, in which its end fades out
DENSEST_SMOKE = 0.5  # opacity of a splat of smoke at most
RIM_OPACITY = 0.2  # the same at the rim of the plume, as a fraction of that in its middle
SUN_STRENGTHS, SMOKE_LIGHT = (0.5, 2.5), (0.4, 1.0)  # night and dawn, and the share of its colours that smoke has then
PLUME_PARTS = 48  # along its length, each with its own middle of the smoke
SUNNY_SIDE, GLOWING_SIDE = 0.55, (200.0, 82.0, 20.0)  # brighter by this share; colour that the flames add underneath
GLOW_REACH = 40.0  # [m] from the flames, where their light on smoke is half as strong
OIL_COLOURS = np.array([(20, 13, 8), (44, 27, 13), (96, 60, 26), (150, 132, 112)])  # thick, film, thin, in the sun
OIL_WIDTHS, OIL_LENGTHS = (0.1, 0.03), (1.5, 1.0)  # [m] standard deviations of a streak: at the nozzle, where it ends
OIL_OPACITY = 0.8, 0.4  # the same
OIL_BREAKS_UP = 1.6  # [s] after the nozzle
MIST_SHARE, MIST_WIDTH, MIST_OPACITY = 0.2, 0.7, 0.12  # of the splats of oil; [m]


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
        self.variety = np.stack(
            [random.uniform(0.5, 1.3, MAX_FIRE_SPLATS), random.uniform(0.75, 1.25, MAX_FIRE_SPLATS)]
        )
        self.oil_variety = random.uniform(0.0, 1.0, (2, MAX_OIL_SPLATS))

    def show(
        self, fire: tuple[np.ndarray, np.ndarray] | None, jet: JetParcels | None, light: Material, power: float
    ) -> None:
        """Draw a fire of this power [W], positions (3, n) [m] with heat, age over life, radius of the plume [m] and age
        over the longest life (4, n), and a jet. light: the sky's.
        """
        visible = fire is not None or jet is not None
        if self.handle.visible != visible:
            self.handle.visible = visible
        if not visible:
            return
        self.buffer[:, 7] = 0
        if fire is not None:
            self.put_fire(*fire, light, power)
        if jet is not None and len(jet.number):
            self.put_jet(jet)
        set_arrays(self.handle, buffer=self.buffer)

    def put_fire(self, position: np.ndarray, state: np.ndarray, light: Material, power: float) -> None:
        """Set the splats of flames and smoke."""
        every = max(1, -(-position.shape[1] // MAX_FIRE_SPLATS))
        x, (heat, age, spread, along) = position[:, ::every].T, state[:, ::every]
        rgb = np.stack([np.interp(heat, HEAT, shades) for shades in HEAT_COLOURS.T], axis=1)
        # Flames are dense and small. Smoke is as wide as its plume; each splat has a size and a shade of its own, so
        # that the outline is ragged.
        size, shade = self.variety[:, : len(x)]
        width = size * SPLAT_SHARE * spread * np.interp(heat, (0.0, 0.3, 1.0), (1.0, 0.9, 0.7))
        height = width * np.interp(heat, (0.0, 0.3, 1.0), (0.9, 1.3, 2.0))
        # A splat stands for its share of the soot. It is as opaque as that soot, spread over the splat, makes it.
        soot = soot_made(power) * SMOKE_LIFE / len(x)
        area = 2.0 * math.pi * (SPLAT_SHARE * np.maximum(spread, THINNEST)) ** 2
        smoke = soot / (np.maximum(share_left(along), 0.02) * area)
        opacity = np.interp(heat, (0.1, 0.3, 1.0), (0.0, 0.6, 0.8))
        opacity = np.maximum(opacity, np.minimum(1.0 - np.exp(-smoke), DENSEST_SMOKE) * (heat < HEAT[3]))
        opacity *= np.clip(4.0 * (1.0 - age), 0.0, 1.0) * np.clip((1.0 - along) / FADED_SHARE, 0.0, 1.0) ** 2
        is_smoke = heat < HEAT[2]
        if is_smoke.any():
            bright = np.interp(light.sun_strength, SUN_STRENGTHS, SMOKE_LIGHT)
            off = from_middle(x, along) / np.maximum(spread, 1.0)[:, None]
            sun = np.asarray(light.sun_direction) / np.linalg.norm(light.sun_direction)
            lit = bright * shade * (1.0 + SUNNY_SIDE * np.clip(2.0 * off @ sun, -1.0, 1.0))
            far = np.linalg.norm(x - FIRE, axis=1)
            opacity *= np.where(is_smoke, np.maximum(1.0 - (off**2).sum(axis=1), RIM_OPACITY), 1.0)
            glow = np.clip(0.6 - off[:, 2], 0.0, 1.5) / (1.0 + (far / GLOW_REACH) ** 2)
            rgb = np.where(is_smoke[:, None], rgb * lit[:, None] + glow[:, None] * GLOWING_SIDE, rgb)
        self.put(0, x, ball_covariance(width, height), rgb, np.where(age < 0.0, 0.0, opacity))

    def put_jet(self, jet: JetParcels) -> None:
        """Set the splats of the jet: streaks along the way of its parcels, which become thin as it breaks up."""
        every = max(1, -(-len(jet.number) // MAX_OIL_SPLATS))
        chosen = (jet.number % every == 0).nonzero()[0][:MAX_OIL_SPLATS]
        x, v = jet.position[chosen], jet.velocity[chosen]
        size, kind = self.oil_variety[:, jet.number[chosen] // every % MAX_OIL_SPLATS]
        age = np.clip((JET_VELOCITY[2] - v[:, 2]) / (9.81 * OIL_BREAKS_UP), 0.0, 1.0)
        mist = kind < MIST_SHARE
        width = np.where(mist, MIST_WIDTH * (0.4 + age), (0.5 + size) * np.interp(age, (0.0, 1.0), OIL_WIDTHS))
        length = np.where(mist, 1.3 * width, np.interp(age, (0.0, 1.0), OIL_LENGTHS) * (1.3 - 0.6 * size))
        rgb = np.stack([np.interp(kind, (MIST_SHARE, 0.5, 0.93, 1.0), shades) for shades in OIL_COLOURS.T], axis=1)
        opacity = np.where(mist, MIST_OPACITY, np.interp(age, (0.0, 1.0), OIL_OPACITY))
        rgb[mist] = OIL_COLOURS[2]
        self.put(MAX_FIRE_SPLATS, x, streak_covariance(width, length, v), rgb, opacity)

    def put(self, start: int, x: np.ndarray, covariance: np.ndarray, rgb: np.ndarray, opacity: np.ndarray) -> None:
        """Set splats from `start` on: centres (n, 3) [m], upper triangles of covariances (n, 6) [m2], row by row."""
        rows = self.buffer[start : start + len(x)]
        rows[:, :3] = np.ascontiguousarray(x, np.float32).view(np.uint32)
        rows[:, 4:7] = covariance.astype(np.float16).view(np.uint32)
        rgba = np.empty((len(x), 4), np.uint8)
        rgba[:, :3] = np.clip(rgb, 0, 255)
        rgba[:, 3] = np.clip(255.0 * opacity, 0, 255)
        rows[:, 7] = rgba.view(np.uint32)[:, 0]


def from_middle(x: np.ndarray, along: np.ndarray) -> np.ndarray:
    """(n, 3) [m] from the middle of the parcels that are as old to each parcel at x (n, 3) [m]; along (n,): 0 to 1."""
    part = np.clip(PLUME_PARTS * along, 0, PLUME_PARTS - 1).astype(np.intp)
    count = np.maximum(np.bincount(part, minlength=PLUME_PARTS), 1)
    middle = np.stack([np.bincount(part, coordinate, PLUME_PARTS) / count for coordinate in x.T], axis=1)
    return x - middle[part]


def ball_covariance(width: np.ndarray, height: np.ndarray) -> np.ndarray:
    """(n, 6) [m2] of splats with these standard deviations across and upwards (n,) [m]."""
    covariance = np.zeros((len(width), 6))
    covariance[:, 0] = covariance[:, 3] = width**2
    covariance[:, 5] = height**2
    return covariance


def streak_covariance(width: np.ndarray, length: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """(n, 6) [m2] of splats with these standard deviations across and along a direction (n, 3), of any length."""
    d = direction / np.maximum(np.linalg.norm(direction, axis=1), 1e-6)[:, None]
    covariance = ((length**2 - width**2)[:, None]) * np.stack(
        [d[:, i] * d[:, j] for i, j in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))], axis=1
    )
    covariance[:, [0, 3, 5]] += (width**2)[:, None]
    return covariance
