// A press near a rope or a cloth grabs it instead of the camera: it is thin, and moves while the user aims.
//
// viser's client asks each mesh that can be dragged whether the ray of the pointer meets it (three's Mesh.raycast). The
// meshes named here also report a hit if a vertex is near the pointer on the screen, or was just before. They report a large
// distance, so that arrows and beads under the pointer come first. A ring marks what a press would grab.
//
// Of viser this file uses window.__viserMutable: nodeRefFromName, camera and canvas.

import { page } from "../core/life.js";
import { startedViewer, viewer } from "../core/viewer.js";
import { onFrame } from "../core/watch.js";

const NAMES = /^\/(rope|cloth|race\/rope_\d+)$/;
const REACH = 25, TOUCH_REACH = 50; // [pixels]
const MEMORY = 200; // [ms] for which a vertex can still be grabbed where it was: the user reacts that late
const INTERVAL = 30; // [ms] between two remembered positions
const FAR = 1e9; // [m]
/** @type {WeakMap<three.Mesh, { until: number, version: number, points: Float32Array }[]>} */
const moments = new WeakMap(); // the latest first
const ring = document.createElement("div");
ring.id = "springtide-ring";
document.body.append(ring);
/** @type {{ x: number, y: number, reach: number } | null} */
let pointer = null; // [pixels] over the canvas while no button moves it

function meshes() {
  const nodes = viewer()?.nodeRefFromName ?? {};
  const found = Object.keys(nodes).filter((name) => NAMES.test(name));
  const drawn = found.map((name) => nodes[name]?.children.find((child) => child.isMesh));
  return drawn.filter((mesh) => mesh !== undefined).filter((mesh) => mesh.geometry.attributes.position);
}

/** @param {three.Mesh} mesh @param {number} now */
function remember(mesh, now) {
  const { array, version } = mesh.geometry.attributes.position;
  let kept = moments.get(mesh);
  if (!kept) {
    moments.set(mesh, (kept = []));
    const exact = mesh.raycast;
    mesh.raycast = (raycaster, hits) => {
      const before = hits.length;
      exact.call(mesh, raycaster, hits);
      const near = hits.length === before && pointer && nearest(mesh, pointer);
      if (near) hits.push({ object: mesh, point: near.place, distance: FAR + near.rank });
    };
  }
  if (kept[0]?.version === version) kept[0].until = now;
  else if (!kept.length || now - kept[0].until >= INTERVAL) kept.unshift({ until: now, version, points: array.slice() });
  while (kept[kept.length - 1].until < now - MEMORY) kept.pop();
}

// The vertex nearest to the pointer, now or just before: { place, rank }, its place in the world [m] and its
// distance on the screen [pixels], increased with its age; null if none is within reach.
/** @param {three.Mesh} mesh @param {{ x: number, y: number, reach: number }} pointer */
function nearest(mesh, pointer) {
  const { camera, canvas } = startedViewer(), now = mesh.geometry.attributes.position.array;
  const project = camera.projectionMatrix.clone().multiply(camera.matrixWorldInverse).multiply(mesh.matrixWorld);
  const m = project.elements, right = canvas.clientWidth / 2, down = canvas.clientHeight / 2;
  const earlier = (moments.get(mesh) ?? []).map(({ points }) => points);
  const shown = [now, ...earlier].filter((one) => one.length === now.length);
  for (const [age, points] of shown.entries()) {
    let found = -1, least = pointer.reach ** 2;
    for (let k = 0; k < points.length; k += 3) {
      const x = points[k], y = points[k + 1], z = points[k + 2];
      const w = m[3] * x + m[7] * y + m[11] * z + m[15];
      if (w <= 0) continue; // behind the camera
      const across = right * (1 + (m[0] * x + m[4] * y + m[8] * z + m[12]) / w) - pointer.x;
      const along = down * (1 - (m[1] * x + m[5] * y + m[9] * z + m[13]) / w) - pointer.y;
      const square = across * across + along * along;
      if (square < least) [found, least] = [k, square];
    }
    if (found < 0) continue;
    const place = mesh.localToWorld(camera.position.clone().fromArray(now, found));
    return { place, rank: Math.sqrt(least) + age * TOUCH_REACH };
  }
  return null;
}

/** @param {number} now */
function frame(now) {
  const all = meshes();
  for (const mesh of all) remember(mesh, now);
  const at = pointer, near = at ? all.map((mesh) => nearest(mesh, at)).filter((one) => one !== null) : [];
  if (ring.hidden === near.length > 0) ring.hidden = !ring.hidden; // a write is a change, of the same value too
  if (near.length) {
    const { camera, canvas } = startedViewer(), box = canvas.getBoundingClientRect();
    const { place } = near.reduce((best, one) => (one.rank < best.rank ? one : best));
    place.project(camera);
    ring.style.left = `${box.left + (box.width * (1 + place.x)) / 2}px`;
    ring.style.top = `${box.top + (box.height * (1 - place.y)) / 2}px`;
  }
}

// Before viser's client handles it.
/** @param {PointerEvent} event */
function follow(event) {
  const canvas = viewer()?.canvas, moved = event.type === "pointermove" && event.buttons;
  if (!canvas || event.target !== canvas || !event.isPrimary || moved) return void (pointer = null);
  const box = canvas.getBoundingClientRect(), reach = event.pointerType === "touch" ? TOUCH_REACH : REACH;
  pointer = { x: event.clientX - box.left, y: event.clientY - box.top, reach };
}

page.listen(window, ["pointermove", "pointerdown"], follow, { capture: true });
page.listen(window, ["pointerup", "pointercancel"], () => (pointer = null));
page.listen(document.documentElement, "pointerleave", () => (pointer = null));
onFrame(frame);
