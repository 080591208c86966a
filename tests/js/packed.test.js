import assert from "node:assert/strict";
import { test } from "node:test";
import { applyPacked, unpack } from "./js/shading/packed.js";

const BLOCK = 16, WIDTH_BITS = 5, WORD_BITS = 30;

// Whole numbers of steps, packed as app/formats/packing.py says: one bit after the other.
/** @param {number[][]} fields @param {number} columns @param {number[]} steps @param {number[]} offsets */
function pack(fields, columns, steps, offsets) {
  /** @type {number[]} */
  const bits = [];
  const write = (/** @type {number} */ value, /** @type {number} */ width) => {
    for (let k = 0; k < width; k++) bits.push((value >> k) & 1);
  };
  for (const q of fields) {
    const at = (/** @type {number} */ row, /** @type {number} */ column) =>
      row >= 0 && column >= 0 ? q[row * columns + column] : 0;
    const codes = q.map((value, i) => {
      const row = Math.floor(i / columns), column = i % columns;
      const r = value - (at(row, column - 1) + at(row - 1, column) - at(row - 1, column - 1));
      return r >= 0 ? 2 * r : -2 * r - 1;
    });
    for (let first = 0; first < codes.length; first += BLOCK) {
      const block = codes.slice(first, first + BLOCK), width = Math.max(...block).toString(2).length;
      const needed = Math.max(...block) === 0 ? 0 : width;
      write(needed, WIDTH_BITS);
      for (const code of block) write(code, needed);
    }
  }
  const words = new Uint32Array(Math.ceil(bits.length / WORD_BITS) + 2);
  bits.forEach((bit, k) => (words[Math.floor(k / WORD_BITS)] |= bit << (k % WORD_BITS)));
  const head = [fields[0].length, columns, fields.length, ...fields.flatMap((_, k) => [steps[k], offsets[k], 0])];
  const numbers = new Float32Array(head.length + words.length);
  numbers.set(head);
  new Uint32Array(numbers.buffer).set(words, head.length);
  return numbers;
}

// Whole numbers that are smooth along rows, with jumps of up to 22 bits.
/** @param {number} count @param {number} seed */
function smooth(count, seed) {
  return Array.from({ length: count }, (_, i) => {
    const jump = i % 29 === 0 ? (i * 7919 * seed) % 2 ** 20 : 0;
    return Math.round(40 * Math.sin(0.3 * i + seed)) + (i % 2 ? jump : -jump) || 0; // and not -0
  });
}

test("packed fields come back, whatever their number and the length of their rows", () => {
  for (const count of [1, 15, 16, 17, 100, 257]) {
    for (const columns of [1, 7, 16, 300]) {
      const fields = [smooth(count, 1), Array(count).fill(0), smooth(count, 2)];
      const found = unpack(pack(fields, columns, [0.5, 1, 0.25], [10, -2, 0]));
      assert.equal(found.count, count);
      assert.deepEqual(found.offsets, [10, -2, 0]);
      found.fields.forEach((values, k) => {
        const step = [0.5, 1, 0.25][k];
        assert.deepEqual(Array.from(values), fields[k].map((q) => q * step));
      });
    }
  }
});

class Attribute {
  version = 0;
  /** @param {Float32Array} array @param {number} size */
  constructor(array, size) {
    this.array = array;
    this.count = array.length / size;
  }

  set needsUpdate(/** @type {boolean} */ now) {
    if (now) this.version += 1;
  }
}

// A mesh with vertices at these numbers, as far as the script uses it. computed: how often its normals were.
/** @param {Float32Array} numbers */
function meshOf(numbers) {
  const found = {
    computed: 0,
    geometry: {
      attributes: /** @type {Record<string, Attribute>} */ ({ position: new Attribute(numbers, 3) }),
      setAttribute(/** @type {string} */ name, /** @type {Attribute} */ attribute) {
        this.attributes[name] = attribute;
      },
      computeVertexNormals: () => void (found.computed += 1),
      computeBoundingSphere() {},
    },
  };
  return /** @type {three.Mesh & typeof found} */ (/** @type {unknown} */ (found));
}

test("vertices are moved from where they rest, once for each state of the data and of the vertices", () => {
  const fields = [[1, 2], [3, 4], [5, 6], [7, 8], [9, 10], [11, 12]];
  const data = meshOf(pack(fields, 2, Array(6).fill(0.5), [100, 0, 0, 0, 0, 1]));
  const mesh = meshOf(new Float32Array(6)), rest = Float32Array.from([10, 20, 30, 40, 50, 60]);
  const apply = () => applyPacked(mesh, data, "slopeAndFoam", rest);
  const { attributes } = mesh.geometry, places = [110.5, 21.5, 32.5, 141, 52, 63];
  for (const computed of [1, 1]) {
    assert.equal(apply(), true);
    assert.equal(mesh.computed, computed);
    assert.deepEqual(Array.from(attributes.position.array), places);
    assert.deepEqual(Array.from(attributes.slopeAndFoam.array), [3.5, 4.5, 6.5, 4, 5, 7]);
  }
  mesh.geometry.setAttribute("position", /** @type {any} */ (new Attribute(new Float32Array(6), 3))); // viser does so
  assert.equal(apply(), true);
  assert.deepEqual(Array.from(attributes.position.array), places);
  data.geometry.attributes.position.needsUpdate = true;
  apply();
  assert.equal(mesh.computed, 3);
});

test("the memory of a message is left as it is: in a recording, equal arrays are one", () => {
  const data = meshOf(pack(Array(6).fill([1, 2]), 2, Array(6).fill(1), Array(6).fill(0)));
  const rest = Float32Array.from([10, 20, 30, 40, 50, 60]), mesh = meshOf(new Float32Array(rest.buffer));
  for (let round = 0; round < 2; round++) {
    mesh.geometry.setAttribute("position", /** @type {any} */ (new Attribute(new Float32Array(rest.buffer), 3)));
    assert.equal(applyPacked(mesh, data, "slopeAndFoam", rest), true);
    assert.deepEqual(Array.from(mesh.geometry.attributes.position.array), [11, 21, 31, 42, 52, 62]);
    assert.deepEqual(Array.from(rest), [10, 20, 30, 40, 50, 60]);
  }
});

test("data of another mesh is left alone", () => {
  const data = meshOf(pack(Array(6).fill([1, 2]), 2, Array(6).fill(1), Array(6).fill(0)));
  assert.equal(applyPacked(meshOf(new Float32Array(9)), data, "slopeAndFoam", null), false);
  assert.equal(applyPacked(meshOf(new Float32Array(6)), data, "slopeAndFoam", new Float32Array(9)), false);
});
