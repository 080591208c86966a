// Gaps in the charts: uPlot leaves a gap at null only, and viser sends arrays of numbers, in which NaN means no value.
// On a logarithmic scale uPlot takes NaN for its lowest value.
// Crosses at the upper edge, with their words, at the values of the series of the class "springtide-cross".
// The time axis: viser keeps its visible part, and on a slow page loses it when a chart is remade. Here the whole axis is shown
// again, unless the user has zoomed.
// The name of the first axis, at its end (page.css). The height of the charts: a whole number of them fills their pane.
// The size of type and lines: by "Large text", and in a lecture hall by the height of the window (hall.js).
// A line in charts over time, at the moment of the recording that the time line shows (timeline.js).
//
// Of viser this file uses window.__viserTestpoints.uplots, the charts of the page.

import { page } from "../core/life.js";
import { onControls, onFrame, onLook } from "../core/watch.js";
import { tickSize, typeFactor } from "./hall.js";

const BELOW = 4; // [pixels] of a pane below its charts
const MIN_HEIGHT = 150; // [pixels] of a chart with its title, or as high as its pane
const MIN_CANVAS = 70; // [pixels] of a chart without its title
const PANES = ".mantine-ScrollArea-viewport:has(.uplot):not(:has(.springtide-panel))";
const PHONE = matchMedia("(max-width: 36em)"), PHONE_PANES = "[data-springtide-is~=bar]";
const PHONE_SHARE = 0.32; // of the window's height, for the plots on a phone (page.css)
const MIN_ZOOM = 3; // [pixels] of a drag that zooms; uPlot's own is less
const TICK_HEIGHT = 1.1; // of the words of a tick, in sizes of their type
const TICK_ROOM = 17; // [pixels] beside the words: uPlot's tick and the gap between
const LEAST_WORDS = 24; // [pixels] so that a chart keeps its place from 9 to 10
const CROSS = "springtide-cross", PLACED = "springtide-placed-cross";
const CROSS_HEIGHT = 14, CROSS_WIDTH = 8; // [pixels] of a cross in type of 12 pixels; its words stand to its right
const CROSS_STYLE = "position:absolute;white-space:nowrap;pointer-events:none";
const LINE_STYLE = "position:absolute;top:0;bottom:0;width:0;border-left:2px solid #e03131;pointer-events:none";

// The charts of the page.
export const chartsOfPage = () => Object.values(window.__viserTestpoints?.uplots ?? {}).map(({ chart }) => chart);

// Pass null to uPlot for each NaN of a column, before it makes the path of a line.
const isWatched = new WeakSet(); // series
/** @param {uplot.Chart} chart */
function leaveGaps(chart) {
  const without = chart.series.filter((series, k) => k > 0 && !isWatched.has(series));
  for (const series of without) {
    const { paths } = series;
    series.paths = (own, k, ...rest) => {
      if (own.data[k].some(Number.isNaN)) own.data[k] = Array.from(own.data[k], (y) => (Number.isNaN(y) ? null : y));
      return paths(own, k, ...rest);
    };
    isWatched.add(series);
  }
  if (without.length) chart.redraw();
}

/** @param {uplot.Chart} chart */
function placeCrosses(chart) {
  /** @type {[left: number, label: string, stroke: unknown][]} */
  const wanted = [];
  chart.series.forEach(({ class: kind, label, _stroke, show }, k) => {
    if (kind !== CROSS || !show) return;
    chart.data[k].forEach((y, row) => {
      if (y !== null && !Number.isNaN(y)) wanted.push([chart.valToPos(chart.data[0][row], "x"), label, _stroke]);
    });
  });
  const marks = [...chart.over.querySelectorAll(`.${PLACED}`)];
  while (marks.length > wanted.length) marks.pop()?.remove();
  const factor = typeFactor(), [high, wide] = [factor * CROSS_HEIGHT, factor * CROSS_WIDTH];
  wanted.forEach(([left, label, stroke], n) => {
    let mark = marks[n];
    if (!mark) {
      mark = document.createElement("div");
      mark.className = PLACED;
      chart.over.append(mark);
    }
    const place = `top:${(n - 0.5) * high}px;left:${left - wide / 2}px`;
    const style = `${CROSS_STYLE};font:${tickSize()}px/${high}px sans-serif;color:${stroke};${place}`;
    if (mark.dataset.style !== style) {
      mark.dataset.style = style;
      mark.style.cssText = style;
    }
    if (mark.textContent !== label) mark.textContent = label;
  });
}

