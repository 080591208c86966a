// Labels on a separate canvas over the picture: at the full resolution of the screen at every quality, without overlaps.
//
// A label that would cover another is raised above it, or lowered at the upper edge of the picture, with a line to its place.
// Images and clips contain the labels, and so does the page without this script.
//
// Of viser this file uses the meshes of its labels, which stand in one group: those with the uniform uLabelData, a texture
// of four numbers for each label, its place and whether it is visible; and of the mesh of their backgrounds the attributes
// aLabelIndex, aRect and aParams, which its vertex shader explains. Labels with a size in the scene stay in place: they shrink
// with their objects.

import { page } from "../core/life.js";
import { springtide } from "../core/springtide.js";
import { startedViewer } from "../core/viewer.js";
import { followContext } from "../shading/context.js";
import { isDark } from "../shading/dark.js";
import { QUALITY } from "../shading/quality.js";
import { replaceShader } from "../shading/shaders.js";
import { raises } from "./label_layout.js";

const LABEL_TEXTURE = 4096; // [pixels] width of viser's texture of places
const MAX_LEADERS = 64; // lines from moved labels to their places
const TOP = 1; // the upper edge of the picture
const LEADER_WIDTH = 0.1; // of such a line, in heights of a label
const LEADER_FRAGMENT = "void main() { gl_FragColor = vec4(0.45, 0.49, 0.54, 1.0); }";
// The colours of labels on a dark floor. If a new viser has other lines, labels keep their colours.
const LABEL_COLOURS = [
  ["gl_FragColor = vec4(0.0, 0.0, 0.0, a);", "gl_FragColor = vec4(0.91, 0.93, 0.95, a);"],
  ["gl_FragColor = vec4(1.0, 1.0, 1.0, 0.85 * vAlpha);", "gl_FragColor = vec4(0.10, 0.12, 0.15, 0.85 * vAlpha);"],
];

/** @type {three.Object3D | null} */
let labelGroup = null; // of viser's meshes
/** @type {three.Mesh | null} */
let leaders = null; // the mesh of all lines
/** @type {three.Renderer | false | null} */
let overlay = null; // the renderer of the canvas over the picture; false if the browser refuses one
/** @type {Map<number, [from: number[], to: number[]]>} */
let raised = new Map(); // index of a moved label -> its place in viser, and its drawn place, [x, y, z] each

/** @param {three.Scene} scene */
function findLabels(scene) {
  if (!labelGroup?.parent) {
    /** @type {three.Mesh[]} */
    const found = [];
    scene.traverse((object) => {
      if (object.material?.uniforms?.uLabelData) found.push(object);
    });
    leaders = null;
    labelGroup = found[0]?.parent ?? null;
    labelGroup?.getObjectByName("springtide-leaders")?.removeFromParent(); // of an earlier connection
  }
  return labelGroup ? labelGroup.children.filter((mesh) => mesh !== leaders) : [];
}

/** @param {three.Mesh[]} meshes */
function darkenLabels(meshes) {
  const dark = isDark();
  for (const { material } of meshes) {
    replaceShader(material, `springtide-label-${dark ? "dark" : "light"}`, (shader) => {
      if (!dark) return;
      for (const [light, other] of LABEL_COLOURS) shader.fragmentShader = shader.fragmentShader.replace(light, other);
    });
  }
}

// Keep the size of letters on the screen: viser's own shrinks with the part of the picture that panels leave free (camera.js).
/** @param {three.Mesh[]} meshes @param {three.Camera} camera */
function keepSize(meshes, { projectionMatrix: { elements } }) {
  const isPerspective = elements[15] === 0;
  for (const { material: { uniforms } } of isPerspective ? meshes : []) {
    if (uniforms.uFovScale) uniforms.uFovScale.value = 1 / elements[5];
  }
}

// The rectangles of the visible labels with a size on the screen, in coordinates from -1 to 1 across the picture.
/** @param {three.Mesh} mesh @param {three.Camera} camera */
function labelBoxes({ geometry, material }, camera) {
  const { aLabelIndex, aRect, aParams } = geometry.attributes;
  const { uLabelData, uFovScale, uViewportHeight } = material.uniforms;
  const numbers = uLabelData.value.image.data, boxes = [];
  const [across, , , , , upwards] = camera.projectionMatrix.elements;
  for (let k = 0; k < geometry.instanceCount; k++) {
    const index = aLabelIndex.getX(k), at = 4 * index, [from, to] = raised.get(index) ?? [];
    if (!numbers[at + 3] || aParams.getX(k) < 0.5) continue;
    // Unless viser has written since, the label is still at its raised place.
    if (to?.every((number, axis) => number === numbers[at + axis])) numbers.set(from, at);
    const place = camera.position.clone().fromArray(numbers, at), { x, y } = place.clone().project(camera);
    const depth = -place.clone().applyMatrix4(camera.matrixWorldInverse).z;
    if (depth <= 0) continue;
    // One unit of a rectangle over the depth; viser's letters have the size that they have 10 m away in 800 pixels.
    const unit = (aParams.getY(k) * uFovScale.value * 80) / uViewportHeight.value;
    const [left, bottom] = [x + unit * across * aRect.getX(k), y + unit * upwards * aRect.getY(k)];
    const [width, height] = [unit * across * aRect.getZ(k), unit * upwards * aRect.getW(k)];
    const rows = aRect.getW(k);
    boxes.push({ k, index, at, place, y, left, right: left + width, bottom, height, rows, unit: unit * depth });
  }
  return boxes;
}

