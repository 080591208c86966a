import assert from "node:assert/strict";
import { test } from "node:test";
import { Life } from "./js/core/life.js";
import { store, stored } from "./js/core/storage.js";
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
