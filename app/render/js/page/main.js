// Starts the parts of the page. If one fails to load or to start, a notice names it, and the others work.

/** @type {Record<string, () => Promise<object>>} */
const PARTS = {
  cover: () => import("./cover.js"),
  line: () => import("./line.js"),
  veil: () => import("./veil.js"),
  marks: () => import("../panel/marks.js"),
  scene: () => import("../scene/main.js"),
  camera: () => import("./camera.js"),
  fields: () => import("../panel/fields.js"),
  charts: () => import("../panel/charts.js"),
  hall: () => import("../panel/hall.js"),
  timeline: () => import("../panel/timeline.js"),
  share: () => import("../sharing/share.js"),
  visited: () => import("../sharing/visited.js"),
  acts: () => import("../panel/acts.js"),
  display: () => import("../panel/display.js"),
  keys: () => import("../panel/keys.js"),
  accessibility: () => import("../panel/accessibility.js"),
  reach: () => import("./reach.js"),
  drag_hint: () => import("./drag_hint.js"),
  beside: () => import("./beside.js"),
};

const names = Object.keys(PARTS);
const ended = await Promise.allSettled(names.map((name) => PARTS[name]()));
const missing = names.filter((_, k) => ended[k].status === "rejected");
for (const one of ended) if (one.status === "rejected") console.error(one.reason);
if (missing.length > 0) {
  const { notice } = await import("../core/notice.js");
  notice("springtide-missing", `A part of this page did not start: ${missing.join(", ")}. The rest works. Load the page again to retry.`);
}
