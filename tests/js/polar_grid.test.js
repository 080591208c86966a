import assert from "node:assert/strict";
import { test } from "node:test";
import { aimPolar, DOUBLED, finenessOf, POLAR, setFineness } from "./js/sea/polar_grid.js";

const TRIANGLES = [7_000, 21_000, 40_000]; // at most, by fineness
const CAMERAS = 300, PIXELS = 200; // of each camera that are tried
const WIDEST = 1.5, HIGHEST = 1, CELL = 2; // [m]
const FARTHEST = 50e3; // [m] from the eye

// Random numbers between 0 and 1: mulberry32.
let seed = 5;
function random() {
  seed = (seed + 0x6d2b79f5) | 0;
  let t = Math.imul(seed ^ (seed >>> 15), 1 | seed);
  t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
  return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32;
}
/** @param {number} low @param {number} high */
const between = (low, high) => low + (high - low) * random();

// A matrix of 4 x 4 numbers, column by column, times a vector.
/** @param {ArrayLike<number>} e @param {number[]} v */
const times = (e, [x, y, z, w]) => [0, 1, 2, 3].map((k) => e[k] * x + e[k + 4] * y + e[k + 8] * z + e[k + 12] * w);

// What the script needs of three's vectors; matrices have their elements only.
class Vector {
  /** @type {number[]} */
  numbers = [0, 0, 0];
  clone() {
    return new Vector();
  }
  /** @param {number[]} numbers */
  set(...numbers) {
    this.numbers = numbers;
    return this;
  }
  toArray() {
    return this.numbers;
  }
  applyMatrix4(/** @type {{ elements: number[] }} */ { elements }) {
    const [x, y, z, w] = times(elements, [...this.numbers, 1]);
    return this.set(x / w, y / w, z / w);
  }
  transformDirection(/** @type {{ elements: number[] }} */ { elements }) {
    const [x, y, z] = times(elements, [...this.numbers, 0]), length = Math.hypot(x, y, z);
    return this.set(x / length, y / length, z / length);
  }
  setFromMatrixPosition(/** @type {{ elements: number[] }} */ { elements }) {
    return this.set(elements[12], elements[13], elements[14]);
  }
}

// A camera over the sea, whose world has z up here: its matrices in the world and of the inverse projection.
function makeCamera() {
  const pitch = random() < 0.2 ? -Math.PI / 2 : (between(-90, 25) * Math.PI) / 180, yaw = between(-Math.PI, Math.PI);
  const [cos, sin] = [Math.cos(yaw), Math.sin(yaw)], height = 10 ** between(0, 2.8);
  const world = [
    sin, -cos, 0, 0,
    -cos * Math.sin(pitch), -sin * Math.sin(pitch), Math.cos(pitch), 0,
    -cos * Math.cos(pitch), -sin * Math.cos(pitch), -Math.sin(pitch), 0,
    between(-100, 100), between(-100, 100), height, 1,
  ];
  const top = Math.tan(0.5 * between(0.3, 1.3)), wide = top * [0.5, 1.6, 2.2][Math.floor(3 * random())];
  const shift = between(-0.3, 0.3), near = 0.01, far = 20_000; // a panel shifts the picture
  const c = -(far + near) / (far - near), d = (-2 * far * near) / (far - near);
  const inverse = [wide, 0, 0, 0, 0, top, 0, 0, 0, 0, 0, 1 / d, shift * wide, 0, -1, c / d];
  return { world, inverse };
}

// Places [x, y] of a level that random pixels of a camera see.
/** @param {ReturnType<typeof makeCamera>} camera @param {number} level */
function seen({ world, inverse }, level) {
  const [x, y, height] = world.slice(12), found = [];
  for (let k = 0; k < PIXELS; k++) {
    const [a, b, c, w] = times(inverse, [between(-1, 1), between(-1, 1), 0.5, 1]);
    const ray = times(world, [a / w, b / w, c / w, 0]), part = (level - height) / ray[2];
    if (part > 0 && part * Math.hypot(ray[0], ray[1]) < FARTHEST) found.push([x + part * ray[0], y + part * ray[1]]);
  }
  return found;
}

