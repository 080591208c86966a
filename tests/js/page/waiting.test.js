import assert from "node:assert/strict";
import { test } from "node:test";
import { Waiting } from "./js/page/waiting.js";

// A page whose picture is complete or not.
class Page {
  waiting = new Waiting();
  runs = { panel: "a", awaited: "", placed: "1" };
  isWhole = true;
  begun = 0;
  // begin() makes the frame on the canvas an old one.
  /** @param {number} now [ms] */
  look(now) {
    return this.waiting.look(now, this.runs, () => this.isWhole, () => { this.begun += 1; this.isWhole = false; });
  }
}

test("a picture is old from the choice of a preset until the first complete one of its run", () => {
  const page = new Page();
  assert.equal(page.look(0), false);
  page.runs.awaited = "2";
  assert.equal(page.look(100), false); // most come at once
  assert.equal(page.look(500), true);
  assert.equal(page.begun, 0);
  page.runs.placed = "2";
  assert.equal(page.look(3000), true); // frames of the new run are not drawn yet
  assert.equal(page.begun, 1);
  page.isWhole = true;
  assert.equal(page.look(4000), false);
  page.runs.placed = "3"; // a reset
  assert.equal(page.look(9000), false);
});

test("a quick change has no veil, and one that follows it is waited for anew", () => {
  const page = new Page();
  page.look(0);
  Object.assign(page.runs, { awaited: "2", placed: "2" });
  assert.equal(page.look(100), false);
  page.isWhole = true;
  assert.equal(page.look(200), false);
  page.runs.awaited = "1"; // an undo
  assert.equal(page.look(10_000), false);
  assert.equal(page.look(10_400), true);
  page.runs.placed = "1";
  assert.equal(page.look(10_500), true);
  page.isWhole = true;
  assert.equal(page.look(10_600), false);
});

test("of two presets the last one is waited for, and a run that ends otherwise ends the wait", () => {
  const page = new Page();
  page.look(0);
  page.runs.awaited = "2";
  page.look(100);
  page.runs.awaited = "3";
  assert.equal(page.look(500), true);
  page.runs.placed = "4"; // reset before
  page.look(600);
  page.isWhole = true;
  assert.equal(page.look(700), false);
});

test("another scene has a cover, and the veil goes after a minute in any case", () => {
  const page = new Page();
  page.look(0);
  page.runs.awaited = "2";
  page.look(0);
  assert.equal(page.look(1000), true);
  Object.assign(page.runs, { panel: "b", awaited: "7", placed: "6" });
  assert.equal(page.look(1100), false);
  page.runs.awaited = "8";
  page.look(2000);
  assert.equal(page.look(61_000), true);
  assert.equal(page.look(62_001), false);
});
