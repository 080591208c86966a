// The number of the graphics context. What was drawn into a texture is lost with it, and every cache of such a texture has
// the number in its key.

import { springtide } from "../core/springtide.js";
import { viewer } from "../core/viewer.js";

let number = 0;

export const contextNumber = () => number;

function next() {
  springtide.contexts = number += 1;
}

// Follow the context of a renderer. life: of the renderer.
export function followContext(renderer, life) {
  next();
  const { domElement: canvas } = renderer;
  life.listen(canvas, "webglcontextrestored", () => {
    next();
    viewer()?.requestRender();
  });
}
