"""The light of the sky on rough surfaces: the shader's polynomial against the light from which its terms are made."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from tests.browser.glsl import evaluate, page_with_modules

# What the file needs of three's vectors, its directions, its GLSL, and its terms of a light in these directions.
START = """const vector = (x = 0, y = 0, z = 0) => ({ x, y, z,
        clone() { return vector(this.x, this.y, this.z); },
        set(x, y, z) { return Object.assign(this, { x, y, z }); },
        fromArray(a, at = 0) { return this.set(a[at], a[at + 1], a[at + 2]); },
        addScaledVector(v, s) { return this.set(this.x + s * v.x, this.y + s * v.y, this.z + s * v.z); },
        min(v) { return this.set(Math.min(this.x, v.x), Math.min(this.y, v.y), Math.min(this.z, v.z)); },
        max(v) { return this.set(Math.max(this.x, v.x), Math.max(this.y, v.y), Math.max(this.z, v.z)); } });"""
FIND = f"""async (lights) => {{ {START}
    const {{ AMBIENT_GLSL, skyTerms, setTerms }} = await import("springtide/scene/ambient.js");
    skyTerms.value = Array.from({{ length: 10 }}, () => vector());
    setTerms(lights);
    return [AMBIENT_GLSL, skyTerms.value.map(({{ x, y, z }}) => [x, y, z])]; }}"""
COUNT = 256  # directions of the file


@pytest.fixture(scope="module")
def page(chromium: Any) -> Iterator[Any]:
    page = page_with_modules(chromium)
    yield page
    page.close()


def directions() -> np.ndarray:
    k = np.arange(COUNT)
    z, a = 1.0 - (2.0 * k + 1.0) / COUNT, np.pi * (3.0 - np.sqrt(5.0)) * k
    level = np.sqrt(1.0 - z * z)
    return np.stack([level * np.cos(a), level * np.sin(a), z], axis=1)


@pytest.mark.parametrize(("details", "error", "shadow_error"), [(2, 0.094, 0.0625), (0, 0.25, 0.041)])
def test_matt_surfaces_are_lit_by_sun_and_sky_from_all_sides(
    page: Any, details: int, error: float, shadow_error: float
) -> None:
    """A red sun, and a blue sky that is brighter above: the light on a matt surface is known for both.

    For a sun, max(z, 0), the terms up to the second degree are 1/4 + z/2 + 5/32 (3 z^2 - 1): they miss at most 3/32, at
    z = 0, and are at least -0.0396, at z = -8/15. Those of first degree miss a quarter, but are not less than that.
    """
    sun, n = np.array([0.48, -0.6, 0.64]), directions()
    toward = n @ sun
    light = np.stack([0.1 + np.maximum(toward, 0.0), np.full(COUNT, 0.3), 0.5 + 0.3 * n[:, 2], np.ones(COUNT)], axis=1)
    glsl, terms = page.evaluate(FIND, light.ravel().tolist())
    known = ", ".join(f"vec3({x:.7f}, {y:.7f}, {z:.7f})" for x, y, z in terms)
    shader = f"""const mat4 viewMatrix = mat4(1.0);
        vec3 inverseTransformDirection(vec3 d, mat4 m) {{ return d; }}
        {glsl.replace("uniform vec3 skyTerms[10];", f"const vec3 skyTerms[10] = vec3[]({known});")}"""
    shader = shader.replace("skyLight", "lightOfTerms")  # water has another one
    found = evaluate(page, "vec4(lightOfTerms(p.xyz), 1.0)", n, details=details, functions=shader)[:, :3]
    np.testing.assert_allclose(found[:, 0], light[:, 0], atol=error + 0.002)
    np.testing.assert_allclose(found[toward < -0.6, 0], 0.1, atol=shadow_error + 0.002)
    np.testing.assert_allclose(found[:, 1:], light[:, 1:3], atol=0.002)


AT_SEA = """async ([lights, cover]) => { const { overSea } = await import("springtide/scene/ambient.js");
    const uniforms = { skyTint: { value: { toArray: () => [1, 1, 1] } }, clouds: { value: { x: cover } } };
    return overSea(lights, uniforms); }"""


@pytest.mark.parametrize("cover", [0.0, 1.0])
def test_what_stands_in_a_sea_is_lit_by_sky_and_sea_and_not_by_the_land_of_the_photograph(
    page: Any, cover: float
) -> None:
    """A blue sky above dark green land. Below clouds the light is grey."""
    n = directions()
    sky, land = np.array([0.6, 0.8, 1.0]), np.array([0.01, 0.05, 0.0])
    share = np.clip(0.5 + n[:, 1:2], 0.0, 1.0)  # y is up
    light = np.hstack([share * sky + (1.0 - share) * land, np.ones((COUNT, 1))])
    found = np.reshape(page.evaluate(AT_SEA, [light.ravel().tolist(), cover]), (COUNT, 4))[:, :3]
    overhead = found[n[:, 1] > 0.95].mean(0)
    level = found[np.abs(n[:, 1]) < 0.1]
    assert (level.min(0) > 0.5 * overhead).all()
    assert (found.min(0) > 0.2 * overhead).all()
    if cover:
        np.testing.assert_allclose(found.std(axis=1), 0.0, atol=1e-6)
    else:
        np.testing.assert_allclose(overhead, sky, rtol=0.02)
        np.testing.assert_allclose(level / level[:, 2:], np.tile(sky, (len(level), 1)), rtol=0.02)
