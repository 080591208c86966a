import assert from "node:assert/strict";
import { test } from "node:test";
import { Life } from "./js/core/life.js";
import { store, stored } from "./js/core/storage.js";
import { send } from "./js/core/viewer.js";
import { wrapMethod } from "./js/shading/wrap.js";

test("the end of a life takes its listeners away and disposes in reverse order, once", () => {
  const life = new Life(), target = new EventTarget();
  /** @type {string[]} */
  const heard = [];
  life.listen(target, ["click", "input"], ({ type }) => heard.push(type));
  life.own(() => heard.push("first"));
  life.own(() => heard.push("second"));
  target.dispatchEvent(new Event("click"));
  target.dispatchEvent(new Event("input"));
  life.end();
  life.end();
  target.dispatchEvent(new Event("click"));
  assert.deepEqual(heard, ["click", "input", "second", "first"]);
});

test("a method is replaced until the life ends, by two lives one in the other too", () => {
  const first = new Life(), second = new Life(), object = { say: () => "a" }, { say } = object;
  wrapMethod(first, object, "say", (earlier) => () => `${earlier()}b`);
  wrapMethod(second, object, "say", (earlier) => () => `${earlier()}c`);
  assert.equal(object.say(), "abc");
  second.end();
  assert.equal(object.say(), "ab");
  first.end();
  assert.equal(object.say, say);
});

test("where storage is refused, what is stored holds until the page is left", () => {
  Object.defineProperty(globalThis, "localStorage", { get: () => assert.ok(false) });
  assert.equal(stored("name"), null);
  assert.equal(store("name", "a"), false);
  assert.equal(stored("name"), "a");
});

// The parts of viser's client that `send` uses, and what it has sent since.
function connected() {
  /** @type {string[]} */
  const sent = [];
  const mutable = {
    /** @type {object | null} */
    cameraControl: null,
    /** @type {(() => void) | null | undefined} */
    sendCamera: null,
    /** @type {((message: { updates: { value: string } }) => void) | null} */
    sendMessage: ({ updates }) => sent.push(updates.value),
  };
  globalThis.window = /** @type {any} */ ({ __viserMutable: mutable });
  return { sent, mutable };
}

test("the camera goes before the first value of a connection, as the server knows nobody without", (context) => {
  context.mock.timers.enable({ apis: ["setTimeout"] });
  const { sent, mutable } = connected();
  assert.equal(send("field", "a link"), true);
  context.mock.timers.tick(50);
  assert.deepEqual(sent, []); // the page has no camera yet
  mutable.sendCamera = () => sent.push("camera");
  mutable.cameraControl = {};
  context.mock.timers.tick(50);
  assert.deepEqual(sent, ["camera"]);
  assert.equal(send("field", "another"), true);
  assert.deepEqual(sent, ["camera"]);
  context.mock.timers.tick(50);
  assert.equal(send("field", "a third"), true);
  assert.deepEqual(sent, ["camera", "a link", "another", "a third"]);
  mutable.sendMessage = ({ updates }) => sent.push(updates.value); // viser makes another with each connection
  sent.length = 0;
  assert.equal(send("field", "after a cut line"), true);
  mutable.sendMessage = ({ updates }) => sent.push(updates.value); // and is cut once more
  context.mock.timers.tick(50);
  assert.deepEqual(sent, ["camera", "camera"]);
  context.mock.timers.tick(50);
  assert.deepEqual(sent, ["camera", "camera", "after a cut line"]);
});

test("without an element or a connection nothing is sent, and a viser that sends no camera is not waited for", () => {
  const { sent, mutable } = connected();
  mutable.sendCamera = undefined;
  assert.equal(send(undefined, "a"), false);
  assert.equal(send("field", "b"), true);
  mutable.sendMessage = null;
  assert.equal(send("field", "c"), false);
  assert.deepEqual(sent, ["b"]);
});
