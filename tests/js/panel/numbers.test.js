import assert from "node:assert/strict";
import { test } from "node:test";
import { parse, stepped } from "./js/panel/numbers.js";

test("a number is read with a comma, as a fraction, or not at all", () => {
  const read = ["0.5", "0,5", "1/60", "-2e3", " 7 ", "", "1/2/3", "1/0", "two"].map(parse);
  assert.deepEqual(read, [0.5, 0.5, 1 / 60, -2000, 7, null, null, null, null]);
});

test("the arrows change the second digit, of a whole number by one at least", () => {
  const up = ["8000", "30", "9", "0,5", "0", "0.0", "-12", "x"].map((text) => stepped(text, true));
  assert.deepEqual(up, ["8100", "31", "10", "0.51", "1", "0.1", "-11", null]);
  assert.deepEqual(["8100", "31", "0.51", "0.1"].map((text) => stepped(text, false)), ["8000", "30", "0.5", "0.09"]);
});
