"""The mesh of a sea holds all of the water in view, from every camera, and has few triangles."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from tests.browser.glsl import in_base_64, page_with_modules

TRIANGLES = {2: 40_000, 1: 21_000, 0: 7_000}  # at most, by fineness
PIXELS = 200  # of each camera that are tried
# What `aimPolar` needs of three: vectors and 4 x 4 matrices, column by column. Its frame is that of the sea.
AIM = """async ([fineness, cameras, widest, highest, cell]) => {
    const numbers = new Float32Array(Uint8Array.from(atob(cameras), (c) => c.charCodeAt(0)).buffer);
    class Vector {
        set(x, y, z) { Object.assign(this, { x, y, z }); return this; }
        clone() { return new Vector(); }
        toArray() { return [this.x, this.y, this.z]; }
        times(e, w) {
            const { x, y, z } = this, row = (k) => e[k] * x + e[k + 4] * y + e[k + 8] * z + e[k + 12] * w;
            return [row(0), row(1), row(2), row(3)];
        }
        applyMatrix4({ elements }) {
            const [x, y, z, w] = this.times(elements, 1);
            return this.set(x / w, y / w, z / w);
        }
        transformDirection({ elements }) {
            const [x, y, z] = this.times(elements, 0), length = Math.hypot(x, y, z);
            return this.set(x / length, y / length, z / length);
        }
        setFromMatrixPosition({ elements }) { return this.set(elements[12], elements[13], elements[14]); }
    }
    const { aimPolar, POLAR, DOUBLED } = await import("springtide/sea/polar_grid.js");
    const found = [], still = { elements: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] };
    for (let k = 0; k < numbers.length; k += 32) {
        const polar = { userData: { fineness }, geometry: { setDrawRange: (from, count) => (polar.count = count) } };
        const uniforms = { toSea: { value: still }, eye: {}, polarPlace: {}, polarSteps: {}, polarTurn: {} };
        const camera = { matrixWorld: { elements: numbers.slice(k, k + 16) },
                         projectionMatrixInverse: { elements: numbers.slice(k + 16, k + 32) } };
        aimPolar({ polar, uniforms, mesh: { position: new Vector() }, widest, highest, cell }, camera);
        const { rings, spokes } = POLAR[fineness], rows = polar.visible ? polar.count / 6 / (spokes - 1) : 0;
        if (rows > rings + DOUBLED - 1) throw new Error(`${rows} rows of triangles`);
        const { polarPlace, polarSteps, polarTurn } = uniforms;
        found.push(polar.visible ? [...polarPlace.value, ...polarSteps.value, polarTurn.value, rows, spokes]
                                 : Array(11).fill(0));
    }
    return found;
}"""


def cameras(count: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """World matrices and inverse projections (count, 16) of random cameras, column by column."""
    rng = np.random.default_rng(5)
    worlds, inverses = [], []
    for _ in range(count):
        height = 10.0 ** rng.uniform(0.0, 2.8)
        yaw, pitch = rng.uniform(-np.pi, np.pi), np.radians(rng.choice([-90.0, *rng.uniform(-90.0, 25.0, 4)]))
        ahead = np.array([np.cos(yaw) * np.cos(pitch), np.sin(yaw) * np.cos(pitch), np.sin(pitch)])
        right = np.array([np.sin(yaw), -np.cos(yaw), 0.0])
        world = np.eye(4)
        world[:3, :3] = np.column_stack([right, np.cross(right, ahead), -ahead])
        world[:3, 3] = (*rng.uniform(-100.0, 100.0, 2), height)
        top = np.tan(0.5 * rng.uniform(0.3, 1.3))
        aspect, shift = rng.choice([0.5, 1.6, 2.2]), rng.uniform(-0.3, 0.3)  # a panel shifts the picture
        near, far = 0.01, 20_000.0
        projection = np.array(
            [
                [1.0 / (aspect * top), 0.0, shift, 0.0],
                [0.0, 1.0 / top, 0.0, 0.0],
                [0.0, 0.0, -(far + near) / (far - near), -2.0 * far * near / (far - near)],
                [0.0, 0.0, -1.0, 0.0],
            ]
        )
        worlds.append(world.T.ravel())
        inverses.append(np.linalg.inv(projection).T.ravel())
    return np.array(worlds), np.array(inverses)


def seen(world: NDArray[np.float64], inverse: NDArray[np.float64], height: float) -> NDArray[np.float64]:
    """Points (n, 2) [m] of a level at this height that random pixels of a camera see, up to 50 km away."""
    pixels = np.random.default_rng(6).uniform(-1.0, 1.0, (PIXELS, 2))
    clip = np.column_stack([pixels, np.full(PIXELS, 0.5), np.ones(PIXELS)])
    view = clip @ inverse.reshape(4, 4)
    rays = (view[:, :3] / view[:, 3:]) @ world.reshape(4, 4)[:3, :3]
    eye = world[12:15]
    rays = rays[rays[:, 2] * (height - eye[2]) > 0.0]
    points = eye[:2] + rays[:, :2] * ((height - eye[2]) / rays[:, 2])[:, None]
    return points[np.hypot(*(points - eye[:2]).T) < 50e3]


@pytest.mark.parametrize(
    "fineness", [min(TRIANGLES), *(pytest.param(n, marks=pytest.mark.long) for n in sorted(TRIANGLES)[1:])]
)
def test_the_fan_holds_all_that_is_seen_moved_by_waves(chromium: Any, fineness: int) -> None:
    widest, highest, cell = 1.5, 1.0, 2.0  # [m]
    worlds, inverses = cameras(300)
    page = page_with_modules(chromium)
    table = in_base_64(np.hstack([worlds, inverses]))
    fans = page.evaluate(AIM, [fineness, table, widest, highest, cell])
    page.close()
    counts = []
    for world, inverse, fan in zip(worlds, inverses, fans, strict=True):
        points = np.concatenate([seen(world, inverse, z) for z in (-highest, 0.0, highest)])
        x, y, back, height, first, step, last, between, turn, rows, spokes = fan
        counts.append(2 * rows * (spokes - 1))
        if len(points) == 0:
            continue
        moves = widest * np.array([[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]])
        rest = (points[:, None] + moves).reshape(-1, 2) - (x, y)
        radius, angle = np.hypot(*rest.T), np.arctan2(rest[:, 1], rest[:, 0])
        inner = max(back + height * np.sinh(first), 0.0)
        waves = round((last - first) / step)  # rows of triangles with waves
        outer = (back + height * np.sinh(last)) * 2.0 ** max(rows - waves, 0)
        # A row of triangles between two rings is nearer to the middle between spokes.
        assert radius.min() >= inner - 1e-3
        assert radius.max() <= outer * np.cos(0.5 * between) or outer > 50e3
        off = np.mod(angle - turn, 2.0 * np.pi)
        assert (off[radius > 1e-3] <= between * (spokes - 1) + 1e-4).all()
    assert max(counts) <= TRIANGLES[fineness]
