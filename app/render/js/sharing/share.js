// Links and set-ups: the query of this page's address is sent to the lab once, and a chosen file is read here and sent as text;
// of a replay, the set-up file in it. The lab checks both. A link from the lab is shown with this page's own address. After a
// change of a shared lab, the page that made it shows its own sentence.
// Plots are saved here as one picture.
//
// Of viser this file uses the charts of the page.

import { page } from "../core/life.js";
import { notice } from "../core/notice.js";
import { PAGE, send } from "../core/viewer.js";
import { onControls } from "../core/watch.js";
import { chartsOfPage } from "../panel/charts.js";
import { download, toggleClip } from "./clip.js";
import { arrive, copyNext } from "./copy.js";
import { sendText } from "./inbox.js";
import { labAt, ofLab, setupIn } from "./links.js";
import { rowsOf } from "../panel/rows.js";

const MAX_LENGTH = 5000; // [characters] that the lab takes
const MAX_REPLAY = 2e8; // [bytes] of a replay
const asked = new URLSearchParams(location.search);
let showsLab = asked.has("task"); // show the tab "Lab", also of a scene that the link opens, until another is chosen

// Request a file from the server, by a hidden button of the panel.
/** @param {string} value */
function make(value) {
  send(document.querySelector("[data-springtide-makers]")?.dataset.springtideMakers, value);
}

const own = `[data-springtide-changer="${PAGE}"]`, sentences = document.createElement("style");
sentences.textContent =
  `${own} .springtide-others, [data-springtide-changer]:not(${own}) .springtide-own { display: none; }`;
document.head.append(sentences);

const KEYS = /Mac|iP/.test(navigator.platform) ? "⌘C" : "Ctrl+C";
/** @type {HTMLAnchorElement | null} */
let latest = null; // the link that this page has asked for

// Say below the link what came of the press.
/** @param {string} text */
function sayCopied(text) {
  const said = document.createElement("div");
  said.className = "springtide-copied";
  said.setAttribute("role", "status");
  said.textContent = text;
  latest?.parentElement?.querySelector(".springtide-copied")?.remove();
  latest?.before(said);
}

async function copyLink() {
  notice("springtide-copy", "");
  try {
    const isCopied = await copyNext(navigator.clipboard, Reflect.get(window, "ClipboardItem")); // which is newer than the oldest browsers
    if (!isCopied && latest) getSelection()?.selectAllChildren(latest);
    sayCopied(isCopied ? "Copied to the clipboard:" : `The browser did not copy it. Press ${KEYS} to copy this link:`);
  } catch (error) {
    if (error instanceof Error && error.message === "late") {
      notice("springtide-copy", "The lab sent no link, so nothing was copied. Press Copy link again.");
    }
  }
}

// The lab gives each link a number, so that a second press is answered too.
function completeLinks() {
  /** @type {NodeListOf<HTMLAnchorElement>} */
  const links = document.querySelectorAll("[data-springtide-link]:not([data-springtide-done])");
  for (const link of links) {
    link.dataset.springtideDone = "";
    link.href = labAt(location) + link.dataset.springtideLink;
    link.textContent = link.href;
    if (arrive(link.href)) latest = link;
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
  /** @param {string} words */
  const refuse = (words) => {
    button.textContent = words;
    setTimeout(() => (button.textContent = "Save plots"), 3000);
  };
  if (!charts.length) return refuse("Open a plot first");
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
  sheet.toBlob((content) => {
    if (!content || !download(content, "springtide-plots.png")) refuse("No picture was made");
  });
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
  if (button.textContent === "Copy link") copyLink();
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
