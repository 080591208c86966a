// Calls parts before three draws a frame of viser's scene, so that a new material never shows without its shader, and the
// camera is above the water of the frame.

import { page } from "./life.js";
import { viewer } from "./viewer.js";
import { onFrame, wake } from "./watch.js";

/** @typedef {(renderer: three.Renderer, scene: three.Scene, camera: three.Camera) => void} Part */
/** @type {{ data: Part | null, camera: Part | null, materials: Part | null }} */
const parts = { data: null, camera: null, materials: null }; // in the order in which they are called

// stage: "data", "camera" or "materials". part(renderer, scene, camera).
/** @param {keyof typeof parts} stage @param {Part} part */
export function beforeRender(stage, part) {
  parts[stage] = part;
}

/** @type {three.Scene | null} */
let hooked = null; // viser makes a new one with a new canvas
onFrame(() => {
  const now = viewer(), own = now?.scene;
  if (!own || !now.nodeRefFromName) return wake(); // the first frame should find the parts
  if (hooked === own) return;
  hooked = own;
  const earlier = own.onBeforeRender;
  own.onBeforeRender = function (renderer, scene, camera, target) {
    for (const part of page.signal.aborted ? [] : Object.values(parts)) part?.(renderer, scene, camera);
    earlier.call(this, renderer, scene, camera, target);
    wake();
  };
  now.requestRender();
});
