import assert from "node:assert/strict";
import { test } from "node:test";
import { Silence } from "./js/page/silence.js";

const LOOK = 500; // [ms]

// A connection, and a page that looks at it: `pass` lets time pass, with a beat at intervals or none, and returns the states with
// the time [s] at which each began.
function watched() {
  const line = { heard: 0, beats: 1, wait: 0, isOpen: true };
  let now = 1e6, began = now;
  const silence = new Silence(now);
  /** @param {number} seconds @param {number} interval [s] @param {number} look [ms] */
  function pass(seconds, interval = 0, look = LOOK) {
    /** @type {[string, number][]} */
    const states = [];
    began = now;
    for (let beat = 1; now < began + 1000 * seconds; ) {
      now += look;
      while (interval && began + 1000 * interval * beat <= now) [beat, line.heard] = [beat + 1, line.heard + 1];
      const state = silence.look(now, line);
      if (state !== states.at(-1)?.[0]) states.push([state, (now - began) / 1000]);
    }
    return states;
  }
  return { line, silence, pass };
}

test("a connection with beats is open, for as long as they come", () => {
  assert.deepEqual(watched().pass(3600, 2), [["open", 0.5]]);
});

test("without a message the picture is old after 5 s, and the connection is lost after 10 s", () => {
  const { pass } = watched();
  pass(10, 2);
  assert.deepEqual(pass(10), [["open", 0.5], ["silent", 5], ["lost", 10]]);
});

test("a page that could not look does not count that time: the messages of it are still waiting", () => {
  const { pass, line } = watched();
  pass(10, 2);
  for (let k = 0; k < 3; k += 1) {
    assert.deepEqual(pass(9, 0, 9000), [["open", 9]]);
    line.heard += 1;
  }
});

test("a page that wakes up gives a silent connection 3 s", () => {
  const { pass, silence, line } = watched();
  pass(10, 2);
  pass(2);
  silence.wake(line);
  assert.deepEqual(pass(3), [["open", 0.5], ["lost", 3]]);
  line.heard += 1;
  assert.deepEqual(pass(60, 0, 60_000), [["open", 60]]); // the machine has slept for a minute
  assert.deepEqual(pass(3), [["open", 0.5], ["lost", 3]]);
});

test("a message after the page has woken up gives the connection its usual time", () => {
  const { pass, silence, line } = watched();
  silence.wake(line);
  pass(2, 2);
  assert.deepEqual(pass(10), [["open", 0.5], ["silent", 5], ["lost", 10]]);
});

test("while a large message is on its way the page waits for it", () => {
  const { pass, line } = watched();
  pass(10, 2);
  line.wait = 20;
  assert.deepEqual(pass(30), [["open", 0.5], ["silent", 25], ["lost", 30]]);
});

test("without a connection the page says so once it has not come back soon", () => {
  const { pass, line } = watched();
  pass(10, 2);
  line.isOpen = false;
  assert.deepEqual(pass(60), [["open", 0.5], ["closed", 2]]);
  line.isOpen = true;
  line.heard += 1;
  assert.deepEqual(pass(10, 2), [["open", 0.5]]);
});

test("a lab that sends no beats is not judged", () => {
  const { pass, line } = watched();
  line.beats = 0;
  assert.deepEqual(pass(100), [["open", 0.5]]);
});
