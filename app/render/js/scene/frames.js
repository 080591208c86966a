// Draws a frame only if something in it has changed since the last one, and one frame at a time.
//
// viser draws once a second in any case, and for a quarter of a second after each request. Here `render` of its renderer
// compares the inputs of the frame with those of the last one, and returns early if they are equal: the canvas keeps its
// pixels. Frames for clips and for images for the server are always drawn.
//
// Of three this file uses the renderer's render and setSize, the versions of attributes, materials and textures, and the
// values of materials and uniforms. Anything that it cannot compare counts as changed.

import { topicState } from "../core/channel.js";
import { springtide } from "../core/springtide.js";
import { viewer } from "../core/viewer.js";
import { awaitsSky } from "../sea/sky_table.js";
import { isDark } from "../shading/dark.js";
import { QUALITY } from "../shading/quality.js";
import { lacksPrograms, programsReady } from "../shading/shaders.js";
import { BOTH_SIDES } from "../shading/three.js";
import { wrapMethod } from "../shading/wrap.js";
import { awaitsLight, skiesRead } from "./ambient.js";
import { skyOf } from "./photograph.js";

const SMALL = 16384; // size up to which a texture's numbers are compared: viser increments the version of labels in each frame
const LONG_FRAME = 100; // [ms] of a frame, above which time is left for the panel
const FRAMES_LEFT = 2; // left to the panel after a press in it

/** @typedef {unknown[] & { textures: Set<object> }} Inputs */

const isNumbers = /** @type {(value: unknown) => value is Float32Array} */ (ArrayBuffer.isView);

/** @param {Inputs} list @param {any} value of any kind */
function addValue(list, value) {
  if (value?.isTexture) {
    const numbers = value.image?.data;
    list.push(value);
    if (list.textures.has(value)) return; // labels share one
    list.textures.add(value);
    if (numbers?.length <= SMALL) for (const number of numbers) list.push(number);
    else list.push(value.enqueueUpdate ? {} : value.version, numbers); // of instances: its version does not change
  } else if (value?.toArray) for (const number of value.toArray()) list.push(number);
  else if (Array.isArray(value) || (isNumbers(value) && value.length <= SMALL)) {
    for (const one of value) addValue(list, one);
  } else list.push(value);
}

// An attribute of a geometry. Its own writes (packed.js) follow from data that is in the list.
/** @param {Inputs} list @param {three.Attribute | undefined} attribute */
function addAttribute(list, attribute) {
  if (!attribute || attribute.springtide) return;
  const { array, version, springtideWrites = 0 } = attribute.data ?? attribute;
  list.push(array, version - springtideWrites);
}

/** @param {Inputs} list @param {any} object of any class */
function addObject(list, object) {
  if (object.userData.springtideDerived) return; // derived from the others
  const { geometry, material } = object;
  list.push(object, object.visible, object.renderOrder, geometry);
  if (object.matrixAutoUpdate) for (const part of ["position", "quaternion", "scale"]) addValue(list, object[part]);
  else addValue(list, object.matrix);
  if (!object.matrixWorldAutoUpdate) addValue(list, object.matrixWorld);
  if (object.isSkinnedMesh) list.push({}); // its bones are not in the scene
  if (object.isLight) {
    for (const part of ["color", "groundColor", "intensity", "distance", "angle", "penumbra", "decay", "castShadow"]) {
      addValue(list, object[part]);
    }
    addValue(list, object.target?.position);
  }
  addValue(list, object.morphTargetInfluences);
  if (geometry) {
    const { attributes } = geometry, packed = attributes.position?.springtideWrites; // normals follow from positions
    for (const name in attributes) if (!packed || name !== "normal") addAttribute(list, attributes[name]);
    addAttribute(list, geometry.index);
    list.push(geometry.drawRange.start, geometry.drawRange.count, geometry.instanceCount, object.count);
    for (const name of ["instanceMatrix", "instanceColor"]) {
      // viser increments its version in each frame
      if (object[name]?.array.length <= SMALL) addValue(list, object[name].array);
      else addAttribute(list, object[name]);
    }
    for (const name of ["matricesTexture", "colorsTexture", "uniformsTexture"]) addValue(list, object[name]);
  }
  for (const one of material ? [material].flat() : []) {
    // three increments the version of a material that it draws in two passes.
    const unread = one.transparent && one.side === BOTH_SIDES && !one.forceSinglePass ? ["uniforms", "version"] : ["uniforms"];
    for (const name in one) {
      if (!unread.includes(name) && typeof one[name] !== "function") addValue(list, one[name]);
    }
    list.push(one.userData.springtide);
    for (const name in one.uniforms) addValue(list, one.uniforms[name].value);
  }
}

