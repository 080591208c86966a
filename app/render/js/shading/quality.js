// Drawing quality of this browser: the fraction of the screen's pixels, and the detail of the shaders of water and rain.
//
// "Automatic" starts at the lowest step without a graphics card, else at the step that this browser had last. It measures
// the frame time while the picture moves (frames.js). Slow frames take it down step by step, a very slow one at once, and fast
// frames cautiously up. The choice is stored in this browser and is part of no link, preset or set-up. A page with
// viser's "fixedDpr" in its address is drawn at that ratio throughout. Images for the server have all pixels and details.

import { page } from "../core/life.js";
import { springtide } from "../core/springtide.js";
import { store, stored } from "../core/storage.js";
import { startedViewer } from "../core/viewer.js";
import { onControls } from "../core/watch.js";
import { firstStep, isSoftware, makeJudge, STEPS } from "./judge.js";
import { wrapMethod } from "./wrap.js";

const KEY = "springtide-quality"; // of the local storage
const STEPS_KEY = "springtide-quality-steps"; // of the local storage: the last step of each renderer, by its name
/** @type {Record<string, number>} */
const FIXED = { high: 0, medium: 2, low: 4 }; // step of each choice but "automatic"
let judge = makeJudge();
const isFixed = new URLSearchParams(location.search).has("fixedDpr");
let current = STEPS[0], dismissed = false, choice = "automatic";
/** @type {HTMLElement | null} */
let line = null;
let rendererName = "", valid = 0; // time [ms] from which frame times count

function readChoice() {
  const kept = stored(KEY);
  choice = kept !== null && kept in FIXED ? kept : "automatic";
}

// The last steps by name of the renderer.
/** @returns {Record<string, number>} */
function readSteps() {
  try {
    return JSON.parse(stored(STEPS_KEY) ?? "{}");
  } catch {
    return {}; // another program has written it
  }
}

function keepStep() {
  store(STEPS_KEY, JSON.stringify({ ...readSteps(), [rendererName]: judge.step() }));
}

/** @param {three.Renderer} renderer */
function nameOf(renderer) {
  const gl = renderer.getContext(), more = gl.getExtension("WEBGL_debug_renderer_info");
  return String(gl.getParameter(more ? more.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
}

function forget() {
  judge.forget();
  valid = performance.now();
}

/** @param {string} name */
function choose(name) {
  store(KEY, name);
  choice = name;
  dismissed = false;
  forget();
  show();
  startedViewer().requestRender();
}

/** @param {string} text @param {() => void} press */
function button(text, press) {
  const made = document.createElement("button");
  made.type = "button";
  made.textContent = text;
  made.style.cssText =
    "font:inherit;margin-left:8px;padding:1px 8px;border:1px solid currentColor;border-radius:3px;background:none;" +
    "color:inherit;cursor:pointer";
  made.addEventListener("click", press);
  return made;
}

function makeLine() {
  const made = document.createElement("div");
  made.id = "springtide-slow";
  made.setAttribute("role", "status");
  // Styled here, because a replay lacks our style sheet.
  made.style.cssText =
    "position:fixed;bottom:calc(8px + var(--springtide-foot, 0px) + var(--springtide-bar, 0px));z-index:8;padding:4px 10px;" +
    "left:calc(8px + var(--springtide-left, 0px));border-radius:6px;background:rgba(16,30,46,0.85);color:#fff;" +
    "font:13px/1.5 system-ui,sans-serif;max-width:calc(100vw - 36px - var(--springtide-left, 0px) - var(--springtide-right, 0px))";
  made.append("Graphics are slow here, so quality was reduced.");
  made.append(button("Keep high quality", () => choose("high")));
  made.append(button("OK", () => {
    dismissed = true;
    show();
  }));
  document.body.append(made);
  return made;
}

// Bring the line on the page and the control in the panel up to date.
function show() {
  const step = choice === "automatic" ? judge.step() : FIXED[choice];
  if (STEPS[step] !== current) {
    if (step === 0) dismissed = false;
    current = STEPS[step];
  }
  const lowered = choice === "automatic" && step > 0 && !isFixed;
  if (lowered && !dismissed) line ??= makeLine();
  else if (line) {
    line.remove();
    line = null;
  }
  /** @type {NodeListOf<HTMLSelectElement>} */
  const selects = document.querySelectorAll("[data-springtide-choice=quality]");
  for (const select of selects) {
    if (select.value !== choice) select.value = choice;
    const now = select.parentElement?.querySelector(".springtide-quality");
    const text = lowered ? `now ${current.quality}` : "";
    if (now && now.textContent !== text) now.textContent = text;
  }
}

function isCapturing() {
  return startedViewer().getRenderRequestState === "capture";
}

// Pixels that are drawn per pixel of the page.
const ratio = () => devicePixelRatio * (isCapturing() ? 1 : current.pixels);

readChoice();
page.listen(document, "change", (event) => {
  if (event.target instanceof HTMLSelectElement && event.target.dataset.springtideChoice === "quality") choose(event.target.value);
});
page.listen(document, "visibilitychange", forget);
page.listen(window, "storage", (event) => {
  if (event.key !== KEY) return;
  readChoice();
  show();
  startedViewer().requestRender();
});
export const QUALITY = {
  choice: () => choice,
  now: () => ({ ...current, step: STEPS.indexOf(current), steps: STEPS.length }),
  isCapturing, // an image for the server
  isSoftware: () => isSoftware(rendererName),
  // True if this frame needs its full quality, however long it takes, since it is kept.
  isWhole: () => isFixed || isCapturing() || springtide.isRecording === true,
  // Details of the shaders of this frame: 2 all, 1 less, 0 least.
  details: () => (isFixed || isCapturing() ? 2 : current.details),
  // Begin with a renderer: at the step that it had last, or at the lowest without a graphics card. The pixel ratio is set
  // only here: viser's own monitor and its resizing would set others.
  /** @param {three.Renderer} renderer @param {import("../core/life.js").Life} life */
  start(renderer, life) {
    rendererName = nameOf(renderer);
    judge = makeJudge(firstStep(readSteps()[rendererName], rendererName));
    show();
    if (isFixed) return;
    wrapMethod(life, renderer, "setPixelRatio", (earlier) => /** @this {three.Renderer} */ function () {
      earlier.call(this, ratio());
    });
  },
  // Called before each frame is drawn: sets its pixels.
  /** @param {three.Renderer} renderer */
  beforeRender(renderer) {
    if (isFixed) return;
    if (Math.abs(renderer.getPixelRatio() - ratio()) > 1e-3) renderer.setPixelRatio(ratio());
  },
  // Record the length of a frame [ms], when it began, and whether it compiled programs.
  /** @param {number} length @param {number} began @param {boolean} compiled */
  take(length, began, compiled) {
    // A clip whose frames change their size cannot be played.
    const measured = !isFixed && choice === "automatic" && document.visibilityState === "visible" && !springtide.isRecording;
    if (!measured) judge.forget();
    if (!measured || began < valid) return;
    const before = judge.step();
    judge.take(length, compiled);
    if (judge.step() === before) return;
    keepStep();
    show();
    startedViewer().requestRender();
  },
};
// Each scene has its own control.
onControls(show);

// The text of a fragment shader, and the name of its program, with the details of this frame.
/** @param {string} source */
export function withDetails(source) {
  return `#define DETAILS ${QUALITY.details()}\n${source}`;
}
/** @param {string} key */
export function keyWithDetails(key) {
  return QUALITY.details() === 2 ? key : `${key} with details ${QUALITY.details()}`;
}
