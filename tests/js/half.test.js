import assert from "node:assert/strict";
import { test } from "node:test";
import { fromHalf, halvedTexture, toHalf } from "./js/sea/half_floats.js";

const LARGEST = 0x7bff;

// The number that the bits of a half-precision number say.
/** @param {number} bits */
function numberOf(bits) {
  const exponent = (bits >> 10) & 31, part = bits & 1023;
  return exponent === 0 ? part * 2 ** -24 : (1024 + part) * 2 ** (exponent - 25);
}

test("a number becomes the next half-precision number, half way between two the even one", () => {
  for (let bits = 0; bits < LARGEST; bits++) {
    const below = numberOf(bits), above = numberOf(bits + 1), middle = (below + above) / 2; // exact in single precision
    assert.equal(toHalf(below), bits);
    assert.equal(toHalf(-below), 0x8000 | bits);
    assert.deepEqual([fromHalf(bits), fromHalf(0x8000 | bits)], [below, -below]);
    assert.equal(toHalf(middle), bits % 2 === 0 ? bits : bits + 1);
    assert.equal(toHalf(middle * (1 - 2 ** -20)), bits);
    assert.equal(toHalf(middle * (1 + 2 ** -20)), bits + 1);
  }
});

test("a number that is too large becomes the largest", () => {
  assert.deepEqual([65504, 65519, 65520, 1e6, Infinity].map(toHalf), Array(5).fill(LARGEST));
  assert.equal(toHalf(-1e6), 0x8000 | LARGEST);
});

test("a texture of half the size has the means of four texels, down to one", () => {
  const numbers = [1, 2, 3, 4, 5, 6, 7, 8].flatMap((k) => [k, 10 * k, -k, 0.5]), halves = Uint16Array.from(numbers, toHalf);
  const small = halvedTexture(halves, 4, 2);
  assert.deepEqual([small.width, small.height], [2, 1]);
  assert.deepEqual(Array.from(small.halves, fromHalf), [3.5, 35, -3.5, 0.5, 5.5, 55, -5.5, 0.5]);
  const last = halvedTexture(small.halves, 2, 1);
  assert.deepEqual([last.width, last.height, ...Array.from(last.halves, fromHalf)], [1, 1, 4.5, 45, -4.5, 0.5]);
});