// All inputs of a frame, as a list of numbers and objects.
/** @param {three.Renderer} renderer @param {three.Scene} scene @param {three.Camera} camera */
function inputsOf(renderer, scene, camera) {
  const { domElement: canvas, toneMapping, toneMappingExposure, outputColorSpace, shadowMap } = renderer;
  const { details, pixels } = QUALITY.now();
  const own = [
    isDark(), devicePixelRatio, details, pixels, canvas.width, canvas.height, canvas.clientWidth, canvas.clientHeight,
    toneMapping, toneMappingExposure, outputColorSpace, shadowMap.enabled, scene.environmentIntensity,
    scene.backgroundIntensity, scene.backgroundBlurriness, scene.fog, camera, awaitsSky(scene), skiesRead, programsReady,
  ];
  /** @type {Inputs} */
  const list = Object.assign(own, { textures: new Set() });
  const { background, environment, environmentRotation, backgroundRotation, overrideMaterial } = scene;
  const { position, quaternion, projectionMatrix } = camera;
  for (const value of [background, environment, environmentRotation, backgroundRotation, overrideMaterial]) {
    addValue(list, value);
  }
  for (const value of [position, quaternion, projectionMatrix]) addValue(list, value);
  scene.traverse((object) => addObject(list, object));
  return list;
}

// True if a frame of the scene has all parts of the picture: the sky and the nodes that the server counts to it
// (app/render/injection.py), their light, and their shaders. A slow page has them one after the other: a sky of viser's before
// that of the scene, and either before the vertices of a sea. awaitsParts: false once a frame had sky and nodes.
/** @param {three.Scene} scene @param {boolean} awaitsParts */
function isComplete(scene, awaitsParts) {
  if (!scene.environment || awaitsLight() || lacksPrograms) return false;
  if (!awaitsParts) return true;
  const { sky, nodes } = topicState("picture") ?? {};
  return Boolean(sky) && skyOf(scene) === sky && nodes.every((/** @type {string} */ name) => viewer()?.nodeRefFromName[name]);
}

