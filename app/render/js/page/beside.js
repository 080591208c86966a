// A lab beside others: its page is a frame in the page of the comparison (beside.html).
//
// A page on its own goes there as soon as its lab is compared with others. In a frame the panel is hidden until the user opens
// it, and the picture fills the frame, so that all frames show the same part at the same scale.

import { page } from "../core/life.js";
import { onControls } from "../core/watch.js";

const FOCUS_INTERVAL = 1000; // [ms]

const framed = (() => {
  try {
    return window.parent !== window && window.parent.__springtide?.beside === true;
  } catch {
    return false; // embedded in a page of another origin
  }
})();
if (framed) {
  document.documentElement.classList.add("springtide-framed", "springtide-bare");
  // viser reconnects only while its page has the focus, and only one frame can have it: here all have it with their page.
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
