// Fields and lists of the panel, on top of what viser's client does with them.
//
// viser sends a text field at each keystroke. Here a text is sent once it is complete: on Enter or when the field is left.
// Escape restores the value; the arrows change its second digit. A list or button loses the focus after use, so that
// the keys of the lab (space, N, R, digits) never type into a list or press a button a second time.

import { tell } from "../core/channel.js";
import { page } from "../core/life.js";
import { onControls } from "../core/watch.js";
import { isTyping } from "./keys.js";
import { stepped } from "./numbers.js";

const FIELD = "input.mantine-TextInput-input";
const NAMED = `${FIELD}, textarea, .mantine-Slider-thumb, .mantine-NumberInput-input`; // elements without a name by viser
const ofValue = Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value");
const { set: setText } = /** @type {{ set(text: string): void }} */ (ofValue);
/** @type {WeakMap<HTMLInputElement, string>} */
const before = new WeakMap(); // its text when it got the focus
/** @type {WeakMap<HTMLInputElement, string>} */
const drafts = new WeakMap(); // text typed since
const DRAGGED = 4; // [pixels] of motion from which a press of the mouse is a drag
let sending = false;

/** @param {Event} event */
function fieldOf(event) {
  return event.target instanceof HTMLInputElement && event.target.matches(FIELD) ? event.target : null;
}

/** @param {HTMLInputElement} field @param {string} text */
function send(field, text) {
  drafts.delete(field);
  before.set(field, text);
  sending = true;
  setText.call(field, text);
  field.dispatchEvent(new Event("input", { bubbles: true }));
  sending = false;
}

/** @param {HTMLInputElement} field */
function commit(field) {
  const draft = drafts.get(field);
  if (draft === undefined) return;
  // viser sends nothing if the text equals the last one shown, even after a refused text: so a space is added.
  send(field, draft === before.get(field) ? `${draft} ` : draft);
}

// viser sends nothing if the shown preset is chosen again: here buttons of the panel restart the scene.
page.listen(document, "click", ({ target }) => {
  const option = target instanceof Element && target.closest('[role="option"][aria-selected="true"]');
  const list = option && option.closest('[role="listbox"]');
  const field = list && document.querySelector(`[aria-controls="${list.id}"]`);
  const ofHead = [...document.querySelectorAll(".springtide-head .mantine-Select-input")]; // scene, if any, and preset
  if (!field || field !== ofHead[ofHead.length - 1]) return;
  for (const name of ["Reset", "Play"]) document.querySelector(`[data-springtide-icon="${name}"]`)?.click();
}, { capture: true });

/** @param {HTMLInputElement} field */
function restore(field) {
  if (drafts.has(field)) setText.call(field, before.get(field) ?? "");
  drafts.delete(field);
}

page.listen(document, "focusin", (event) => {
  const field = fieldOf(event);
  if (!field) return;
  before.set(field, field.value);
  field.select();
});
// In a field that just got the focus, WebKit puts the caret where the mouse is released, so that typing would add to the old
// text. A selection made with the mouse stays.
/** @type {{ field: HTMLInputElement, x: number } | null} */
let entered = null; // the field that got the focus by the present press, and its place
page.listen(document, "pointerdown", (event) => {
  const field = fieldOf(event);
  entered = field && field !== document.activeElement ? { field, x: event.clientX } : null;
}, { capture: true });
page.listen(document, "mouseup", (event) => {
  if (entered && fieldOf(event) === entered.field && Math.abs(event.clientX - entered.x) < DRAGGED) {
    const { field } = entered;
    event.preventDefault();
    field.select();
    setTimeout(() => document.activeElement === field && !drafts.has(field) && field.select());
  }
  entered = null;
}, { capture: true });
page.listen(document, "input", (event) => {
  const field = fieldOf(event);
  if (!field || sending) return;
  drafts.set(field, field.value);
  event.stopImmediatePropagation();
}, { capture: true });
page.listen(document, "focusout", (event) => {
  const field = fieldOf(event);
  if (field) commit(field);
}, { capture: true });
page.listen(document, "keydown", (event) => {
  const field = fieldOf(event);
  if (!field) return;
  if (event.key === "Enter") {
    commit(field);
    field.blur();
  } else if (event.key === "Escape") {
    restore(field);
    field.blur();
  } else if (event.key === "ArrowUp" || event.key === "ArrowDown") {
    const text = stepped(drafts.get(field) ?? field.value, event.key === "ArrowUp");
    event.preventDefault();
    if (text !== null) send(field, text);
  }
}, { capture: true });
// After viser's client has handled them:
page.listen(document, "keydown", (event) => {
  const list = event.target instanceof HTMLElement && event.target.matches("[aria-haspopup=listbox]");
  if (list && event.key === "Enter") event.target.blur();
});
page.listen(document, "click", (event) => {
  const used = event.target instanceof Element && event.target.closest("[role=option], button, input[type=checkbox]");
  // A click by keyboard has no detail: the focus stays where Tab has brought it.
  if (used && event.detail > 0) /** @type {HTMLElement | null} */ (document.activeElement)?.blur();
});

