// A smaller copy of the photograph of the sky, which is drawn in its place without a graphics card.
//
// Before three draws with a photograph, it blurs it for reflections. In software this takes four seconds for 1024 x 512
// pixels, and half a second for the copy.

import { QUALITY } from "../shading/quality.js";
import { LINEAR } from "../shading/three.js";

const SMALL_SKY = 256; // [pixels] width of the copy; the table of the sky has as many columns
const halves = new WeakMap(); // photograph or copy -> copy of half its width; null where it cannot be made

// Of three this uses the frame buffer of a target, which is missing if another renderer has drawn it.
function halve(renderer, larger) {
  const { renderTarget, image, mapping, type, format } = larger, gl = renderer.getContext();
  const framebufferOf = (target) => renderer.properties.get(target).__webglFramebuffer;
  if (!renderTarget || !framebufferOf(renderTarget)) return null;
  const [width, height] = [image.width >> 1, image.height >> 1], before = renderer.getRenderTarget();
  const how = { type, format, minFilter: LINEAR, magFilter: LINEAR, depthBuffer: false };
  const target = new renderTarget.constructor(width, height, how), { texture } = target;
  texture.mapping = mapping;
  renderer.initRenderTarget(target);
  renderer.state.bindFramebuffer(gl.READ_FRAMEBUFFER, framebufferOf(renderTarget));
  renderer.state.bindFramebuffer(gl.DRAW_FRAMEBUFFER, framebufferOf(target));
  gl.blitFramebuffer(0, 0, image.width, image.height, 0, 0, width, height, gl.COLOR_BUFFER_BIT, gl.LINEAR);
  renderer.state.bindFramebuffer(gl.READ_FRAMEBUFFER, null);
  renderer.setRenderTarget(before);
  larger.addEventListener("dispose", () => {
    texture.dispose(); // and what is made of it
    target.dispose();
  });
  return texture;
}

// Give the scene the smaller copy. It is the same at all qualities: another size would need other programs.
export function shrinkPhotograph(renderer, scene) {
  while (QUALITY.isSoftware() && scene.environment?.image?.width > SMALL_SKY) {
    const larger = scene.environment;
    if (!halves.has(larger)) halves.set(larger, halve(renderer, larger));
    if (!halves.get(larger)) return;
    scene.environment = halves.get(larger);
  }
}
