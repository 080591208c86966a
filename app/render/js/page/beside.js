// A lab beside others: its page is a frame in the page of the comparison (beside/main.js).
//
// A page on its own goes there as soon as its lab is compared with others. In a frame the panel is hidden until the user opens
// it, and the picture fills the frame, so that all frames show the same part at the same scale.

import { onTopic } from "../core/channel.js";

const framed = (() => {
  try {
    return window.parent !== window && window.parent.__springtide?.beside === true;
  } catch {
    return false; // embedded in a page of another origin
  }
})();
if (framed) document.documentElement.classList.add("springtide-framed", "springtide-bare");

onTopic("panes", (panes) => {
  if (!framed && panes?.length) location.replace(new URL(`beside${location.search}`, location.href));
});
