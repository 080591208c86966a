// The lab in a lecture hall: one chart that fills the window, or the picture above the charts, without the panel.
//
// The button at the corner of a chart makes it fill the window; viser alone would open a copy in a dialog of fixed height and
// type size. L, or "Projector" in the tab View, hides the panel, puts the charts along the lower third, and shows the state of
// the run in the picture. Both are classes of the page (page.css). Type and lines grow with the height of the window (charts.js).

import { page } from "../core/life.js";
import { onChange, onLook } from "../core/watch.js";
import { onPress } from "./buttons.js";
import { isTyping } from "./keys.js";

const ENLARGED = "springtide-enlarged", PROJECTING = "springtide-projecting"; // classes of the page
const CHART = ".uplot-container", MARK = "springtideFillsWindow"; // data attribute of the chart that fills the window
const DOCKED = "[data-dock-region]"; // charts that can fill the window; of others, as on a phone, viser opens its copy
const TICK = 12; // [pixels] of the numbers of a chart
const HALL_TICK = 22 / 800; // the same in a hall, over the height of the window
const LARGE = 1.3; // factor of "Large text" (page.css)
const root = document.documentElement;
const words = document.createElement("div");
words.id = "springtide-words";
words.innerHTML = `<span></span><button type="button" title="Key L, or Escape">End</button>`;
document.body.append(words);

const isIn = (/** @type {string} */ name) => root.classList.contains(name);

// [pixels] of the numbers of a chart.
export function tickSize() {
  const large = isIn("springtide-large") ? LARGE : 1;
  const hall = isIn(ENLARGED) || isIn(PROJECTING) ? Math.max(TICK, HALL_TICK * innerHeight) : TICK;
  return Math.round(large * hall);
}

// The factor of the sizes of a chart that belong to its numbers.
export const typeFactor = () => tickSize() / TICK;

const filling = () => document.querySelector(`${CHART}[data-springtide-fills-window]`);

/** @param {HTMLElement | null} chart */
function fill(chart) {
  const earlier = filling();
  if (earlier) delete earlier.dataset[MARK];
  if (chart) chart.dataset[MARK] = "";
  show();
}

/** @param {boolean} on */
function project(on) {
  root.classList.toggle(PROJECTING, on);
  show();
}

function show() {
  root.classList.toggle(ENLARGED, filling() !== null);
  const size = `${tickSize()}px`;
  if (root.style.getPropertyValue("--springtide-tick") !== size) root.style.setProperty("--springtide-tick", size);
  sayState();
  dispatchEvent(new Event("resize")); // viser measures its canvas, and the charts their pane
}

// The state of the run in the picture, in the panel's words.
function sayState() {
  const isHidden = !(isIn(PROJECTING) || isIn(ENLARGED));
  if (words.hidden !== isHidden) words.hidden = isHidden;
  const status = document.querySelector(".springtide-panel");
  if (words.hidden || !status) return;
  const said = /** @type {HTMLElement} */ (words.firstElementChild);
  if (said.innerHTML !== status.innerHTML) said.innerHTML = status.innerHTML; // writing it would count as a change of the page
}

onPress("projector", () => project(!isIn(PROJECTING)));
page.listen(document, "click", ({ target }) => {
  if (target instanceof Element && target.closest("#springtide-words button")) end();
}, { capture: true });
// Before viser handles it.
page.listen(window, "click", (event) => {
  const button = event.target instanceof Element ? event.target.closest(`${CHART} button`) : null;
  const chart = button?.closest(CHART);
  if (!chart?.closest(DOCKED)) return;
  event.stopPropagation();
  fill(chart === filling() ? null : chart);
}, { capture: true });

// End the view that was opened last.
function end() {
  if (filling()) fill(null);
  else project(false);
}

page.listen(document, "keydown", (event) => {
  if (isTyping(event) || event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.key === "Escape") end();
  else if (event.key.toLowerCase() === "l") project(!isIn(PROJECTING));
});
onChange(sayState);
// A closed chart no longer fills the window, and "Large text" may have changed.
onLook(() => {
  if (isIn(ENLARGED) !== (filling() !== null) || root.style.getPropertyValue("--springtide-tick") !== `${tickSize()}px`) show();
});
