import assert from "node:assert/strict";
import { test } from "node:test";
import { rowsOf } from "./js/panel/rows.js";

test("what does not fit into a row begins the next one, and what is wider than a row has one of its own", () => {
  const found = rowsOf([40, 30, 25, 200, 10, 80, 5], 5, 100).map(({ row, left }) => [row, left]);
  assert.deepEqual(found, [[0, 5], [0, 45], [0, 75], [1, 5], [2, 5], [2, 15], [2, 95]]);
  assert.deepEqual(rowsOf([200, 10], 5, 100).map(({ row }) => row), [0, 1]);
  assert.deepEqual(rowsOf([], 5, 100), []);
});
