import assert from "node:assert/strict";
import { test } from "node:test";

// A page without a browser: what is in it, as the hint sees it.
const page = { hasRope: true, isStopped: false, isCovered: true, isPulled: false, end: [0, 0] };
/** @type {((now: number) => void)[]} */
const frames = [];
/** @type {Record<string, (() => void)[]>} */
const listeners = {};
/** @type {Record<string, string>} */
const storage = {};
/** @type {any} */
let hint = null;
const place = {
  x: 0, y: 0, clone: () => place, set: () => place, applyMatrix4: () => place,
  project() {
    [place.x, place.y] = page.end;
    return place;
  },
};
const mesh = { isMesh: true, matrixWorld: {}, geometry: { attributes: { position: { count: 3, getX() {}, getY() {}, getZ() {} } } } };
Object.assign(globalThis, {
  window: globalThis,
  addEventListener: (/** @type {string} */ kind, /** @type {() => void} */ call) => (listeners[kind] ??= []).push(call),
  requestAnimationFrame: (/** @type {(now: number) => void} */ call) => frames.push(call),
  setInterval() {},
  MutationObserver: class { observe() {} },
  localStorage: {
    getItem: (/** @type {string} */ key) => storage[key] ?? null,
    setItem: (/** @type {string} */ key, /** @type {string} */ text) => { storage[key] = text; },
  },
  document: {
    documentElement: {},
    body: { append: (/** @type {object} */ made) => { hint = made; } },
    createElement: () => ({ style: {}, hidden: false, setAttribute() {}, remove() { hint = null; } }),
    querySelector(/** @type {string} */ selector) {
      return (selector === ".springtide-stopped" ? page.isStopped : !page.isCovered) ? {} : null;
    },
  },
  __viserMutable: {
    camera: { position: place },
    canvas: { getBoundingClientRect: () => ({ left: 0, right: 800, top: 0, bottom: 600, width: 800, height: 600 }) },
    get nodeRefFromName() {
      return { ...(page.hasRope && { "/rope": { children: [mesh] } }), "/pull": { visible: page.isPulled } };
    },
  },
});
await import("./js/page/drag_hint.js");

/** @param {string} kind */
const point = (kind) => listeners[kind].forEach((call) => call());
let now = 1000; // [ms]

// The next frame of the browser, some time later. A pointer that moves asks for it.
/** @param {number} later [ms] */
function frame(later) {
  now += later;
  point("pointermove");
  frames.splice(0).forEach((call) => call(now));
}
const isShown = () => hint !== null && !hint.hidden;

// The same random numbers in every run: a linear congruential generator, W. H. Press et al., "Numerical Recipes", 7.1.
let seed = 1;
const random = () => (seed = (1664525 * seed + 1013904223) % 2 ** 32) / 2 ** 32;

test("in 500 random acts \"Drag me\" is on the page only with a rope in the picture of a run that has not stopped", () => {
  let shown = 0, hidden = 0;
  for (let act = 0; act < 500; act++) {
    const kind = Math.floor(5 * random());
    if (kind === 0) page.hasRope = !page.hasRope;
    else if (kind === 1) page.isStopped = !page.isStopped;
    else if (kind === 2) page.isCovered = !page.isCovered;
    else if (kind === 3) page.end = [3 * random() - 1.5, 3 * random() - 1.5];
    else point(random() < 0.5 ? "pointerdown" : "pointerup"); // no rope is pulled
    frame(15); // all acts are within the time of the hint
    const isInPicture = page.end.every((at) => Math.abs(at) <= 1.2);
    assert.equal(isShown(), page.hasRope && !page.isStopped && !page.isCovered && isInPicture);
    if (isShown()) shown += 1;
    else hidden += 1;
  }
  assert.ok(shown > 20 && hidden > 20);
});

test("it goes for good once the rope is pulled, in this browser", () => {
  Object.assign(page, { hasRope: true, isStopped: false, isCovered: false, end: [0, 0] });
  point("pointerup");
  page.isPulled = true; // by another browser
  frame(15);
  assert.ok(isShown());
  point("pointerdown");
  frame(15);
  assert.ok(!isShown());
  assert.equal(storage["springtide-dragged"], "yes");
  page.isPulled = false;
  frame(15);
  assert.ok(!isShown());
});
