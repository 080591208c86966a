// The photograph of the sky: a smaller copy without a graphics card, a new one after a lost graphics context, and a sky by
// formula if the browser cannot draw into floats, as viser does with the photograph.
//
// Before three draws with a photograph, it blurs it for reflections. In software this takes four seconds for 1024 x 512
// pixels, and half a second for the copy. viser draws the photograph only once, and a lost context takes it away: so its
// numbers are read once, asynchronously, to restore it from them.
//
// The lab sends the name of a sky before its photograph. Until that is decoded, viser's client draws the previous sky, or at first
// its default.

import { topicState } from "../core/channel.js";
import { toHalf } from "../sea/half_floats.js";
import { contextNumber, drawsFloats } from "../shading/context.js";
import { QUALITY } from "../shading/quality.js";
import { BLURRED_CUBE, FLOAT, HALF_FLOAT, LINEAR } from "../shading/three.js";
import { blurredCube, ROOM } from "./formula_sky.js";

const SMALL_SKY = 256; // [pixels] width of the copy; the table of the sky has as many columns
const KEPT_SKY = 512; // [pixels] greatest width of the restored photograph
/** @type {WeakMap<three.Texture, three.Texture | null>} */
const smallerCopies = new WeakMap(); // photograph or copy -> copy of half its width; null if it cannot be made
/**
 * Of a photograph or copy. context: number of the context that it was drawn in; again: the restored texture.
 * @typedef {{ numbers: Uint16Array, width: number, height: number }} Kept
 * @typedef {{ context: number, kept: Kept | null, again: three.Texture | null }} State
 */
/** @type {WeakMap<three.Texture, State>} */
const known = new WeakMap();

// Name of the sky in each photograph and its substitutes: the one that the lab had named when it was first seen, or "" for the
// one that viser's client shows before the lab's: no background, at full intensity.
/** @type {WeakMap<three.Texture, string>} */
const names = new WeakMap();

/** @param {three.Scene} scene */
export function nameSky({ environment, background, environmentIntensity }) {
  if (!environment || names.has(environment)) return;
  const isOfLab = background || environmentIntensity !== 1;
  names.set(environment, (isOfLab && topicState("picture")?.sky) || "");
}

// Name of the sky that lights the scene; "" without one of the lab.
/** @param {three.Scene} scene */
export const skyOf = ({ environment }) => (environment && names.get(environment)) ?? "";

/** @param {three.Texture} photograph @param {three.Texture} other */
function passName(photograph, other) {
  names.set(other, names.get(photograph) ?? "");
}

// A copy of half the width, in another target. Of three this uses the frame buffer of the target; null if it is missing because
// another renderer has drawn it.
/** @param {three.Renderer} renderer @param {three.Texture} larger @param {number} type */
function halve(renderer, larger, type = larger.type) {
  const { renderTarget, image, mapping, format } = larger, gl = renderer.getContext();
  const framebufferOf = (/** @type {three.Target} */ target) => renderer.properties.get(target).__webglFramebuffer;
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
    texture.dispose(); // and the textures derived from it
    target.dispose();
  });
  return texture;
}

// Read the numbers of a photograph, at half its width at most.
/** @param {three.Renderer} renderer @param {three.Texture} photograph @param {State} state */
function keepNumbers(renderer, photograph, state) {
  const limit = QUALITY.isSoftware() ? SMALL_SKY : KEPT_SKY;
  /** @type {three.Texture | null} */
  let small = photograph;
  while (small && (small === photograph || small.image.width > limit)) small = halve(renderer, small, FLOAT);
  const target = small?.renderTarget;
  if (!small || !target) return;
  const { width, height } = small.image, floats = new Float32Array(4 * width * height);
  const take = () => {
    state.kept = { numbers: Uint16Array.from(floats, toHalf), width, height };
    target.dispose();
  };
  // It fails if the context is lost.
  renderer.readRenderTargetPixelsAsync(target, 0, 0, width, height, floats).then(take, () => {});
}

/** @param {three.Texture} photograph @param {Kept} kept */
function textureOf(photograph, { numbers, width, height }) {
  const made = photograph.clone();
  made.source = new photograph.source.constructor({ data: numbers, width, height });
  Object.assign(made, { isDataTexture: true, isRenderTargetTexture: false, type: HALF_FLOAT });
  Object.assign(made, { generateMipmaps: false, flipY: false, unpackAlignment: 4, renderTarget: photograph.renderTarget });
  made.needsUpdate = true;
  return made;
}

// Replace a texture by another throughout the scene.
/** @param {three.Scene} scene @param {three.Texture} photograph @param {three.Texture} other */
function replace(scene, photograph, other) {
  passName(photograph, other);
  if (scene.environment === photograph) scene.environment = other;
  if (scene.background === photograph) scene.background = other;
  if (scene.userData.photograph === photograph) scene.userData.photograph = other;
}

/** @param {three.Renderer} renderer @param {three.Texture} photograph */
function stateOf(renderer, photograph) {
  let state = known.get(photograph);
  if (!state) {
    state = { context: contextNumber(), kept: null, again: null };
    const own = state, { renderTarget } = photograph;
    known.set(photograph, state);
    // viser disposes only of the texture, not of the target that it was drawn into.
    photograph.addEventListener("dispose", () => {
      renderTarget?.dispose();
      own.again?.dispose();
    });
    if (renderer.extensions.has("EXT_color_buffer_float")) keepNumbers(renderer, photograph, state);
  }
  return state;
}

/** @type {{ key: string, texture: three.Texture } | null} */
let formed = null; // the sky by formula in use

// The sky by formula in the place of a photograph, or of the last one.
/** @param {three.Texture} photograph @param {SkyColors} sky */
function formSky(photograph, sky) {
  const key = [...sky.low, ...sky.high].join();
  if (formed?.key !== key) {
    formed?.texture.dispose();
    formed = { key, texture: Object.assign(textureOf(photograph, blurredCube(sky)), { mapping: BLURRED_CUBE }) };
  }
  return formed.texture;
}

// Give the scene the smaller copy, the same at all qualities since another size would need other programs, or the restored
// photograph if it was lost.
/** @param {three.Renderer} renderer @param {three.Scene} scene @param {SkyColors | null} sky */
export function preparePhotograph(renderer, scene, sky) {
  nameSky(scene);
  if (scene.environment && !drawsFloats(renderer)) {
    replace(scene, scene.environment, formSky(scene.environment, sky ?? ROOM));
    return;
  }
  while (QUALITY.isSoftware() && scene.environment && scene.environment.image?.width > SMALL_SKY) {
    const larger = scene.environment;
    if (!smallerCopies.has(larger)) smallerCopies.set(larger, halve(renderer, larger));
    const smaller = smallerCopies.get(larger);
    if (!smaller) break;
    known.set(smaller, stateOf(renderer, larger));
    passName(larger, smaller);
    scene.environment = smaller;
  }
  const photograph = scene.environment;
  if (!photograph?.renderTarget || photograph.isDataTexture) return;
  const state = stateOf(renderer, photograph);
  if (state.context === contextNumber() || !state.kept) return;
  state.again ??= textureOf(photograph, state.kept);
  replace(scene, photograph, state.again);
}
