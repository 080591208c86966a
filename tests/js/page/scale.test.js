import assert from "node:assert/strict";
import { test } from "node:test";

Object.assign(globalThis, { document: { getElementById: () => ({ querySelector: () => null }) } });
const { barOf } = await import("./js/beside/scale.js");

test("the bar is the longest of 1, 2 and 5 times a power of ten that fits, in its own unit", () => {
  for (let exponent = -6; exponent < 4; exponent += 0.07) {
    const size = 10 ** exponent, { words, width } = barOf(size), [number, unit] = words.split(" ");
    const length = Number(number) * { km: 1000, m: 1, cm: 0.01 }[/** @type {"km" | "m" | "cm"} */ (unit)];
    const first = Number((length / 10 ** Math.floor(Math.log10(length) + 1e-9)).toFixed(6));
    assert.ok([1, 2, 5].includes(first));
    assert.ok(length <= 150 * size * (1 + 1e-9) && length * 2.5 > 150 * size);
    assert.equal(width, `${Math.round(length / size)}px`);
  }
});
