"""The noise, foam, rings and ripples of `app/render/js/water_shader.js` in numpy, with the constants of its text.

Arrays of points in place of one pixel; the arithmetic is double where the shader's is single.
"""

import re
from importlib import resources

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
SOURCE = (resources.files("app.render") / "js" / "water_shader.js").read_text("utf-8")


def constant(name: str) -> float:
    """The value of `const float name` or `const int name` in the shader."""
    (value,) = re.findall(rf"const (?:float|int) {name} = ([-0-9.e]+);", SOURCE)
    return float(value)


def numbers(name: str) -> Array:
    """The value of `const vec3 name` in the shader."""
    (values,) = re.findall(rf"const vec3 {name} = vec3\((.*)\);", SOURCE)
    return np.array([float(value) for value in values.split(",")])


def smoothstep(low: float | Array, high: float | Array, x: Array) -> Array:
    """GLSL's smoothstep."""
    t = np.clip((x - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def hash2(p: Array) -> Array:
    """Two random numbers in 0..1 for each whole-numbered point (..., 2)."""
    q = p.astype(np.int64).astype(np.uint32) * np.array([1597334673, 3812015801], np.uint32)
    n = (q[..., 0] ^ q[..., 1]) * np.uint32(1597334673)
    return np.stack([n & np.uint32(0xFFFF), n >> np.uint32(16)], -1) / 65535.0


def gradient_noise(p: Array) -> Array:
    """(..., 3): gradient noise and its two derivatives at points (..., 2)."""
    i = np.floor(p)
    f = p - i
    u = f * f * f * (f * (f * 6.0 - 15.0) + 10.0)
    du = 30.0 * f * f * (f * (f - 2.0) + 1.0)
    corners = [np.array(c, float) for c in ((0, 0), (1, 0), (0, 1), (1, 1))]
    ga, gb, gc, gd = (hash2(i + c) * 2.0 - 1.0 for c in corners)
    a, b, c, d = ((g * (f - at)).sum(-1) for g, at in zip((ga, gb, gc, gd), corners, strict=True))
    ux, uy = u[..., 0], u[..., 1]
    v = a + ux * (b - a) + uy * (c - a) + ux * uy * (a - b - c + d)
    ux, uy = ux[..., None], uy[..., None]
    g = ga + ux * (gb - ga) + uy * (gc - ga) + ux * uy * (ga - gb - gc + gd)
    g = g + du * (u[..., ::-1] * (a - b - c + d)[..., None] + np.stack([b, c], -1) - a[..., None])
    return np.concatenate([v[..., None], g], -1)


def cell_walls(p: Array) -> Array:
    """Distance from the walls between cells around random points."""
    i = np.floor(p)
    f = p - i
    first = second = np.full(p.shape[:-1], 8.0)
    for a in (-1, 0, 1):
        for b in (-1, 0, 1):
            o = np.array([a, b], float)
            r = o + hash2(i + o) - f
            d = (r * r).sum(-1)
            second = np.minimum(second, np.maximum(first, d))
            first = np.minimum(first, d)
    return np.sqrt(second) - np.sqrt(first)


def foam_pattern(p: Array) -> tuple[Array, Array]:
    """The pattern of foam at points (n, 2), with its small bubbles and with its large ones alone."""
    warp = [gradient_noise(p * 0.43 + 3.1)[..., 0], gradient_noise(p * 0.43 - 7.7)[..., 0]]
    p = p + 1.1 * np.stack(warp, -1)
    q = p + 0.30 * np.stack([gradient_noise(p * 2.3)[..., 0], gradient_noise(p * 2.3 + 9.0)[..., 0]], -1)
    mean = constant("FOAM_SMALL_MEAN")
    coarse = cell_walls(q * 1.4) - 0.55 * gradient_noise(p * 0.5 + 11.0)[..., 0] + 0.4 * mean
    fine = 0.4 * (cell_walls(q * 4.7) - mean) + 0.22 * gradient_noise(p * 13.0)[..., 0]
    return coarse + fine, coarse


def foam_cover(v: Array, variance: float, share: float) -> Array:
    """What is drawn as foam where the pattern is v, of this variance, and the simulation has this share of it."""
    v = constant("FOAM_MEAN") + (v - constant("FOAM_MEAN")) * np.sqrt(constant("FOAM_VARIANCE") / variance)
    a, b, c, d = (constant(f"FOAM_{k}") for k in range(4))
    below = 1.0 / (1.0 + np.exp(-(a + v * (b + v * (c + v * d)))))
    soft = min(0.16 + (0.05 - 0.16) * share, 0.9 * min(share, 1.0 - share)) + 1e-4
    return smoothstep(-soft, soft, share - below)


def ring_slopes(x: Array, time: float, share: float, wavelength: float, speed: float) -> Array:
    """(n, 2): slopes of the rings of rain at points (n, 2) [m], where pixels are fine."""
    layers, cell, reach = int(constant("RING_LAYERS")), constant("RING_CELL"), constant("RING_REACH")
    slope, life = np.zeros(x.shape), reach * wavelength / speed
    for k in range(layers):
        c, s = np.cos(0.7 * k), np.sin(0.7 * k)
        p = x @ np.array([[c, s], [-s, c]]) / (cell * wavelength) + 0.37 * k  # GLSL's matrices are by columns
        i, layer = np.floor(p), np.array([101.0, 57.0]) * k
        turn = time / life + hash2(i + layer)[..., 0]
        number = np.floor(turn)
        age = turn - number
        place = hash2(i + layer + number[..., None] * np.array([17.0, 29.0]))
        drop = hash2(i - layer - number[..., None] * np.array([23.0, 13.0]))
        d = cell * (p - i) - (reach + 1.0) - (cell - 2.0 * reach - 2.0) * place
        r = np.sqrt((d * d).sum(-1))
        w = r - reach * age
        strength = (0.4 + 0.6 * drop[..., 1] ** 2) * (1.0 - age) * (np.abs(w) < 1.0) * (drop[..., 0] < share)
        size = constant("RING_SLOPE") * strength * (1.0 - w * w) ** 2 * np.sin(6.2832 * w)
        slope += (size / np.maximum(r, 1e-3))[..., None] * (d @ np.array([[c, -s], [s, c]]))
    return slope


def ripples(x: Array, footprint: float, rms: float, longest: float, shortest: float) -> tuple[Array, Array]:
    """Slopes (n, 2) of the ripples at points (n, 2) [m] at time 0 and wind along x, and the variance (n,) not shown."""
    octaves = int(np.clip(1.0 + np.floor(np.log(longest / shortest) / 0.755), 1.0, 9.0))
    each, crest = rms**2 / octaves, constant("CREST")
    gain = np.sqrt(each / (constant("NOISE_SLOPE_VARIANCE") * (1.0 + crest**2)))
    patches = 1.0 - smoothstep(0.1, 0.5, footprint / (longest * np.array([24.0, 7.0])))
    mean, contrast = constant("GUST_MEAN"), constant("GUST_CONTRAST")
    gust = mean + contrast * sum(
        patch * gradient_noise(x / (longest * size))[:, 0] for patch, size in zip(patches, (24.0, 7.0), strict=True)
    )
    power = mean**2 + contrast**2 * constant("NOISE_VARIANCE") * (patches @ patches)
    gust = np.maximum(gust, 0.15) / np.sqrt(power)
    slope, lost, wave, angle = np.zeros(x.shape), 0.0, longest, 0.0
    for k in range(octaves):
        seen = 1.0 - float(smoothstep(0.12, 0.5, np.float64(footprint / wave)))
        lost += each * (1.0 - seen * seen)
        d, across = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
        n = gradient_noise(np.stack([x @ d, crest * (x @ across)], -1) / wave)
        slope += seen * gain * (n[:, 1:2] * d + crest * n[:, 2:3] * across)
        wave *= 0.47
        angle += 0.9 if k % 2 == 0 else -1.3
    return slope * gust[:, None], lost * gust**2


def fresnel(c: Array, n: float) -> Array:
    """Reflectance of unpolarised light at the cosine c on a fluid of index n."""
    g = np.sqrt(n * n - 1.0 + c * c)
    p, q = (g - c) / (g + c), (c * (g + c) - 1.0) / (c * (g - c) + 1.0)
    return 0.5 * p * p * (1.0 + q * q)


def rough_mirror(c: float, rms: float, n: float) -> float:
    """Reflectance of a rough sea, as the shader sums it."""
    level = np.sqrt(1.0 - c * c)
    low, high = -constant("FACET_LIMIT"), min(c / max(level * rms, 1e-6), constant("FACET_LIMIT"))
    nodes, weights = numbers("FACET_NODES"), numbers("FACET_WEIGHTS")
    t = 0.5 * (high - low) * np.concatenate([nodes, -nodes]) + 0.5 * (high + low)
    seen = np.maximum(c - rms * t * level, 0.0)
    weight = np.concatenate([weights, weights]) * np.exp(-0.5 * t * t) * seen
    mirrored = fresnel(np.minimum(seen / np.sqrt(1.0 + (rms * t) ** 2 + rms**2), 1.0), n)
    return float((weight * mirrored).sum() / weight.sum())