// All values of a slider until its release are one change for Undo: the lab learns when it is held and released.
let held = false;
/** @param {boolean} now */
function tellHeld(now) {
  if (now !== held) tell("held", now);
  held = now;
}
page.listen(document, "pointerdown", ({ target }) => {
  if (target instanceof Element && target.closest(".multi-slider")) tellHeld(true);
}, { capture: true });
page.listen(document, ["pointerup", "pointercancel"], () => tellHeld(false), { capture: true });
page.listen(window, "blur", () => tellHeld(false));

// Assistive software finds a field by its name: viser's labels refer to an identifier that its text fields lack.
function nameFields() {
  for (const label of document.querySelectorAll("label[for]")) {
    const fields = label.closest(".mantine-Flex-root")?.querySelectorAll(NAMED) ?? [];
    for (const field of fields) if (!field.getAttribute("aria-label")) field.setAttribute("aria-label", label.textContent);
  }
}

// The block that stays visible: the folder with the state of the lab. The tabs are below it.
/** @type {Record<string, string>} */
const HINTS = {
  Play: "Play (space)", Pause: "Pause (space)", Step: "One step (N)", Reset: "Back to the start (R)",
  Camera: "Reset the camera (V)", Plots: "Open or close the plots (P)", Undo: "",
};
/** @type {Record<string, string>} */
const ARROWS = { "◀": "Previous task", "▶": "Next task" };
function nameArrows() {
  for (const button of document.querySelectorAll(".mantine-Button-root")) {
    button.classList.toggle("springtide-quiet", button.textContent === "Remove preset");
    const name = ARROWS[button.textContent];
    if (!name || button.title === name) continue;
    button.title = name;
    button.setAttribute("aria-label", name);
  }
}
const sizes = new ResizeObserver(([{ target }]) => {
  const height = Math.floor(target.getBoundingClientRect().height); // rounded up, the text would show in between
  document.documentElement.style.setProperty("--springtide-head", `${height}px`);
  const row = target.querySelector("[data-springtide-icon]");
  const above = row ? row.getBoundingClientRect().top - target.getBoundingClientRect().top : 0;
  document.documentElement.style.setProperty("--springtide-above", `${Math.floor(above)}px`);
});
page.own(() => sizes.disconnect());
function markLab() {
  const status = document.querySelector(".springtide-panel[data-state]"), lab = status?.closest(".mantine-Paper-root");
  if (!status || !lab) return;
  if (!lab.classList.contains("springtide-lab")) {
    lab.classList.add("springtide-lab");
    sizes.disconnect();
    sizes.observe(lab);
  }
  const head = status.parentElement?.parentElement;
  if (!head) return;
  head.classList.add("springtide-head");
  for (const button of head.querySelectorAll(".mantine-Button-root")) {
    const name = button.textContent;
    if (!(name in HINTS) || button.dataset.springtideIcon === name) continue;
    button.dataset.springtideIcon = name;
    button.title = HINTS[name];
  }
}

// One Tab stop for the buttons of the block, and one for the tabs: arrows move on from there. A single tab is no stop.
function roveStops() {
  for (const alone of document.querySelectorAll('[role="tab"]:only-child')) if (!alone.tabIndex) alone.tabIndex = -1;
  const groups = [
    [...document.querySelectorAll("[data-springtide-icon]")],
    [...document.querySelectorAll('[data-dock-area^="gui-tabs-"] [role="tab"]')],
  ];
  for (const group of groups) {
    const first = group.find((one) => one === document.activeElement || one.ariaSelected === "true") ?? group[0];
    for (const one of group) if (one.tabIndex !== (one === first ? 0 : -1)) one.tabIndex = one === first ? 0 : -1;
  }
}
/** @type {Record<string, number>} */
const STEPS = { ArrowRight: 1, ArrowLeft: -1 }; // along the buttons of the block
page.listen(document, "keydown", (event) => {
  const by = STEPS[event.key];
  if (!by || !(event.target instanceof HTMLElement) || !event.target.dataset.springtideIcon) return;
  const row = [...document.querySelectorAll("[data-springtide-icon]")];
  row[(row.indexOf(event.target) + by + row.length) % row.length].focus();
  event.preventDefault();
  event.stopPropagation();
}, { capture: true });

// C goes to the first control of the shown tab.
const CONTROL = "input, textarea, .mantine-Slider-thumb, button";
page.listen(document, "keydown", (event) => {
  if (event.key.toLowerCase() !== "c" || isTyping(event) || event.ctrlKey || event.metaKey || event.altKey) return;
  /** @type {NodeListOf<HTMLButtonElement>} */
  const controls = document.querySelectorAll(`[data-dock-area^="gui-tabs-"] :is(${CONTROL}), .mantine-Tabs-panel :is(${CONTROL})`);
  [...controls].find((one) => one.checkVisibility() && !one.disabled)?.focus();
  event.preventDefault();
});

function adorn() {
  nameFields();
  markLab();
  nameArrows();
  roveStops();
}
onControls(adorn);
page.listen(document, "focusin", roveStops);
