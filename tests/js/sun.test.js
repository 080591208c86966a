import assert from "node:assert/strict";
import { test } from "node:test";
import { drawOneLightOfEachSun } from "./js/scene/sun.js";

/** @param {object} color @param {number} intensity */
const light = (color, intensity) => ({ isDirectionalLight: true, castShadow: true, visible: true, color, intensity });

test("of the lights of one sun the middle one is drawn, with the light of all, each frame anew", () => {
  const sun = {}, moon = {}, children = [light(sun, 1), light(moon, 7), light(sun, 2), light(sun, 3), { isMesh: true }];
  const scene = /** @type {three.Scene} */ (/** @type {unknown} */ ({ children }));
  for (let frame = 0; frame < 2; frame++) {
    drawOneLightOfEachSun(scene);
    assert.deepEqual(children.map((one) => "visible" in one && one.visible && one.intensity), [false, 7, 6, false, false]);
  }
});
