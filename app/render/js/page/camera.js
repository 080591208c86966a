// The camera of the page: it stays above floor and water, and the picture is centred in the part that panels leave free.
//
// Of viser this file uses window.__viserMutable: cameraControl (the camera-controls library), camera, scene (its
// onBeforeRender runs before every frame), nodeRefFromName and requestRender; and the boxes of its panels.
// three's world has y up; the frame of a node has z up.

import { beforeRender } from "../core/render_hook.js";
import { startedViewer, viewer } from "../core/viewer.js";
import { onLook } from "../core/watch.js";
import { PANEL } from "../panel/marks.js";
import { without } from "./free_part.js";
import { waterHeight } from "./water_height.js";

const FLOOR_CLEARANCE = 0.1; // [m] of the camera above the floor
const WATER_CLEARANCE = 0.25; // [m] of the camera above the water
const MAX_WAVE_HEIGHT = 40; // [m] above the mean water; higher cameras need no look at waves
const MIN_ASPECT = 1.05; // least width over height of the field of view, enough for all presets
const OPEN_BAR = '[data-springtide-is~=bar] > [aria-label="Collapse panel Plots"]'; // on a phone

/** @type {(keyof Box)[]} */
const SIDES = ["x", "y", "width", "height"];
/** @type {Box | null} */
let free = null; // the free part of the canvas: { x, y, width, height } [pixels] from its top left corner

function measure() {
  const { canvas: drawn, camera } = viewer() ?? {};
  if (!drawn) return;
  const canvas = drawn.getBoundingClientRect();
  let box = { x: canvas.left, y: canvas.top, width: canvas.width, height: canvas.height };
  const slow = document.getElementById("springtide-slow"); // the line on slow drawing (quality.js)
  const framed = document.documentElement.classList.contains("springtide-framed"); // beside.js
  const bar = document.querySelector(OPEN_BAR)?.parentElement;
  const panels = [...document.querySelectorAll(PANEL), bar, slow].filter((one) => !!one);
  for (const panel of framed ? [] : panels) box = without(box, panel.getBoundingClientRect());
  const found = { x: box.x - canvas.left, y: box.y - canvas.top, width: box.width, height: box.height };
  const earlier = free;
  if (earlier && SIDES.every((key) => Math.abs(earlier[key] - found[key]) < 1)) return;
  free = found;
  if (camera) centre(camera, drawn); // frames.js compares cameras before it draws
  startedViewer().requestRender();
}

// Shift and scale the picture, so that the field of view spans the free rectangle.
/** @param {three.Camera} camera @param {HTMLCanvasElement} canvas */
function centre(camera, canvas) {
  const width = canvas.clientWidth, height = canvas.clientHeight;
  if (!free || !width || !height) return;
  const scale = Math.min(free.height, free.width / MIN_ASPECT) / height;
  const full = [width * scale, height * scale];
  const offset = [full[0] / 2 - free.x - free.width / 2, full[1] / 2 - free.y - free.height / 2];
  const view = camera.view;
  const wanted = /** @type {Parameters<typeof camera.setViewOffset>} */ ([...full, ...offset, width, height]);
  const shown = view && view.enabled
    ? [view.fullWidth, view.fullHeight, view.offsetX, view.offsetY, view.width, view.height] : [];
  if (shown.length && shown.every((number, k) => Math.abs(number - wanted[k]) < 0.01)) return;
  camera.aspect = width / height;
  camera.setViewOffset(...wanted); // updates the projection
}

/** @param {string} name */
const shownNode = (name) => {
  const node = startedViewer().nodeRefFromName[name];
  for (let parent = node ?? null; parent; parent = parent.parent) if (!parent.visible) return null;
  return node || null;
};

// The least height of the camera: { always, now }, in any sea and above the present wave.
/** @param {three.Camera} camera */
function lowest(camera) {
  const floor = shownNode("/floor"), sea = shownNode("/sea");
  let always = -Infinity, now = -Infinity;
  if (floor) always = floor.getWorldPosition(camera.position.clone()).y + FLOOR_CLEARANCE;
  const mesh = sea?.children.find((child) => child.isMesh);
  const position = mesh?.geometry.attributes.position;
  if (sea && mesh && position) {
    const mean = sea.getWorldPosition(camera.position.clone()).y;
    always = Math.max(always, mean + WATER_CLEARANCE);
    if (camera.position.y < mean + MAX_WAVE_HEIGHT) {
      now = mean + waterHeight(position.array, mesh.worldToLocal(camera.position.clone())) + WATER_CLEARANCE;
    }
  }
  return { always, now };
}

/** @type {three.Vector3 | null} */
let lastTarget = null;

/** @param {three.Camera} camera @param {viser.CameraControls} controls */
function keepAbove(camera, controls) {
  let { always, now } = lowest(camera);
  const target = controls.getTarget(camera.position.clone());
  if (camera.position.y < always - 1e-6) {
    const moved = lastTarget && lastTarget.distanceTo(target) > 1e-6 * controls.distance;
    const cosine = (always - target.y) / controls.distance;
    if (!moved && cosine < 1) {
      // A turn of the camera slides along the floor.
      const polar = Math.acos(Math.max(cosine, -1));
      const azimuth = controls.azimuthAngle;
      controls.rotatePolarTo(polar, false);
      camera.position.set(
        target.x + controls.distance * Math.sin(polar) * Math.sin(azimuth),
        target.y + controls.distance * Math.cos(polar),
        target.z + controls.distance * Math.sin(polar) * Math.cos(azimuth),
      );
      camera.lookAt(target);
    } else {
      // A shift, which moves the target along, ends at the floor.
      const lift = always - camera.position.y;
      controls.moveTo(target.x, target.y + lift, target.z, false);
      camera.position.y = always;
      target.y += lift;
    }
    now = lowest(camera).now; // at its new place
  }
  lastTarget = target;
  // Above a crest the camera is lifted for this frame only, so that it comes down again behind the crest.
  if (camera.position.y < now) camera.position.y = now;
  camera.updateMatrixWorld();
}

// Before each frame: viser may have replaced the canvas or the scene.
/** @param {three.Camera} camera */
function placeCamera(camera) {
  const { cameraControl: controls, camera: own, canvas } = startedViewer();
  if (!controls || camera !== own) return; // the camera of a shadow or of an environment map
  keepAbove(camera, controls);
  centre(camera, canvas);
  findSplats();
  splats?.material.uniforms.projectionMatrixCustom.value.copy(camera.projectionMatrix);
}

// viser's splats use a separate projection without the shift: they get the camera's.
/** @type {three.Mesh | null} */
let splats = null; // the mesh of all splats

function findSplats() {
  if (splats?.parent) return;
  const { scene, camera } = startedViewer();
  splats = scene.children.find((child) => child.material?.uniforms?.projectionMatrixCustom) ?? null;
  // The vertices of splats have two numbers each. three would take a third one, and compute a bounding sphere of NaN.
  const center = camera.position.clone().set(0, 0, 0);
  if (splats) splats.geometry.boundingSphere = { center, radius: Infinity };
}

beforeRender("camera", (renderer, scene, camera) => placeCamera(camera));
onLook(measure);
