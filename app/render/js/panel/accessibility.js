// Additions to viser's panel for keyboards and screen readers: folders and sliders that Tab reaches, and names.

import { page } from "../core/life.js";
import { onControls, onLook, onValues } from "../core/watch.js";

const FOLDER = ".mantine-Paper-root > .mantine-Paper-root:first-child"; // the title of a folder
// The button of viser's settings is hidden until these are shown; then it leads back.
/** @type {Record<string, string>} */
const ICON_NAMES = { "list-search": "Commands", "adjustments": "Back to the panel", "x": "Close", "maximize": "Enlarge" };

/** @param {Element} element @param {string} name @param {string} value */
function set(element, name, value) {
  if (element.getAttribute(name) !== value) element.setAttribute(name, value);
}

/** @param {HTMLElement} title */
function describeFolder(title) {
  if (!title.querySelector("svg")) return;
  set(title, "role", "button");
  set(title, "tabindex", "0");
  set(title, "aria-expanded", String(title.querySelector(".tabler-icon-chevron-up") !== null));
}

// The text field of a slider: in the row before its own.
/** @param {HTMLElement} thumb */
function fieldOf(thumb) {
  /** @type {HTMLElement | null} */
  let row = thumb.closest(".multi-slider");
  while (row && !row.previousElementSibling?.querySelector?.("input")) row = row.parentElement;
  return row?.previousElementSibling?.querySelector("input") ?? null;
}

/** @param {HTMLElement} thumb */
function describeThumb(thumb) {
  const field = fieldOf(thumb);
  set(thumb, "role", "slider");
  set(thumb, "tabindex", "0");
  set(thumb, "aria-label", field?.getAttribute("aria-label") ?? "value");
  set(thumb, "aria-valuemin", "0");
  set(thumb, "aria-valuemax", "100");
  set(thumb, "aria-valuenow", String(Math.round(Number.parseFloat(thumb.style.left) || 0)));
  if (field) set(thumb, "aria-valuetext", field.value);
}

/** @param {HTMLElement} button */
function nameButton(button) {
  if (button.hasAttribute("aria-label") || button.textContent.trim()) return;
  const icon = button.querySelector("svg")?.getAttribute("class") ?? "";
  const known = Object.keys(ICON_NAMES).find((name) => icon.includes(`tabler-icon-${name}`));
  set(button, "aria-label", known ? ICON_NAMES[known] : "Close");
}

// A sentence on the canvas tells the state of the scene: what it shows, and the words of the panel on it.
function describeScene() {
  const canvas = document.querySelector("canvas[data-engine]"), status = document.querySelector(".springtide-panel[data-state]");
  if (!canvas || !status) return;
  const [scene, preset] = [...document.querySelectorAll(".springtide-head .mantine-Select-input")].map((one) => /** @type {HTMLInputElement} */ (one).value);
  const isOld = document.documentElement.dataset.springtideLine !== undefined;
  const state = isOld ? "No connection, an old picture" : status.textContent;
  const figures = document.querySelector(".springtide-figures")?.textContent ?? "";
  const words = [scene, preset, state, figures].filter(Boolean).map((text) => text.replace(/\s+/g, " ").trim());
  set(canvas, "role", "img");
  set(canvas, "aria-label", `${words.join(". ")}.`);
}

let planned = false;
function describeAll() {
  planned = false;
  document.querySelectorAll(FOLDER).forEach(describeFolder);
  document.querySelectorAll(".multi-slider-thumb").forEach(describeThumb);
  document.querySelectorAll("button").forEach(nameButton);
}

function plan() {
  if (planned) return;
  planned = true;
  setTimeout(describeAll, 100);
}

page.listen(document, "keydown", (event) => {
  const at = event.target;
  if (!(at instanceof HTMLElement)) return;
  const presses = event.key === " " || event.key === "Enter";
  // A key that presses a button must not also act as a key of the lab: Space would play and pause at once.
  if (presses && at.matches("button, [role=button], [role=slider], input[type=checkbox]")) event.stopPropagation();
  if (presses && at.matches(FOLDER)) {
    event.preventDefault();
    at.click();
  }
  if (at.matches(".multi-slider-thumb") && event.key.startsWith("Arrow")) {
    event.preventDefault();
    event.stopPropagation();
    const key = event.key === "ArrowUp" || event.key === "ArrowRight" ? "ArrowUp" : "ArrowDown";
    fieldOf(at)?.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
  }
}, { capture: true });
onControls(plan);
onValues(plan);
onLook(describeScene);
