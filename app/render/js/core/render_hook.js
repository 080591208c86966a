// Calls parts before each frame that three draws of viser's scene, so that a new material of viser's never shows without its
// shader, and the camera stands above the water of the frame.

import { page } from "./life.js";
import { viewer } from "./viewer.js";
import { onFrame } from "./watch.js";

const parts = { data: null, camera: null, materials: null }; // in the order in which they are called

// stage: "data", "camera" or "materials". part(renderer, scene, camera).
export function beforeRender(stage, part) {
  parts[stage] = part;
}

let hooked = null; // the scene; viser makes another one with a new canvas
onFrame(() => {
  const own = viewer()?.scene;
  if (!own || hooked === own || !viewer().nodeRefFromName) return;
  hooked = own;
  const earlier = own.onBeforeRender;
  own.onBeforeRender = function (renderer, scene, camera, target) {
    for (const part of page.signal.aborted ? [] : Object.values(parts)) part?.(renderer, scene, camera);
    earlier.call(this, renderer, scene, camera, target);
  };
  viewer().requestRender();
});
