import assert from "node:assert/strict";
import { test } from "node:test";
import { without } from "./js/page/free_part.js";

const window = { x: 0, y: 0, width: 900, height: 560 };

test("a panel leaves the largest part beside it", () => {
  assert.deepEqual(without(window, { left: 600, right: 880, top: 20, bottom: 540 }), { ...window, width: 600 });
  assert.deepEqual(without(window, { left: 0, right: 900, top: 400, bottom: 560 }), { ...window, height: 400 });
});

test("a panel that is elsewhere, or leaves no part of a size, takes nothing", () => {
  assert.deepEqual(without(window, { left: 900, right: 1200, top: 0, bottom: 560 }), window);
  assert.deepEqual(without(window, { left: 50, right: 850, top: 50, bottom: 500 }), window);
});
