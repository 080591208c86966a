import assert from "node:assert/strict";
import { test } from "node:test";
import { footOf, wordsOf } from "./js/panel/foot.js";

const CANVAS = { left: 0, right: 900, top: 0, bottom: 600 }, HIGH = 40;
/** @param {number} left @param {number} right @param {number} top @param {number} bottom */
const box = (left, right, top, bottom) => ({ left, right, top, bottom });
/** @param {Edges[]} panels */
const foot = (...panels) => Object.values(footOf(CANVAS, panels, HIGH));

test("the time line stands between the panels that reach the foot of the scene", () => {
  assert.deepEqual(foot(), [0, 900, 600]);
  assert.deepEqual(foot(box(600, 880, 20, 560)), [0, 600, 600]); // it ends just above the time line
  assert.deepEqual(foot(box(600, 880, 20, 590), box(10, 200, 300, 600)), [200, 600, 600]);
});

test("a panel that is higher, below the scene, or empty is not in its way", () => {
  assert.deepEqual(foot(box(600, 880, 20, 540), box(10, 200, 610, 700), box(600, 600, 0, 600)), [0, 900, 600]);
});

test("it stands above a sheet over the middle, and then beside what reaches so far down", () => {
  assert.deepEqual(foot(box(0, 900, 400, 600)), [0, 900, 400]);
  assert.deepEqual(foot(box(0, 900, 400, 600), box(700, 900, 0, 390)), [0, 700, 400]);
});

test("it stands beside a panel over the middle that leaves no room above it, where there is more room", () => {
  assert.deepEqual(foot(box(300, 900, 20, 600)), [0, 300, 600]);
  assert.deepEqual(foot(box(0, 600, 20, 600)), [600, 900, 600]);
  assert.deepEqual(foot(box(300, 900, HIGH, 600)), [0, 900, HIGH]); // there is just as much room as it needs
  const scrolled = { ...CANVAS, top: -100 }; // its top is above the window
  assert.deepEqual(Object.values(footOf(scrolled, [box(300, 900, 20, 600)], HIGH)), [0, 300, 600]);
});

test("it covers the whole foot where panels leave too little of it", () => {
  assert.deepEqual(foot(box(160, 900, 20, 600)), [0, 160, 600]);
  assert.deepEqual(foot(box(159, 900, 20, 600)), [0, 900, 600]);
});

test("a panel beside the scene, or beside what other panels leave of it, is not in its way", () => {
  assert.deepEqual(foot(box(900, 1200, 0, 600), box(-50, 0, 0, 600)), [0, 900, 600]);
  assert.deepEqual(foot(box(0, 600, 20, 600), box(400, 500, 300, 600)), [600, 900, 600]);
});

test("a moment is said in seconds, and how far back it is", () => {
  assert.deepEqual(wordsOf(12.345, 20, true), { moment: "t = 12.35 s", back: "7.7 s back" });
  assert.deepEqual(wordsOf(20, 20, false), { moment: "Live", back: "0.0 s back" });
});
