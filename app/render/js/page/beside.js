// A lab beside others: its page is a frame in the page of the comparison (beside.html).
//
// A page on its own goes there as soon as its lab is compared with others. In a frame the panel is hidden until the user opens
// it, and the picture fills the frame, so that all frames show the same part at the same scale.

import { onControls } from "../core/watch.js";

const framed = (() => {
  try {
    return window.parent !== window && window.parent.__springtide?.beside === true;
  } catch {
    return false; // embedded in a page of another origin
  }
})();
if (framed) document.documentElement.classList.add("springtide-framed", "springtide-bare");

function update() {
  if (!framed && document.querySelector('[data-springtide-beside]:not([data-springtide-beside="[]"])')) {
    location.replace(new URL(`beside${location.search}`, location.href));
  }
}

onControls(update);