// A drag across a chart zooms it, a double click ends that.
/** @type {{ over: HTMLElement, x: number } | null} */
let pressed = null; // place in a chart where the mouse was pressed
/** @param {uplot.Chart} chart */
function watchZoom({ over }) {
  page.listen(over, "mousedown", (event) => (pressed = { over, x: event.clientX }));
  page.listen(over, "dblclick", () => delete over.dataset.springtideZoomed);
  over.dataset.springtideWatched = "";
}
page.listen(window, "mouseup", (event) => {
  if (pressed && Math.abs(event.clientX - pressed.x) > MIN_ZOOM) pressed.over.dataset.springtideZoomed = "";
  pressed = null;
});

/** @param {uplot.Chart} chart */
function showWholeAxis(chart) {
  const { x } = chart.scales, times = /** @type {number[]} */ (chart.data[0]);
  if (!("springtideWatched" in chart.over.dataset)) watchZoom(chart);
  if ("springtideZoomed" in chart.over.dataset || !x.auto(chart, false)) return;
  const min = times[0], max = times[times.length - 1];
  if (max > min && (x.min !== min || x.max !== max)) chart.setScale("x", { min, max });
}

// Place the line of a chart at the moment [s]; none for NaN or a moment outside the chart.
/** @param {uplot.Chart} chart @param {number} moment */
function placeMoment(chart, moment) {
  const { min, max } = chart.scales.x;
  const shown = chart.series[0].label === "t [s]" && moment >= min && moment <= max;
  let line = chart.over.querySelector(".springtide-moment");
  if (!shown) {
    line?.remove();
    return;
  }
  if (!line) {
    line = document.createElement("div");
    line.className = "springtide-moment";
    line.style.cssText = LINE_STYLE;
    chart.over.append(line);
  }
  const left = `${chart.valToPos(moment, "x")}px`;
  if (line.style.left !== left) line.style.left = left;
}

// As many charts as fit share the height of a pane; the others are reached by scrolling.
/** @param {uplot.Chart[]} charts */
function fillPanes(charts) {
  if (!charts.length) return;
  for (const pane of document.querySelectorAll(PHONE.matches ? PHONE_PANES : PANES)) {
    const own = charts.filter(({ root }) => pane.contains(root) && root.offsetHeight);
    own.sort((a, b) => a.root.getBoundingClientRect().top - b.root.getBoundingClientRect().top);
    if (!own.length) continue;
    const [first] = own, whole = PHONE.matches ? window.innerHeight * PHONE_SHARE : pane.clientHeight;
    const top = first.root.getBoundingClientRect().top - pane.getBoundingClientRect().top + pane.scrollTop;
    const room = whole - top - BELOW, between = gapOf(own);
    const seen = Math.max(1, Math.min(own.length, Math.floor(room / (MIN_HEIGHT * typeFactor()))));
    for (const chart of own) {
      const around = chart.root.offsetHeight - chart.height; // title and key
      const height = Math.max(MIN_CANVAS, Math.floor((room + between) / seen - between - around));
      if (Math.abs(height - chart.height) > 2) chart.setSize({ width: chart.width, height });
    }
  }
}

// [pixels] between two charts of a pane.
/** @param {uplot.Chart[]} charts */
function gapOf([first, second]) {
  if (!second) return 0;
  return Math.max(0, second.root.getBoundingClientRect().top - first.root.getBoundingClientRect().bottom);
}

/** @typedef {Pick<uplot.Axis, "font" | "size" | "space">} AxisSizes */
// Sizes of axes, charts and series as viser has set them.
/** @type {WeakMap<uplot.Axis, AxisSizes>} */
const axisSizes = new WeakMap();
/** @type {WeakMap<uplot.Chart, uplot.Padding>} */
const paddings = new WeakMap();
/** @type {WeakMap<uplot.Series, number>} */
const widths = new WeakMap();
/** @type {WeakMap<uplot.Chart, number>} */
const sizedAs = new WeakMap(); // chart -> its factor

