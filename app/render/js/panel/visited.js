// Back and Forward of the browser go through the scenes and presets that this page has shown.
//
// An entry of the browser's history holds the query of a scene and preset, which the lab is asked for as for that of a
// link. The address stays as it is: a page that is loaded again shows what the lab shows. A lab within another page leaves
// that page's history alone.

import { page } from "../core/life.js";
import { PAGE, send } from "../core/viewer.js";
import { onChange } from "../core/watch.js";

const PATIENCE = 10_000; // [ms] for what was asked for to be shown
let here = ""; // the query of what is shown
/** @type {{ query: string, until: number } | null} */
let asked = null; // by Back or Forward

function follow() {
  const query = document.querySelector("[data-springtide-here]")?.dataset.springtideHere;
  if (!query || query === here) return;
  const isFirst = !here, isAwaited = asked !== null && performance.now() < asked.until;
  if (!isAwaited || asked?.query === query) asked = null;
  here = query;
  if (isAwaited) return;
  history[isFirst ? "replaceState" : "pushState"]({ springtide: query }, "");
}

if (window.top === window) {
  page.listen(window, "popstate", ({ state }) => {
    const query = state?.springtide, inbox = document.querySelector("[data-springtide-inbox]")?.dataset.springtideInbox;
    if (!query || (query === here && !asked)) return;
    asked = { query, until: performance.now() + PATIENCE };
    send(inbox, `${PAGE}\n${query}`);
  });
  onChange(follow);
}
