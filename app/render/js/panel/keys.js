// Keys of the lab: not those that type into a field, and on a keyboard of any layout.

import { page } from "../core/life.js";
import { latinKey } from "./layouts.js";

/** @param {Event} event */
export const isTyping = ({ target }) => target instanceof Element && target.matches("input, textarea, select");

page.listen(window, "keydown", (event) => {
  if (isTyping(event)) return;
  const isBrowsers = event.metaKey && !event.ctrlKey && latinKey(event).key === "y"; // Cmd+Y shows the history, viser would redo
  if (isBrowsers) return void event.stopPropagation();
  for (const [name, value] of Object.entries(latinKey(event))) {
    if (Reflect.get(event, name) !== value) Object.defineProperty(event, name, { value });
  }
}, { capture: true });
