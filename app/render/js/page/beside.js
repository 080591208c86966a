// A lab that is shown beside others: its page is a frame of the page with the panes (beside.html).
//
// A page that stands alone goes there as soon as the lab says that it has others beside it. In a frame the panel is hidden
// until it is asked for, and the picture takes the whole frame, so that all frames show the same part at the same scale.

import { page } from "../core/life.js";
import { onControls } from "../core/watch.js";

const FOCUS_INTERVAL = 1000; // [ms]

const framed = (() => {
  try {
    return window.parent !== window && window.parent.__springtide?.beside === true;
  } catch {
    return false; // a page of another address shows this one
  }
})();
if (framed) {
  document.documentElement.classList.add("springtide-framed", "springtide-bare");
  // viser connects again only while its page has the focus, which one frame has at most: all have it with their page.
  const hasFocus = () => window.parent.document.hasFocus();
  let had = hasFocus();
  document.hasFocus = hasFocus;
  page.every(FOCUS_INTERVAL, () => {
    if (hasFocus() === had) return;
    had = !had;
    dispatchEvent(new Event(had ? "focus" : "blur"));
  });
}

function update() {
  if (!framed && document.querySelector('[data-springtide-beside]:not([data-springtide-beside="[]"])')) {
    location.replace(new URL(`beside${location.search}`, location.href));
  }
}

onControls(update);
