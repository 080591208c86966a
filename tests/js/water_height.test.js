import assert from "node:assert/strict";
import { test } from "node:test";
import { waterHeight } from "./js/page/water_height.js";

const CELLS = 8, SIDE = 16; // [m]
/** @param {number} x @param {number} y */
const height = (x, y) => Math.sin((2 * Math.PI * x) / SIDE) + 0.5 * Math.cos((4 * Math.PI * y) / SIDE);
const tile = Array.from({ length: (CELLS + 1) ** 2 }, (_, k) => {
  const x = ((k % (CELLS + 1)) * SIDE) / CELLS, y = (Math.floor(k / (CELLS + 1)) * SIDE) / CELLS;
  return [x, y, height(x, y)];
}).flat();

test("at a vertex of a square tile the water is as high as there, in every repetition of the tile", () => {
  for (const [x, y] of [[0, 0], [4, 6], [-4, 6], [20, -30], [-1600, 1604]]) {
    assert.ok(Math.abs(waterHeight(tile, { x, y }) - height(x, y)) < 1e-9);
  }
});

test("between vertices it is the highest of the nearest ones", () => {
  assert.equal(waterHeight(tile, { x: 2.9, y: 7.1 }), Math.max(height(2, 6), height(4, 6), height(2, 8), height(4, 8)));
});

test("rings of vertices are not repeated", () => {
  const rings = [[10, 0, 1], [0, 10, 2], [-10, 0, 3], [0, -10, 4], [0, 0, 5]].flat();
  assert.equal(waterHeight(rings, { x: 12, y: 0 }), 1);
  assert.equal(waterHeight(rings, { x: 0.1, y: 0.1 }), 5);
});
