// The number of the graphics context. Textures drawn into are lost with their context, so every cache of such a texture has the
// number in its key.

import { notice } from "../core/notice.js";
import { springtide } from "../core/springtide.js";
import { viewer } from "../core/viewer.js";

const PATIENCE = 5000; // [ms] after which a lost context is reported: most return at once
const LOST = "springtide-lost"; // identifier of that sentence
let number = 0;

export const contextNumber = () => number;

function next() {
  springtide.contexts = number += 1;
}

// True if a renderer can draw into float textures, and the browser can make their mipmaps.
/** @param {three.Renderer} renderer */
export const drawsFloats = ({ extensions }) =>
  extensions.has("EXT_color_buffer_float") || extensions.has("EXT_color_buffer_half_float");

// Follow the context of a renderer. life: of the renderer.
/** @param {three.Renderer} renderer @param {import("../core/life.js").Life} life */
export function followContext(renderer, life) {
  next();
  const { domElement: canvas } = renderer;
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  life.own(() => clearTimeout(timer));
  life.listen(canvas, "webglcontextlost", () => {
    const words = "This page has lost its graphics. Reload it if the picture does not return.";
    timer = setTimeout(() => notice(LOST, words), PATIENCE);
  });
  life.listen(canvas, "webglcontextrestored", () => {
    clearTimeout(timer);
    notice(LOST, "");
    next();
    viewer()?.requestRender();
  });
}