// The fan of a camera, and how many rows of triangles it has.
/** @param {ReturnType<typeof makeCamera>} camera @param {number} fineness */
function aimed({ world, inverse }, fineness) {
  const still = { elements: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] };
  let drawn = 0;
  const geometry = { setDrawRange: (/** @type {number} */ from, /** @type {number} */ count) => (drawn = from + count) };
  const polar = { userData: { fineness }, geometry, visible: false };
  const uniforms = {
    toSea: { value: still }, eye: { value: [0] }, polarPlace: { value: [0] }, polarSteps: { value: [0] }, polarTurn: { value: 0 },
  };
  const sea = { polar, uniforms, mesh: { position: new Vector() }, widest: WIDEST, highest: HIGHEST, cell: CELL };
  const camera = { matrixWorld: { elements: world }, projectionMatrixInverse: { elements: inverse } };
  aimPolar(/** @type {GriddedSea} */ (/** @type {unknown} */ (sea)), /** @type {three.Camera} */ (/** @type {unknown} */ (camera)));
  const { polarPlace, polarSteps, polarTurn } = uniforms;
  const rows = polar.visible ? drawn / 6 / (POLAR[fineness].spokes - 1) : 0;
  return { place: polarPlace.value, steps: polarSteps.value, turn: polarTurn.value, rows };
}

for (const [fineness, { rings, spokes }] of POLAR.entries()) {
  test(`the fan of fineness ${fineness} holds all that is seen, moved by waves, and has few triangles`, () => {
    let pointsTried = 0;
    for (let n = 0; n < CAMERAS; n++) {
      const camera = makeCamera(), points = [-HIGHEST, 0, HIGHEST].flatMap((level) => seen(camera, level));
      const { place: [x, y, back, height], steps: [first, step, last, angle], turn, rows } = aimed(camera, fineness);
      assert.ok(rows <= rings + DOUBLED - 1);
      assert.ok(2 * rows * (spokes - 1) <= TRIANGLES[fineness]);
      if (points.length === 0) continue;
      const inner = Math.max(back + height * Math.sinh(first), 0);
      const waves = Math.round((last - first) / step); // rows of triangles with waves
      const outer = (back + height * Math.sinh(last)) * 2 ** Math.max(rows - waves, 0);
      for (const [px, py] of points) {
        for (const [dx, dy] of [[0, 0], [WIDEST, 0], [-WIDEST, 0], [0, WIDEST], [0, -WIDEST]]) {
          const [u, v] = [px + dx - x, py + dy - y], radius = Math.hypot(u, v), off = Math.atan2(v, u) - turn;
          assert.ok(radius >= inner - 1e-3);
          // A row of triangles between two rings is nearer to the middle between spokes.
          assert.ok(radius <= outer * Math.cos(0.5 * angle) || outer > FARTHEST);
          const turned = off - 2 * Math.PI * Math.floor(off / (2 * Math.PI));
          assert.ok(radius < 1e-3 || turned <= angle * (spokes - 1) + 1e-4);
          pointsTried += 1;
        }
      }
    }
    assert.ok(pointsTried > 100 * CAMERAS);
  });
}

test("a canvas of few pixels, and few details, need a coarser grid", () => {
  const canvas = (/** @type {number} */ drawingBufferWidth, /** @type {number} */ drawingBufferHeight) =>
    /** @type {WebGL2RenderingContext} */ ({ drawingBufferWidth, drawingBufferHeight });
  assert.deepEqual([2, 1, 0].map((details) => finenessOf(canvas(1920, 1080), details)), [2, 2, 0]);
  assert.deepEqual([2, 1, 0].map((details) => finenessOf(canvas(640, 480), details)), [1, 1, 0]);
});

test("a grid has two triangles between each two rings and spokes, which name its vertices only", () => {
  class Attribute {
    /** @param {ArrayLike<number>} array */
    constructor(array) {
      this.array = array;
    }
  }
  class Geometry {
    attributes = { position: new Attribute([]) };
    index = new Attribute([]);
    setAttribute(/** @type {"position"} */ name, /** @type {Attribute} */ attribute) {
      this.attributes[name] = attribute;
    }
    setIndex(/** @type {Attribute} */ index) {
      this.index = index;
    }
    dispose() {}
  }
  const polar = { geometry: new Geometry(), userData: { fineness: -1 } };
  setFineness(/** @type {GriddedSea} */ (/** @type {unknown} */ ({ polar, geometry: new Geometry() })), 0);
  const { rings, spokes } = POLAR[0], rows = rings + DOUBLED, vertices = polar.geometry.attributes.position.array;
  const index = Array.from(polar.geometry.index.array);
  assert.equal(polar.userData.fineness, 0);
  assert.equal(index.length, 6 * (rows - 1) * (spokes - 1));
  for (let k = 0; k < index.length; k += 3) {
    const [a, b, c] = index.slice(k, k + 3).map((n) => [vertices[3 * n], vertices[3 * n + 1]]);
    const area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    assert.equal(area, 1); // twice that of half a cell, all turned the same way
  }
});
