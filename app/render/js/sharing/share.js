// Links and set-ups: the query of this page's address is sent to the lab once, and a chosen file is read here and sent as text;
// of a replay, the set-up file in it. The lab checks both. A link from the lab is shown with this page's own address. After a
// change of a shared lab, the page that made it shows its own sentence.
// Plots are saved here as one picture.
//
// Of viser this file uses the charts of the page.

import { page } from "../core/life.js";
import { PAGE, send } from "../core/viewer.js";
import { onControls } from "../core/watch.js";
import { chartsOfPage } from "../panel/charts.js";
import { download, toggleClip } from "./clip.js";
import { sendText } from "./inbox.js";
import { labAt, ofLab, setupIn } from "./links.js";
import { rowsOf } from "../panel/rows.js";

const MAX_LENGTH = 5000; // [characters] that the lab takes
const MAX_REPLAY = 2e8; // [bytes] of a replay
const ASKED = 3000; // [ms] after a press of "Copy link" for the link to arrive
const asked = new URLSearchParams(location.search);
let showsLab = asked.has("task"); // show the tab "Lab", also of a scene that the link opens, until another is chosen
let pressed = -Infinity;

// Request a file from the server, by a hidden button of the panel.
/** @param {string} value */
function make(value) {
  send(document.querySelector("[data-springtide-makers]")?.dataset.springtideMakers, value);
}

const own = `[data-springtide-changer="${PAGE}"]`, sentences = document.createElement("style");
sentences.textContent =
  `${own} .springtide-others, [data-springtide-changer]:not(${own}) .springtide-own { display: none; }`;
document.head.append(sentences);

// Copy a link to the clipboard, or select it if the browser refuses or the page has no encryption.
/** @param {HTMLAnchorElement} link */
async function copy(link) {
  try {
    await navigator.clipboard.writeText(link.href);
  } catch {
    getSelection()?.selectAllChildren(link);
    const hint = document.createElement("div");
    hint.setAttribute("role", "status");
    hint.textContent = `Press ${/Mac|iP/.test(navigator.platform) ? "⌘C" : "Ctrl+C"} to copy this link.`;
    link.after(hint);
  }
}

function completeLinks() {
  /** @type {NodeListOf<HTMLAnchorElement>} */
  const links = document.querySelectorAll("[data-springtide-link]:not([data-springtide-done])");
  for (const link of links) {
    link.dataset.springtideDone = "";
    link.href = labAt(location) + link.dataset.springtideLink;
    link.textContent = link.href;
    if (performance.now() - pressed < ASKED) copy(link);
  }
}

function update() {
  completeLinks();
  if (showsLab) {
    const found = [...document.querySelectorAll('[role="tab"]')].find((one) => one.textContent.trim() === "Lab");
    if (found && found.ariaSelected !== "true") {
      for (const kind of ["pointerdown", "pointerup"]) { // viser hears no click
        found.dispatchEvent(new PointerEvent(kind, { bubbles: true, isPrimary: true, pointerId: 1 }));
      }
    }
  }
}

// All charts below each other, each with its title above and the names of its lines below.
/** @param {HTMLElement} button */
function saveCharts(button) {
  const charts = chartsOfPage();
  if (!charts.length) {
    button.textContent = "Open a plot first";
    setTimeout(() => (button.textContent = "Save plots"), 3000);
    return;
  }
  const ratio = devicePixelRatio, line = 26 * ratio;
  const sheet = document.createElement("canvas");
  const pen = /** @type {CanvasRenderingContext2D} */ (sheet.getContext("2d"));
  const width = Math.max(...charts.map((chart) => chart.ctx.canvas.width));
  // The names of a chart's lines, in as many rows as they need.
  const keys = charts.map((chart) => {
    pen.font = `${11 * ratio}px sans-serif`;
    const shown = chart.series.slice(1).filter(({ show }) => show);
    const places = rowsOf(shown.map(({ label }) => pen.measureText(`— ${label}   `).width), 8 * ratio, width);
    return shown.map(({ label, _stroke: stroke }, k) => {
      const colour = typeof stroke === "string" ? stroke : "#888888";
      return { ...places[k], name: `— ${label}`, colour };
    });
  });
  const rows = keys.map((key) => 1 + Math.max(0, ...key.map(({ row }) => row)));
  sheet.width = width;
  sheet.height = charts.reduce((sum, chart, i) => sum + chart.ctx.canvas.height + (1 + rows[i]) * line, 0);
  const around = getComputedStyle(charts[0].root.parentElement ?? charts[0].root);
  pen.fillStyle = around.getPropertyValue("--mantine-color-body") || "#ffffff";
  pen.fillRect(0, 0, sheet.width, sheet.height);
  pen.textBaseline = "middle";
  let top = 0;
  charts.forEach((chart, i) => {
    const title = chart.root.querySelector(".u-title");
    pen.fillStyle = getComputedStyle(title || chart.root).color;
    pen.font = `bold ${13 * ratio}px sans-serif`;
    pen.fillText(title?.textContent || "", 8 * ratio, top + line / 2);
    pen.drawImage(chart.ctx.canvas, 0, top + line);
    const { left, top: under, width: long, height: tall } = chart.bbox; // the name of the axis at its end
    pen.font = `${11 * ratio}px sans-serif`;
    pen.textAlign = "right";
    pen.fillText(chart.series[0].label, left + long - 2 * ratio, top + line + under + tall - 8 * ratio);
    pen.textAlign = "left";
    top += line + chart.ctx.canvas.height;
    pen.font = `${11 * ratio}px sans-serif`;
    for (const { row, left, name, colour } of keys[i]) {
      pen.fillStyle = colour;
      pen.fillText(name, left, top + (row + 0.5) * line);
    }
    top += rows[i] * line;
  });
  sheet.toBlob((content) => content && download(content, "springtide-plots.png"));
}

page.listen(document, ["pointerdown", "keydown"], ({ isTrusted, target }) => {
  if (isTrusted && target instanceof Element && target.closest('[role="tab"]')) showsLab = false;
}, { capture: true });
// Choice in a list of the panel, if it is there.
/** @param {string} selector */
const choiceOf = (selector) => /** @type {HTMLSelectElement | null} */ (document.querySelector(selector))?.value;
page.listen(document, "click", (event) => {
  const button = event.target instanceof Element && event.target.closest("button");
  if (!button) return;
  if (button.textContent === "Copy link") pressed = performance.now();
  if ("springtideClip" in button.dataset) toggleClip();
  if (!("springtideCharts" in button.dataset)) return;
  const form = choiceOf("[data-springtide-plots]");
  form === "PNG" ? saveCharts(button) : make(`Plots as ${form}`);
}, { capture: true });
page.listen(document, "change", async (event) => {
  const field = event.target;
  if (!(field instanceof HTMLInputElement) || !("springtideLoad" in field.dataset) || !field.files?.length) return;
  const file = field.files[0];
  let text = await file.slice(0, 4 * MAX_LENGTH).text();
  if (text.trimStart().startsWith("<") && file.size <= MAX_REPLAY) {
    text = setupIn(await file.text()) ?? text;
  }
  // A text that is too long is sent up to the lab's limit, so that the lab reports the error.
  sendText(text.slice(0, MAX_LENGTH) || " ");
  field.value = "";
});
if (["scene", "task", "compare"].some((name) => asked.has(name))) sendText(ofLab(location.search));
onControls(update);