// Move labels, the lowest first, until none covers another.
/** @param {three.Mesh} mesh @param {three.Camera} camera */
function arrangeLabels(mesh, camera) {
  const { value: texture } = mesh.material.uniforms.uLabelData, numbers = texture.image.data;
  const boxes = labelBoxes(mesh, camera).sort((a, b) => a.y - b.y || a.index - b.index), lines = [];
  const up = camera.position.clone().setFromMatrixColumn(camera.matrixWorld, 1);
  raised = new Map();
  for (const [n, raise] of raises(boxes, TOP).entries()) {
    const box = boxes[n];
    if (raise === null) numbers[box.at + 3] = 0;
    if (!raise) continue;
    const from = box.place.toArray();
    box.place.addScaledVector(up, raise * box.rows * box.unit).toArray(numbers, box.at);
    raised.set(box.index, [from, Array.from(numbers.subarray(box.at, box.at + 3))]);
    lines.push({ ...box, length: raise * box.rows });
  }
  texture.needsUpdate = true;
  drawLeaders(mesh, lines.slice(0, MAX_LEADERS));
}

// A line is a narrow rectangle below the place of a raised label, or above that of a lowered one, as viser's vertex shader draws
// them.
/** @param {three.Mesh} mesh @param {{ k: number, index: number, rows: number, length: number }[]} lines */
function drawLeaders({ geometry, material, renderOrder, constructor }, lines) {
  if (!leaders && (!lines.length || !labelGroup)) return;
  if (!leaders) {
    const made = new geometry.constructor(), { vertexShader, uniforms } = material;
    made.index = geometry.index.clone();
    made.setAttribute("position", geometry.attributes.position.clone());
    for (const [name, size] of /** @type {const} */ ([["aLabelIndex", 1], ["aParams", 2], ["aRect", 4]])) {
      made.setAttribute(name, new geometry.attributes[name].constructor(new Float32Array(size * MAX_LEADERS), size));
    }
    const how = { vertexShader, uniforms, fragmentShader: LEADER_FRAGMENT, depthTest: false, depthWrite: false };
    leaders = new constructor(made, new material.constructor({ ...how, transparent: true }));
    Object.assign(leaders, { name: "springtide-leaders", frustumCulled: false, renderOrder });
    leaders.userData.springtideDerived = true;
    labelGroup?.add(leaders);
  }
  const { aLabelIndex, aParams, aRect } = leaders.geometry.attributes;
  lines.forEach(({ k, index, rows, length }, line) => {
    const width = LEADER_WIDTH * rows;
    aLabelIndex.setX(line, index);
    aParams.setXY(line, 1, geometry.attributes.aParams.getY(k));
    aRect.setXYZW(line, -width / 2, Math.min(-length, 0), width, Math.abs(length));
  });
  leaders.geometry.instanceCount = lines.length;
  for (const attribute of [aLabelIndex, aParams, aRect]) attribute.needsUpdate = true;
}

// The renderer of the canvas over the picture, of the same size; null if the browser refuses one.
/** @param {three.Renderer} renderer */
function overlayOf(renderer) {
  const picture = renderer.domElement, { clientWidth: width, clientHeight: height } = picture;
  const earlier = /** @type {HTMLCanvasElement | null} */ (document.getElementById("springtide-labels"));
  overlay ??= earlier?.springtideRenderer ?? makeOverlay(renderer);
  if (!overlay || !width || !height) return null;
  const { domElement: canvas } = overlay;
  if (canvas.previousSibling !== picture) picture.after(canvas);
  if (overlay.getPixelRatio() !== devicePixelRatio) overlay.setPixelRatio(devicePixelRatio);
  if (canvas.clientWidth !== width || canvas.clientHeight !== height) overlay.setSize(width, height);
  return overlay;
}

/** @param {three.Renderer} renderer */
function makeOverlay(renderer) {
  const canvas = document.createElement("canvas");
  canvas.id = "springtide-labels";
  canvas.style.cssText = "position:absolute;top:0;left:0;pointer-events:none";
  let made;
  try {
    const reversedDepthBuffer = renderer.state.buffers.depth.getReversed();
    made = new renderer.constructor({ canvas, alpha: true, depth: false, reversedDepthBuffer });
  } catch {
    return false;
  }
  canvas.removeAttribute("data-engine"); // which identifies the canvas of the picture
  canvas.springtideRenderer = made;
  followContext(made, page);
  return made;
}

// Called before each frame is drawn.
/** @param {three.Renderer} renderer @param {three.Scene} scene @param {three.Camera} camera */
export function dressLabels(renderer, scene, camera) {
  const meshes = findLabels(scene);
  if (!labelGroup || !meshes.length) return;
  // three shrinks the texture if the browser allows only small ones (Firefox resisting fingerprinting): labels would be wrong.
  labelGroup.visible = renderer.capabilities.maxTextureSize >= LABEL_TEXTURE;
  if (!labelGroup.visible) return;
  darkenLabels(meshes);
  keepSize(meshes, camera);
  const backgrounds = meshes.find(({ material }) => !material.uniforms.uAtlas && !material.depthTest);
  if (backgrounds?.geometry.attributes.aRect) arrangeLabels(backgrounds, camera);
  labelGroup.visible = true;
  if (QUALITY.isCapturing() || camera !== startedViewer().camera) return;
  const used = !springtide.isRecording && meshes.some(({ geometry }) => geometry.instanceCount > 0);
  const over = used ? overlayOf(renderer) : null;
  over?.render(labelGroup, camera);
  labelGroup.visible = !over;
  if (overlay) overlay.domElement.style.visibility = over ? "" : "hidden";
}
