import assert from "node:assert/strict";
import { test } from "node:test";

// The parts of a browser that a clip uses: elements, a recorder, and the canvas of viser's client.
class Element extends EventTarget {
  /** @type {Element[]} */
  children = [];
  dataset = {};
  className = "";
  textContent = "";
  /** @param {Element[]} made */
  append(...made) { this.children.push(...made); }
  remove() { page.children = page.children.filter((/** @type {Element} */ child) => child !== this); }
  setAttribute() {}
  click() { saved.push(this); }
}
/** @type {any} */
let page;
/** @type {any[]} */
let saved;
/** @type {any} */
let recorder; // the class
/** @type {any} */
let made; // the last one made
const button = new Element();
const track = { stops: 0, stop() { this.stops += 1; } };
const pen = new Proxy({ canvas: { width: 4, height: 4 } }, { get: (own, name) => Reflect.get(own, name) ?? (() => ({ addColorStop() {} })) });

class Recorder {
  static isTypeSupported = () => true;
  state = "inactive";
  constructor() { made = this; }
  start() { this.state = "recording"; }
  stop() {
    assert.equal(this.state, "recording");
    this.state = "inactive";
    /** @type {any} */ (this).ondataavailable({ data: new Blob(recorder.content) });
    this.ended = /** @type {any} */ (this).onstop();
  }
}

Object.assign(globalThis, {
  document: {
    createElement: () => Object.assign(new Element(), { getContext: () => pen, captureStream: () => ({ getTracks: () => [track] }) }),
    getElementById: (/** @type {string} */ id) => page.children.find((/** @type {any} */ child) => child.id === id) ?? null,
    querySelector: () => button,
    get body() { return page; },
  },
  getComputedStyle: () => ({ backgroundImage: "" }),
  window: globalThis,
  __viserMutable: { canvas: { width: 5, height: 5 } },
});
URL.createObjectURL = () => "blob:";
const { setTimeout } = globalThis;
// The test does not wait for the timer that frees a saved file after a minute.
// @ts-expect-error: a timer of Node
globalThis.setTimeout = (...given) => setTimeout(...given).unref();
const { toggleClip } = await import("./js/sharing/clip.js");
const { springtide } = await import("./js/core/springtide.js");
const notices = () => page.children.map((/** @type {any} */ child) => child.textContent);

function begin() {
  [page, saved, recorder, track.stops] = [new Element(), [], class extends Recorder {}, 0];
  recorder.content = ["clip"];
  /** @type {any} */ (globalThis).MediaRecorder = recorder;
}

test("a clip is saved with what was recorded", async () => {
  begin();
  toggleClip();
  assert.equal(springtide.isRecording, true);
  toggleClip();
  await made.ended;
  assert.equal(springtide.isRecording, false);
  assert.deepEqual([saved.length, notices(), track.stops], [1, [], 1]);
});

test("a clip of no bytes is not saved, and the page says so", async () => {
  begin();
  recorder.content = [];
  for (let press = 1; press <= 2; press += 1) {
    toggleClip();
    toggleClip();
    await made.ended;
    assert.deepEqual([saved.length, springtide.isRecording, button.textContent], [0, false, "Record clip"]);
    assert.ok(notices()[0].includes("No clip was saved: nothing was recorded. Save a replay instead"));
  }
});

test("a clip that cannot start leaves the page as it was, and the next one starts", async () => {
  begin();
  recorder.prototype.start = () => { throw new Error("no encoder"); };
  toggleClip();
  assert.equal(springtide.isRecording ?? false, false);
  assert.ok(notices()[0].includes("The clip did not start: no encoder"));
  assert.equal(track.stops, 1);
  delete recorder.prototype.start;
  toggleClip();
  assert.deepEqual([springtide.isRecording, notices()], [true, []]);
  toggleClip();
  await made.ended;
  assert.equal(saved.length, 1);
});

test("an error of the browser ends a clip with its reason", async () => {
  begin();
  recorder.content = [];
  toggleClip();
  made.onerror({ error: new Error("the encoder failed") });
  await made.ended;
  assert.ok(notices()[0].includes("No clip was saved: the encoder failed"));
  assert.equal(springtide.isRecording, false);
});
