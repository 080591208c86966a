// One observer of the page and one clock for all parts.
//
// While a scene runs, viser rewrites the status line and the state of the time line in each frame. Parts that change controls
// ignore these.

import { page } from "./life.js";

const STATUS = ".springtide-panel, .springtide-figures, .springtide-readings, [data-springtide-topic]"; // rewritten in each frame
const CONTROL = "button, label, [role]"; // elements whose words are read
const OWN = "springtide-"; // prefix of the identifiers of our own elements, some of them moved in each frame
const LOOK_INTERVAL = 200; // [ms] between two looks at where things are
const REST_INTERVAL = 1000; // [ms] the same once nothing has changed for SETTLING
const SETTLING = 2000; // [ms] after a change until everything that it moves stands still

/** @typedef {(now: number) => void} Part */
/** @type {{ any: Part[], controls: Part[], values: Part[], frame: Part[], look: Part[] }} */
const parts = { any: [], controls: [], values: [], frame: [], look: [] };

/** @param {Node} node @returns {node is Element} */
const isElement = (node) => node.nodeType === Node.ELEMENT_NODE;
/** @type {(node: Node) => boolean} */
const isStatus = (node) => isElement(node) && node.matches(STATUS);

// True if a change may concern controls.
/** @param {MutationRecord} change */
function isOfControls({ type, target, addedNodes, removedNodes }) {
  const at = isElement(target) ? target : target.parentElement;
  if (type === "characterData") return Boolean(at?.closest(CONTROL));
  if (at?.closest(STATUS)) return false;
  const replaced = [...addedNodes].filter(isElement), gone = [...removedNodes].filter(isElement);
  return !(replaced.length && gone.length && replaced.every(isStatus) && gone.every(isStatus));
}

/** @param {(keyof typeof parts)[]} names @param {number} now */
function call(names, now = 0) {
  for (const name of names) for (const part of parts[name]) part(now);
}

const observer = new MutationObserver((changes) => {
  const structural = changes.filter(({ type }) => type !== "attributes"), isOfControl = structural.some(isOfControls);
  const hasValues = changes.some(({ type, target }) => type === "attributes" && isElement(target) && !target.id.startsWith(OWN));
  if (structural.length) call(isOfControl ? ["any", "controls"] : ["any"]);
  if (hasValues) call(["values"]);
  if (isOfControl || hasValues) wake(); // other words move nothing
});
observer.observe(document.documentElement, {
  childList: true, subtree: true, characterData: true, attributes: true,
  attributeFilter: ["data-mantine-color-scheme", "style", "value"],
});
page.own(() => observer.disconnect());

// Frames are requested only if something may have changed: a page at rest costs nearly nothing.
let isAsked = false; // true if the next frame of the browser is requested
let changed = performance.now(), looked = -Infinity; // [ms] time of the last change, and of the last look

function askForFrame() {
  if (isAsked || page.signal.aborted) return;
  isAsked = true;
  requestAnimationFrame((now) => {
    isAsked = false;
    call(["frame"], now);
  });
}

// Something has changed: call the parts before the next frame of the browser.
export function wake() {
  changed = performance.now();
  askForFrame();
}

page.listen(window, ["pointermove", "pointerdown", "pointerup", "pointercancel"], wake, { capture: true, passive: true });
page.every(LOOK_INTERVAL, () => {
  const now = performance.now(), interval = now - changed > SETTLING ? REST_INTERVAL : LOOK_INTERVAL / 2; // a timer may be early
  if (document.visibilityState === "hidden" || now - looked < interval) return;
  looked = now;
  call(["look"]);
  askForFrame();
});
page.listen(window, "resize", () => call(["look"]));

/** @param {keyof typeof parts} name @param {Part} part */
function subscribe(name, part) {
  parts[name].push(part);
  page.own(() => parts[name].splice(parts[name].indexOf(part), 1));
}

// Call a function after each change of the page's elements and words, and now.
/** @param {() => void} part */
export function onChange(part) {
  subscribe("any", part);
  part();
}

// The same after changes that may concern controls.
/** @param {() => void} part */
export function onControls(part) {
  subscribe("controls", part);
  part();
}

// The same after changes of values, places of sliders, and the colour scheme.
export const onValues = (/** @type {() => void} */ part) => subscribe("values", part);

// Call a function, with the time [ms], before the frame of the browser that follows a change of the page, a pointer, a drawing
// of the scene, or a look.
export const onFrame = (/** @type {Part} */ part) => subscribe("frame", part);

// Call a function a few times a second, and when the window changes its size.
export const onLook = (/** @type {() => void} */ part) => subscribe("look", part);
