import assert from "node:assert/strict";
import { test } from "node:test";
import { toHalf } from "./js/sea/half_floats.js";

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
    assert.equal(toHalf(middle), bits % 2 === 0 ? bits : bits + 1);
    assert.equal(toHalf(middle * (1 - 2 ** -20)), bits);
    assert.equal(toHalf(middle * (1 + 2 ** -20)), bits + 1);
  }
});

test("a number that is too large becomes the largest", () => {
  assert.deepEqual([65504, 65519, 65520, 1e6, Infinity].map(toHalf), Array(5).fill(LARGEST));
  assert.equal(toHalf(-1e6), 0x8000 | LARGEST);
});
