// Marks on unnamed elements of viser's page, for page.css and for the parts that measure panels.
//
// The selectors say by `:has` what an element holds. In a style sheet the browser would check them again, and with them the
// style of the whole panel, each time that the panel says another number, which is many times a second.

import { onControls } from "../core/watch.js";

export const PANEL = "[data-floating-window], [data-springtide-is~=sheet]"; // the panel in a window, or on a phone
const ROW = "> .mantine-Flex-root"; // of a control of viser's: its name and its field
const FOLDER = "> .mantine-Paper-root:first-child"; // its title
const RESULT = ":is(.springtide-verdict, .springtide-refusal)"; // of a check in the lab
const MARK = "data-springtide-is"; // attribute with the names of an element's marks: React rewrites classes
// Name of the mark -> selector.
const MARKS = {
  // Panels
  alone: "[data-floating-window]:not(:has([data-floating-divider]))", // a window with one panel
  sheet: ".mantine-Paper-root:has(> * > .mantine-ScrollArea-root)", // the panel on a phone
  bar: '.mantine-Tabs-root:has(> [aria-label$=" panel Plots"])', // the plots on a phone
  scrolled: "[data-floating-window] div:has(> div > .mantine-ScrollArea-root)",
  docked: "[data-dock-root]:has(> [data-dock-region])", // it has panels at its edges
  charted: "[data-dock-root]:has(> [data-dock-region] .uplot)", // these have charts
  "charted-left": '[data-dock-root]:has(> [data-dock-region="left"] .uplot)',
  before: "[data-dock-root] > :has(+ [data-dock-region])",
  "before-left": '[data-dock-root] > :has(+ [data-dock-region="left"] .uplot)',
  charts: ":is([data-floating-window], [data-dock-region], .mantine-Paper-root, .mantine-Tabs-root):has(.uplot)",
  single: ".u-legend:not(:has(.u-series + .u-series))", // the key of a chart with one line
  settings: ".mantine-ActionIcon-root:has(.tabler-icon-adjustments)",
  closed: `.mantine-Paper-root:has(${FOLDER} svg):not(:has(${FOLDER} .tabler-icon-chevron-up))`, // a folder
  // Rows of controls
  name: ".mantine-Flex-root > div:first-child:has(> p > label)",
  nameless: ".mantine-Flex-root > div:first-child:has(label:empty)",
  text: ".mantine-Flex-root:has(textarea)",
  list: ".mantine-Flex-root:has(.mantine-Select-root)",
  choice: `div:has(${ROW} .mantine-Select-root)`,
  row: `div:has(${ROW})`,
  button: "div:has(> .mantine-Button-root)",
  // A number in two rows: those of its field and of its slider.
  sliders: `div:has(> div ${ROW} > div > div > .multi-slider)`, // holds such rows
  field: `div:has(${ROW} .mantine-TextInput-root):has(+ div .multi-slider)`,
  slider: `div:has(${ROW} .mantine-TextInput-root) + div:has(${ROW} .multi-slider)`,
  wide: ".springtide-switches:has([data-springtide-choice=plots], [data-springtide-act=link], .springtide-load)", // its buttons
  // The lab of a course
  lab: ".mantine-ScrollArea-content div:has(.mantine-Paper-root .springtide-panel[data-state])", // holds the first block
  task: "div:has(> div > .springtide-note > .springtide-guide)",
  tasks: "div:has(+ div + div > .springtide-note > .springtide-guide)",
  guide: ".springtide-note:has(> .springtide-guide)",
  readings: "div:has(> .springtide-readings)",
  result: `div:has(> ${RESULT}):has(+ div ${ROW} button)`,
  check: `div:has(> ${RESULT}) + div:has(${ROW} button)`,
};

function mark() {
  /** @type {Map<Element, string>} */
  const marks = new Map(); // element -> names of its marks, with a space after each
  for (const [name, selector] of Object.entries(MARKS)) {
    for (const one of document.querySelectorAll(selector)) marks.set(one, `${marks.get(one) ?? ""}${name} `);
  }
  for (const one of document.querySelectorAll(`[${MARK}]`)) if (!marks.has(one)) one.removeAttribute(MARK);
  for (const [one, names] of marks) if (one.getAttribute(MARK) !== names) one.setAttribute(MARK, names);
}

onControls(mark);