// Set the size of a chart's numbers and lines. uPlot keeps the font of an axis as [CSS, size in pixels of the canvas, size]; if
// another version differs, the numbers keep their size.
/** @param {uplot.Chart} chart */
function sizeType(chart) {
  const factor = typeFactor();
  if ((sizedAs.get(chart) ?? 1) === factor) return;
  sizedAs.set(chart, factor);
  for (const [k, axis] of chart.axes.entries()) {
    const { font, size, space } = axisSizes.get(axis) ?? axis;
    if (!axisSizes.has(axis)) axisSizes.set(axis, { font, size, space });
    if (!Array.isArray(font) || typeof font[0] !== "string") continue;
    const [css, onCanvas, onPage] = font, scaled = css.replace(/[\d.]+px/, (old) => `${factor * Number.parseFloat(old)}px`);
    axis.font = [scaled, factor * onCanvas, factor * onPage];
    axis.size = (...given) => factor * size(...given);
    if (k === 0) axis.space = (...given) => factor * space(...given);
  }
  if (Array.isArray(chart.padding)) {
    const padding = paddings.get(chart) ?? chart.padding[0]; // half of the highest number
    paddings.set(chart, padding);
    if (typeof padding === "function") chart.padding[0] = (...given) => factor * padding(...given);
  }
  for (const series of chart.series.slice(1)) {
    const width = widths.get(series) ?? series.width;
    widths.set(series, width);
    series.width = factor * width;
  }
  chart.setSize({ width: chart.width, height: chart.height });
}

const isFitted = new WeakSet(); // axes
const ruler = document.createElement("canvas").getContext("2d");

// [pixels] of the longest words of an axis, in type of the size that viser has set. They depend on the fonts of the system.
/** @param {uplot.Axis} axis @param {string[]} words */
function widthOf(axis, words) {
  const { font } = axisSizes.get(axis) ?? axis;
  if (!ruler || !Array.isArray(font)) return LEAST_WORDS;
  const [css, onCanvas, onPage] = font;
  ruler.font = css;
  return Math.max(LEAST_WORDS, ...words.map((word) => (ruler.measureText(word).width * onPage) / onCanvas));
}

// Make room for the words of the ticks, and leave out those that would stand in the words of the tick before: a chart may be
// low.
/** @param {uplot.Chart} chart */
function fitTicks({ axes: [, axis] }) {
  if (!axis || isFitted.has(axis) || typeof axis.values !== "function") return;
  const { values } = axis;
  axis.size = (chart, words) => Math.ceil(TICK_ROOM + widthOf(axis, words ?? []));
  axis.filter = (chart, splits) => splits; // uPlot leaves out ticks of a logarithmic axis, but not their words
  axis.values = (chart, splits, ...rest) => {
    let last = Infinity;
    return values(chart, splits, ...rest).map((word, k) => {
      const at = chart.valToPos(splits[k], axis.scale);
      if (!word || Math.abs(at - last) < TICK_HEIGHT * tickSize()) return "";
      last = at;
      return word;
    });
  };
  isFitted.add(axis);
}

/** @param {uplot.Chart} chart */
function nameAxis({ over, series }) {
  if (over.dataset.springtideAxis !== series[0].label) over.dataset.springtideAxis = series[0].label;
}

let moment = ""; // [s] of the recording, as the time line gives it

function look() {
  const charts = chartsOfPage();
  charts.forEach(fitTicks);
  charts.forEach(sizeType);
  fillPanes(charts);
  for (const chart of charts) {
    nameAxis(chart);
    showWholeAxis(chart);
    placeMoment(chart, moment === "" ? NaN : Number(moment));
    leaveGaps(chart);
    placeCrosses(chart);
  }
}

onFrame(() => {
  const now = document.getElementById("springtide-time")?.dataset.moment || "";
  if (now === moment) return;
  moment = now;
  look();
});
onLook(look);
// A new chart is prepared before it is first drawn: viser makes it, and uPlot draws a moment later.
onControls(look);
