// Programs and materials: a new shader for a mesh of viser's, once it is compiled.
//
// Of three this file uses Material.onBeforeCompile and the renderer's property map, to see whether a program linked.

import { startedViewer } from "../core/viewer.js";
import { QUALITY } from "./quality.js";

/** @typedef {(shader: three.Shader) => void} Edit */

/** @type {WeakSet<three.Material>} */
export const refused = new WeakSet(); // materials whose program did not link: they keep viser's own shader

// The mesh of a node is the first child of its group; shadow meshes and child nodes come after it.
/** @param {string} name @returns {three.Mesh | null} */
export function meshOf(name) {
  const group = startedViewer().nodeRefFromName[name];
  return (group && group.children && group.children.find((child) => child.isMesh)) || null;
}

// Give a material another shader; false if its program did not link. Called in every frame, because viser makes a new material
// when wireframe, opacity, flat shading or side change. key: of the shader; edit(shader): changes it.
/** @param {three.Material} material @param {string} key @param {Edit} edit */
export function replaceShader(material, key, edit) {
  if (refused.has(material)) return false;
  if (material.userData.springtide !== key) {
    material.userData.springtide = key;
    material.onBeforeCompile = edit;
    material.customProgramCacheKey = () => key;
    material.needsUpdate = true;
  }
  return true;
}

// Programs that the browser is still compiling, in the background if it has KHR_parallel_shader_compile.
/** @type {Set<three.Program>} */
const awaited = new Set();
const LOOK_INTERVAL = 30; // [ms] between two checks of them
export let programsReady = 0; // number of compiled programs; frames.js draws when it changes
export let lacksPrograms = false; // true if something in this frame does not have its final shader
let isCompiling = false; // true if this frame has compiled a program while the page waited

// A new frame: the page may wait for one more program.
export function beginFrame() {
  isCompiling = lacksPrograms = false;
}

function lookForPrograms() {
  const before = programsReady;
  for (const program of awaited) {
    if (program.program && program.isReady?.() === false) continue; // a deleted one has none
    awaited.delete(program);
    programsReady += 1;
  }
  if (awaited.size > 0) setTimeout(lookForPrograms, LOOK_INTERVAL);
  if (programsReady > before) startedViewer().requestRender();
}

// Give an object a material with another shader once its program is compiled; until then it keeps its own. If the page waits for
// compiling, each frame compiles one program. key: of the shader; edit(shader): changes it; scene: has the lights. True if
// the object has a material with any of our shaders.
/**
 * @param {three.Renderer} renderer @param {three.Mesh} object @param {string} key @param {Edit} edit
 * @param {three.Camera} camera @param {three.Object3D} scene
 */
export function dress(renderer, object, key, edit, camera, scene = object) {
  const { userData } = object, earlier = object.material;
  const materials = (userData.materials ??= new Map([["", earlier]])); // by key of their shader
  const bare = materials.get("") ?? earlier, next = materials.get(key) ?? bare.clone();
  if (!materials.has(key)) {
    materials.set(key, next);
    replaceShader(next, key, edit);
  }
  if (next === earlier) return true;
  object.material = next;
  renderer.compile(object, camera, scene);
  const program = renderer.properties.get(next).currentProgram, isBeside = renderer.extensions.has("KHR_parallel_shader_compile");
  if (QUALITY.isWhole() || (isBeside ? program.isReady?.() !== false : !isCompiling)) {
    isCompiling = true;
    return true;
  }
  if (awaited.size === 0) setTimeout(lookForPrograms, LOOK_INTERVAL);
  awaited.add(program);
  object.material = earlier;
  lacksPrograms = true;
  return earlier !== bare;
}

/** @param {three.Mesh} object */
export function disposeMaterials(object) {
  for (const material of object.userData.materials?.values() ?? [object.material]) material.dispose();
}

// True if the program of a material linked; null if it has none yet. If a driver refuses it, the material gets viser's shader
// back, so that the mesh is still drawn, and the server does not learn of an active shader.
/** @param {three.Renderer} renderer @param {three.Material} material */
export function isLinked(renderer, material) {
  const program = renderer.properties.get(material).currentProgram;
  if (!program) return null; // not drawn yet
  const gl = renderer.getContext();
  if (program.__springtide === undefined) {
    program.__springtide = gl.getProgramParameter(program.program, gl.LINK_STATUS);
  }
  if (program.__springtide) return true;
  refused.add(material);
  material.onBeforeCompile = () => {};
  material.customProgramCacheKey = () => "";
  material.needsUpdate = true;
  return false;
}

// Insert text after the include of one of three's shader chunks.
/**
 * @param {three.Shader} shader @param {"vertexShader" | "fragmentShader"} stage
 * @param {string} chunk @param {string} text
 */
export function insertAfter(shader, stage, chunk, text) {
  shader[stage] = shader[stage].replace(`#include <${chunk}>`, `#include <${chunk}>\n${text}`);
}
