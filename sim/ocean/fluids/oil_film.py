"""Optics of an oil film on water: reflected light, and light from the water that passes through.

Light from the upper and from the lower face of a thin film interferes. For three bands of light (red, green, blue) with
a Gaussian sensitivity, the reflected fraction at normal incidence is, with two beams (Born and Wolf, Principles of
Optics, 7.6; the further beams add less than 3 % of what clean water reflects),

    R = r1^2 + q^2 + 2 r1 q V cos(2 beta),    q = (1 - r1^2) r2 e^(-a d),    2 beta = 4 pi n d/lambda

r1 = (1 - n)/(1 + n) and r2 = (n - n_w)/(n + n_w) of Fresnel, a [1/m] half the extinction of light that goes down and up
again, and V = exp(-(2 beta w)^2/2) for a band of relative width w: a band has no fringes left in a thick film.

Oil absorbs blue more than red, exponentially in the wavelength. The extinction at 545 nm is chosen so that a film of
0.2 mm shows the oil's own colour, as in the Bonn Agreement's oil appearance code: sheen 0.04 to 0.3 um, rainbow 0.3 to
5 um, metallic 5 to 50 um, discontinuous true colour 50 to 200 um, continuous true colour above (Bonn Agreement Aerial
Operations Handbook, 2009, part 3, annex A). A film of one thickness has no colours of interference left above 2 um;
what observers call rainbow up to 5 um is a film of varying thickness. `app/render/js/water_shader.js` draws by the
same formulas.
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.validation import argument_error, as_array, check_positive

BANDS = np.array([610e-9, 545e-9, 450e-9])  # [m] red, green, blue
BAND_WIDTH = 0.045  # standard deviation of a band over its wavelength
OPAQUE_THICKNESS = 7e-5  # [m] of crude over which green light, down and up again, falls to 1/e
EXTINCTION_SLOPE = 1.2e7  # [1/m]: the extinction falls by this power of e with the wavelength
# [1/m] of light that goes down and up again through a film, in each band
EXTINCTION: NDArray[np.float64] = np.exp(-EXTINCTION_SLOPE * (BANDS - BANDS[1])) / OPAQUE_THICKNESS
# Bonn Agreement's oil appearance code: name -> least thickness [m]
APPEARANCES = {
    "sheen": 0.04e-6,
    "rainbow": 0.3e-6,
    "metallic": 5e-6,
    "discontinuous true colour": 50e-6,
    "continuous true colour": 200e-6,
}


def light_through(thickness: ArrayLike) -> NDArray[np.float64]:
    """(..., 3) fraction of the light from the water below that films of these thicknesses [m], >= 0, let through."""
    return np.exp(-EXTINCTION * checked(thickness))


def mirrored_light(thickness: ArrayLike, index: float, water_index: float) -> NDArray[np.float64]:
    """(..., 3) fraction of light from straight above that films of these thicknesses [m], >= 0, send back.

    index, water_index: refractive indices of oil and water.
    """
    d = checked(thickness)
    n, below = check_positive("index", index, ""), check_positive("water_index", water_index, "")
    r1 = (1.0 - n) / (1.0 + n)
    q = (1.0 - r1 * r1) * (n - below) / (n + below) * np.exp(-0.5 * EXTINCTION * d)
    phase = 4.0 * math.pi * n * d / BANDS
    return r1 * r1 + q * q + 2.0 * r1 * q * np.exp(-0.5 * (phase * BAND_WIDTH) ** 2) * np.cos(phase)


def appearance(thickness: float) -> str:
    """The class of the oil appearance code for a film [m], or "clean water"."""
    names = [name for name, least in APPEARANCES.items() if thickness >= least]
    return names[-1] if names else "clean water"


def checked(thickness: ArrayLike) -> NDArray[np.float64]:
    """Thicknesses [m] as (..., 1). Raises ValueError for one that is negative or not finite."""
    d = as_array("thickness", thickness, "numbers >= 0 [m]")
    bad = ~(np.isfinite(d) & (d >= 0.0))
    if bad.any():
        raise argument_error("thickness", float(d[bad][0]), "numbers >= 0 [m]")
    return d[..., None]
