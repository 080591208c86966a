// The cover over the page, of a lab (page/cover.js) or a replay (page/replay.js), until the picture of a scene is complete
// (frames.js).

import { springtide } from "../core/springtide.js";
import { onLook } from "../core/watch.js";

const SETTLING = 300; // [ms] after a panel, in which the objects of its scene arrive
const UNDRAWN = 10_000; // [ms] after which the cover goes if no frame has begun
const PATIENCE = 60_000; // [ms] after which it goes in any case
const cover = /** @type {HTMLElement} */ (document.getElementById("springtide-cover"));
const words = /** @type {HTMLElement} */ (document.getElementById("springtide-cover-words"));

/** @param {string | null} text null for that which is there @param {boolean} hidden */
export function showCover(text, hidden) {
  if (text !== null && words.textContent !== text) words.textContent = text;
  cover.classList.toggle("springtide-hidden", hidden);
}

// Labs side by side are seen together. False while another frame of the page with the panes waits for its picture.
function othersAreWhole() {
  try {
    return window.parent === window || (window.parent.__springtide?.areWhole?.() ?? true);
  } catch {
    return true; // embedded in a page of another origin
  }
}

/** @type {string | number | null} */
let opened = null; // the scene whose picture is awaited
let openedAt = 0; // [ms] since when
/** @type {string | number} */
export let pictured = ""; // the scene whose picture was complete

// True if the picture of a scene is not complete yet. scene: a name or number of it that no other scene of this page has; "" for
// a scene whose picture has no list of parts.
/** @param {string | number} scene */
export function awaitsPicture(scene) {
  if (scene && scene === pictured) return false;
  const now = performance.now();
  if (scene !== opened) {
    [opened, openedAt] = [scene, now];
    springtide.awaitPicture?.();
  }
  const since = now - openedAt, { showsWhole } = springtide;
  if (!scene) return since < SETTLING;
  springtide.isWhole = since >= (showsWhole ? PATIENCE : UNDRAWN) || (since >= SETTLING && Boolean(showsWhole?.()));
  if (!springtide.isWhole || (since < PATIENCE && !othersAreWhole())) return true;
  pictured = scene;
  isSimple = Boolean(showsWhole && !showsWhole());
  return false;
}

let isSimple = false; // true if the cover went before the picture was complete
const simple = document.createElement("div");
simple.id = "springtide-simple";
simple.setAttribute("role", "status");
document.body.append(simple);

// Say over the picture that it is not complete yet.
onLook(() => {
  isSimple = isSimple && !springtide.showsWhole?.();
  const text = isSimple && pictured === opened ? "Simple drawing until the graphics are ready" : "";
  if (simple.textContent !== text) simple.textContent = text;
});
