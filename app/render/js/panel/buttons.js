// Buttons of our own in the panel: the attribute `data-springtide-act` names what a press does. Other files add theirs.

import { say } from "../core/channel.js";
import { page } from "../core/life.js";

/** @typedef {(button: HTMLElement, event: MouseEvent) => void} Press */
/** @type {Record<string, Press>} */
const presses = {
  scene: (button) => say("scene", button.getAttribute("value")),
  map: (map, event) => {
    if (!(map instanceof SVGGraphicsElement)) return;
    const [left, top, width, height] = (map.dataset.axes ?? "").split(" ").map(Number);
    const place = new DOMPoint(event.clientX, event.clientY).matrixTransform(map.getScreenCTM()?.inverse());
    const shares = [(place.x - left) / width, 1 - (place.y - top) / height];
    if (shares.every((share) => share >= 0 && share <= 1)) say("map", shares);
  },
};

/** @param {string} act @param {Press} press */
export const onPress = (act, press) => (presses[act] = press);

page.listen(document, "click", (event) => {
  const button = event.target instanceof Element ? event.target.closest("[data-springtide-act]") : null;
  if (button) presses[button.dataset.springtideAct ?? ""]?.(button, event);
}, { capture: true });
