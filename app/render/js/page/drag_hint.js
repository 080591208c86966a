// "Drag me" below the free end of the rope, in the first seconds of a page, until this browser has dragged a rope.
//
// Of viser this file uses window.__viserMutable: nodeRefFromName, camera and canvas.

import { page } from "../core/life.js";
import { store, stored } from "../core/storage.js";
import { viewer } from "../core/viewer.js";
import { onFrame } from "../core/watch.js";

const KEY = "springtide-dragged"; // of the local storage
const ROPE = "/rope", PULL = "/pull"; // nodes; PULL is the line from the dragged point to the mouse
const SHOWN = 10_000; // [ms] after the first picture of a rope
const GAP = 14, ROOM = 44; // [pixels] from the end of the rope, and least distance from the edges of the picture
const BEYOND = 0.2; // the end may be this far outside the picture, in halves of its size
/** @type {HTMLElement | null} */
let hint = null;
let ended = stored(KEY) !== null, since = 0, isPressed = false;

function makeHint() {
  const made = document.createElement("div");
  made.id = "springtide-drag-me";
  made.textContent = "Drag me";
  made.setAttribute("aria-hidden", "true"); // only a pointer can drag
  made.style.cssText =
    "position:fixed;top:0;left:0;z-index:1;pointer-events:none;padding:2px 10px;border-radius:12px;white-space:nowrap;" +
    "font:600 14px/1.5 system-ui,sans-serif;color:#fff;background:rgba(16,30,46,0.85)";
  document.body.append(made);
  return made;
}

function remove() {
  ended = true;
  hint?.remove();
}

// Position of the rope's end on the page [pixels]; null if it is outside the picture.
/** @param {viser.Started} view */
function freeEnd({ nodeRefFromName, camera, canvas }) {
  const mesh = nodeRefFromName[ROPE]?.children.find((child) => child.isMesh);
  const places = mesh?.geometry.attributes.position;
  if (!mesh || !places?.count) return null;
  const last = places.count - 1, place = camera.position.clone();
  place.set(places.getX(last), places.getY(last), places.getZ(last)).applyMatrix4(mesh.matrixWorld).project(camera);
  if (Math.abs(place.x) > 1 + BEYOND || Math.abs(place.y) > 1 + BEYOND) return null;
  const box = canvas.getBoundingClientRect(), x = box.left + (box.width * (1 + place.x)) / 2;
  const y = box.top + (box.height * (1 - place.y)) / 2 + GAP;
  return { x: Math.min(Math.max(x, box.left + ROOM), box.right - ROOM), y: Math.min(Math.max(y, box.top), box.bottom - ROOM) };
}

page.listen(window, "pointerdown", () => { isPressed = true; }, { capture: true });
page.listen(window, ["pointerup", "pointercancel"], () => { isPressed = false; }, { capture: true });
onFrame((now) => {
  const view = /** @type {viser.Started | undefined} */ (viewer());
  if (ended || !view?.camera || !view.canvas || !view.nodeRefFromName) return;
  if (isPressed && view.nodeRefFromName[PULL]?.visible) {
    store(KEY, "yes");
    return remove();
  }
  const isStopped = document.querySelector(".springtide-stopped") !== null; // Play or Reset is what helps there
  const end = isStopped ? null : freeEnd(view), place = end && document.querySelector("#springtide-cover.springtide-hidden") ? end : null;
  if (place) since ||= now;
  if (since && now - since > SHOWN) return remove();
  if (place) hint ??= makeHint();
  if (!hint) return;
  hint.hidden = !place;
  if (place) hint.style.transform = `translate(calc(${place.x}px - 50%), ${place.y}px)`;
});
