import assert from "node:assert/strict";
import { test } from "node:test";
import { latinKey } from "./js/panel/layouts.js";

/** @param {string} key @param {string} code */
const pressed = (key, code, shiftKey = false, altKey = false) => Object.values(latinKey({ key, code, shiftKey, altKey }));

test("a key with a Latin letter is that letter, wherever it is", () => {
  assert.deepEqual(pressed("g", "KeyU"), ["g", false]); // Dvorak
  assert.deepEqual(pressed("y", "KeyZ"), ["y", false]); // QWERTZ
  assert.deepEqual(pressed("Z", "KeyW", true), ["Z", true]); // AZERTY
});

test("a key of another script is the letter at its place", () => {
  assert.deepEqual(pressed("г", "KeyU"), ["u", false]);
  assert.deepEqual(pressed("Я", "KeyZ", true), ["z", true]);
  assert.deepEqual(pressed("ж", "Semicolon"), ["ж", false]);
  assert.deepEqual(pressed("©", "KeyG", false, true), ["©", false]); // Option on a Mac
});

test("a digit needs no Shift, and may have it where it is above the other sign", () => {
  assert.deepEqual(pressed("é", "Digit2"), ["2", false]); // AZERTY
  assert.deepEqual(pressed("2", "Digit2", true), ["2", false]);
  assert.deepEqual(pressed("2", "Digit2"), ["2", false]);
  assert.deepEqual(pressed("@", "Digit2", true), ["@", true]); // QWERTY
  assert.deepEqual(pressed("2", "Numpad2"), ["2", false]);
});

test("keys without a sign stay as they are", () => {
  for (const name of ["Enter", "ArrowUp", "Escape", "Dead"]) assert.deepEqual(pressed(name, name), [name, false]);
  assert.deepEqual(pressed(" ", "Space"), [" ", false]);
});
