import assert from "node:assert/strict";
import { test } from "node:test";
import { firstStep, makeJudge, STEPS } from "./js/shading/judge.js";

const FAST = 16.7, MIDDLING = 30, SLOW = 60, VERY_SLOW = 300; // [ms]

// The step after each list of [length, number] of frames.
/** @param {[length: number, count: number, compiled?: boolean][][]} lists */
function judged(...lists) {
  const judge = makeJudge();
  return lists.map((list) => {
    for (const [length, count, compiled] of list) for (let k = 0; k < count; k++) judge.take(length, compiled);
    return judge.step();
  });
}

test("30 frames a second are fast enough", () => {
  assert.deepEqual(judged([[FAST, 3000]], [[MIDDLING, 500]]), [0, 0]);
});

test("a frame after a change compiles programs, and one slow window may be something else", () => {
  assert.deepEqual(judged([[2000, 1]], [[FAST, 500]], [[SLOW, 34], [FAST, 200]], [[SLOW, 80]]), [0, 0, 0, 1]);
});

test("very slow frames take two steps at once, and one of more than 500 ms all", () => {
  assert.deepEqual(judged([[VERY_SLOW, 12]], [[VERY_SLOW, 12]], [[VERY_SLOW, 99]]), [2, 4, 4]);
  assert.deepEqual(judged([[600, 1]], [[600, 1]], [[600, 99]]), [0, 4, 4]);
  assert.deepEqual(judged([[FAST, 500]], [[490, 1], [FAST, 500]], [[510, 1]]), [0, 0, 4]);
});

test("quality rises after 20 s of fast frames; where that was too much, after four times as long", () => {
  const steps = judged([[SLOW, 80]], [[FAST, 1100]], [[FAST, 200]], [[SLOW, 110]], [[FAST, 4000]], [[FAST, 1200]]);
  assert.deepEqual(steps, [1, 1, 0, 1, 1, 0]);
});

test("two frames of more than 2 s in a row are too slow, even if they compiled programs; one may be a long compilation", () => {
  assert.deepEqual(judged([[2500, 1, true]], [[900, 5, true]], [[2500, 1, true]], [[2500, 1, true]]), [0, 0, 0, 4]);
});

test("a renderer begins at the step that was kept of it, one without a graphics card else at the last", () => {
  const last = STEPS.length - 1, card = "ANGLE (NVIDIA GeForce RTX 3060)", software = "Google SwiftShader";
  const keptSteps = [undefined, 2, 0, last + 1, -1, "2", null];
  assert.deepEqual(keptSteps.map((kept) => firstStep(kept, card)), [0, 2, 0, 0, 0, 0, 0]);
  assert.deepEqual([undefined, 2, 0, last + 1].map((kept) => firstStep(kept, software)), [last, 2, 0, last]);
  const others = ["llvmpipe (LLVM 15.0.6)", "Microsoft Basic Render Driver", "Apple GPU", "Mesa Intel(R) UHD Graphics"];
  assert.deepEqual(others.map((name) => firstStep(null, name)), [last, last, 0, 0]);
});
