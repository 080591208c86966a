import assert from "node:assert/strict";
import { test } from "node:test";
import { blurredCube, skyIrradiance, skyRadiance } from "./js/scene/formula_sky.js";
import { fromHalf } from "./js/sea/half_floats.js";

const SKY = { low: [1, 1.2, 1.6], high: [0.1, 0.2, 0.4] }, FACE = 16, WIDTH = 336;

// The direction evenly drawn by its number, y upwards.
/** @param {number} k @param {number} count */
function directionOf(k, count) {
  const y = 1 - (2 * k + 1) / count, level = Math.sqrt(1 - y * y), angle = 2.4 * k;
  return [level * Math.cos(angle), y, level * Math.sin(angle)];
}

// The light that three's bilinearCubeUV finds for a direction, `blur` tiles along.
/** @param {Uint16Array} numbers @param {number[]} direction @param {number} blur */
function lookedUp(numbers, [x, y, z], blur) {
  const [a, b, c] = [x, y, z].map(Math.abs);
  let face = a > b && a > c ? (x > 0 ? 0 : 3) : c > b ? (z > 0 ? 2 : 5) : y > 0 ? 1 : 4;
  const place = [[z / a, y / a], [-x / b, -z / b], [-x / c, y / c], [-z / a, y / a], [-x / b, z / b], [x / c, y / c]][face];
  const at = place.map((part) => 0.5 * (part + 1) * (FACE - 2) + 1);
  if (face > 2) {
    at[1] += FACE;
    face -= 3;
  }
  const [u, v] = [at[0] + face * FACE + blur * 3 * FACE - 0.5, at[1] - 0.5], [i, j] = [Math.floor(u), Math.floor(v)];
  /** @type {(column: number, row: number) => number} */
  const texel = (column, row) => fromHalf(numbers[4 * (row * WIDTH + column)]);
  const [s, t] = [u - i, v - j];
  return (1 - t) * ((1 - s) * texel(i, j) + s * texel(i + 1, j)) + t * ((1 - s) * texel(i, j + 1) + s * texel(i + 1, j + 1));
}

test("three finds the sky by formula in the cube, sharp and as light from all around", () => {
  const { numbers, width, height } = blurredCube(SKY);
  assert.deepEqual([width, height], [WIDTH, 4 * FACE]);
  for (let k = 0; k < 500; k++) {
    const direction = directionOf(k, 500), up = direction[1];
    const [sharp, matt] = [skyRadiance(SKY, up)[0], skyIrradiance(SKY, up)[0]];
    if (up > 0.1 || up < -0.3) assert.ok(Math.abs(lookedUp(numbers, direction, 0) - sharp) < 0.02 * SKY.low[0]);
    assert.ok(Math.abs(lookedUp(numbers, direction, 6) - matt) < 0.02 * SKY.low[0]);
  }
});

test("the light on a matt surface is that of all directions, by their cosine", () => {
  for (const up of [1, -1, 0]) {
    const level = Math.sqrt(1 - up * up), count = 20000;
    let sum = 0;
    for (let k = 0; k < count; k++) {
      const [x, y] = directionOf(k, count);
      sum += (4 / count) * Math.max(level * x + up * y, 0) * skyRadiance(SKY, y)[0];
    }
    assert.ok(Math.abs(skyIrradiance(SKY, up)[0] - sum) < (up === 1 ? 0.002 : 0.1) * SKY.low[0]);
  }
});