// life: of the renderer.
/** @param {three.Renderer} renderer @param {import("../core/life.js").Life} life */
export function paceFrames(renderer, life) {
  const gl = renderer.getContext(), keepsPixels = gl.getContextAttributes()?.preserveDrawingBuffer;
  /** @type {Inputs | null} */
  let last = null; // the inputs of the frame on the canvas
  /** @type {{ fence: WebGLSync | null, compiled: boolean } | null} */
  let drawing = null; // of that frame until it is drawn: its fence, and whether it has a new program
  let isWhole = false; // true if that frame has its nodes, its sky, its light, and all of its shaders
  let finishedWhole = false; // true if the last drawn frame had, and no frame without them has begun since
  let length = 0; // [ms] of it
  let awaitsParts = true; // true while the cover waits for the sky and the nodes of a scene
  let isStale = false; // true if the next frame is drawn although it has the inputs of the last one
  let started = 0, pressed = 0, left = 0; // time of its start, time of the last press in the panel, frames left to the panel

  // True if the last frame is drawn. Its length is the time until the browser's next frame.
  function isDrawn() {
    if (!drawing) return true;
    const { fence, compiled } = drawing;
    if (fence && gl.getSyncParameter(fence, gl.SYNC_STATUS) !== gl.SIGNALED) return false;
    gl.deleteSync(fence);
    drawing = null;
    finishedWhole = isWhole;
    length = performance.now() - started;
    QUALITY.take(length, started, compiled);
    return true;
  }

  // The graphics process draws by itself: without this wait, the panel would queue behind several frames.
  /** @param {boolean} compiled */
  function awaitEnd(compiled) {
    if (drawing) gl.deleteSync(drawing.fence); // a new size is drawn at once
    const mine = (drawing = { fence: gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0), compiled });
    gl.flush();
    const look = () => {
      if (drawing === mine && !isDrawn()) requestAnimationFrame(look);
    };
    requestAnimationFrame(look);
  }

  // True if the next frame has to wait, for the last one or for the panel to respond to a press.
  function hasToWait() {
    if (!isDrawn()) return true; // in some frames this comes before `look`
    if (length < LONG_FRAME || pressed < started || left >= FRAMES_LEFT) return false;
    left += 1;
    return true;
  }

  // Only frames that begin from now on count.
  springtide.awaitPicture = () => {
    [awaitsParts, isStale, isWhole, finishedWhole] = [true, true, false, false];
    viewer()?.requestRender();
  };
  // The cover then goes. In software a frame is nearly always being drawn.
  springtide.showsWhole = () => {
    const isShown = drawing ? finishedWhole : isWhole;
    if (isShown) awaitsParts = false;
    return isShown;
  };
  let knownPrograms = ""; // with the last frame
  const programs = () => `${renderer.info.programs?.at(-1)?.id} ${programsReady}`;

  wrapMethod(life, renderer, "render", (earlier) => /** @this {three.Renderer} */ function (scene, camera) {
    const { scene: own, camera: eye, requestRender } = viewer() ?? {};
    if (!own || scene !== own || renderer.getRenderTarget()) return void earlier.call(this, scene, camera);
    if (gl.isContextLost()) return;
    makeOpaque(renderer, own);
    if (camera !== eye || QUALITY.isCapturing() || springtide.isRecording || !keepsPixels) {
      last = null;
      earlier.call(this, scene, camera);
      isWhole = isComplete(own, awaitsParts);
      return;
    }
    if (document.visibilityState === "hidden") return;
    const inputs = inputsOf(renderer, own, camera), shown = last;
    if (!isStale && shown?.length === inputs.length && inputs.every((input, k) => Object.is(input, shown[k]))) return;
    if (shown && hasToWait()) return void requestRender?.();
    [started, left] = [performance.now(), 0];
    earlier.call(this, scene, camera);
    [last, isStale] = [inputs, false];
    isWhole = isComplete(own, awaitsParts);
    if (!isWhole) finishedWhole = false;
    const known = programs();
    awaitEnd(known !== knownPrograms);
    knownPrograms = known;
  });
  // It clears the canvas.
  wrapMethod(life, renderer, "setSize", (earlier) => /** @this {three.Renderer} */ function (...size) {
    last = null;
    earlier.apply(this, size);
  });
  // The fence is lost with the context.
  life.listen(renderer.domElement, "webglcontextrestored", () => ([last, drawing] = [null, null]));
  const press = (/** @type {Event} */ { target }) => {
    if (target !== renderer.domElement) pressed = performance.now();
  };
  life.listen(document, ["pointerdown", "keydown", "input"], press, { capture: true, passive: true });
}

// viser fades the canvas in over the first frames with its sky, which takes many seconds if frames are slow.
/** @param {three.Renderer} renderer @param {three.Scene} scene */
export function makeOpaque(renderer, scene) {
  if (scene.environment) renderer.domElement.style.opacity = "1";
}
