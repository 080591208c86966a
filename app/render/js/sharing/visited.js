// Back and Forward of the browser go through the scenes and presets that this page has shown.
//
// Each entry of the browser's history holds the query of a scene and preset. Going back sends it to the lab as a link would.
// The address does not change, so that a reload shows the present lab. A lab embedded in another page adds no entries.

import { onTopic } from "../core/channel.js";
import { page } from "../core/life.js";
import { open } from "./open.js";

const PATIENCE = 10_000; // [ms] for the lab to show the requested scene
let here = ""; // the query of the scene and preset shown
/** @type {{ query: string, until: number } | null} */
let asked = null; // requested by Back or Forward

/** @param {string | undefined} query */
function follow(query) {
  if (!query || query === here) return;
  const isFirst = !here, isAwaited = asked !== null && performance.now() < asked.until;
  if (!isAwaited || asked?.query === query) asked = null;
  here = query;
  if (isAwaited) return;
  history[isFirst ? "replaceState" : "pushState"]({ springtide: query }, "");
}

if (window.top === window) {
  page.listen(window, "popstate", ({ state }) => {
    const query = state?.springtide;
    if (!query || (query === here && !asked)) return;
    asked = { query, until: performance.now() + PATIENCE };
    open(query);
  });
  onTopic("acts", (acts) => follow(acts?.here));
}
