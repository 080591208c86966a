import assert from "node:assert/strict";
import { test } from "node:test";
import { raises } from "./js/scene/label_layout.js";

const HIGH = 0.1;
/** @param {number} left @param {number} bottom @param {number} width */
const label = (left, bottom, width = 0.3) => ({ left, right: left + width, bottom, height: HIGH });

test("labels beside each other stay where they are", () => {
  assert.deepEqual(raises([label(0, 0), label(0.3, 0), label(-0.3, 0.05), label(0, 0.2)]), [0, 0, 0, 0]);
});

test("no label covers another, and none is higher than it must be", () => {
  const labels = Array.from({ length: 9 }, (_, k) => label(0.11 * ((k * 5) % 7), 0.02 * k));
  const found = labels.map((one, k) => ({ ...one, bottom: one.bottom + HIGH * (raises(labels)[k] ?? NaN) }));
  found.forEach((one, k) => {
    const across = found.slice(0, k).filter((other) => one.left < other.right && one.right > other.left);
    const between = across.map((other) => Math.max(other.bottom - one.bottom, one.bottom - other.bottom) - HIGH);
    assert.ok(between.every((gap) => gap >= 0.15 * HIGH - 1e-9));
    if (one.bottom > labels[k].bottom + 1e-9) assert.ok(between.some((gap) => gap < 0.16 * HIGH)); // it stands on one
  });
});

test("a label that had to be raised by more than 12 of its heights is hidden and covers none", () => {
  const found = raises(Array(20).fill(label(0, 0)));
  assert.equal(found.indexOf(null), 11);
  assert.ok(found.slice(11).every((raise) => raise === null));
});

test("labels that begin in the picture end in it, and those that begin above it stay there", () => {
  const labels = [0.7, 0.72, 0.8, 0.95, 1.2].map((bottom) => label(0, bottom)), shifts = raises(labels, 1);
  const found = labels.map((one, k) => one.bottom + HIGH * (shifts[k] ?? NaN));
  assert.ok(found.slice(0, 4).every((bottom) => bottom <= 1 - HIGH + 1e-9));
  assert.equal(shifts[4], 0);
  const inOrder = [...found].sort((a, b) => a - b);
  assert.ok(inOrder.slice(1).every((bottom, k) => bottom - inOrder[k] >= 1.15 * HIGH - 1e-9));
});
