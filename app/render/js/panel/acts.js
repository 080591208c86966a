// The button "Undo": its hint names the act that it takes back. Without one it is disabled, and the hint says so.

import { topicState } from "../core/channel.js";
import { onChange } from "../core/watch.js";

function update() {
  const acts = topicState("acts");
  /** @type {HTMLButtonElement | null} */
  const button = document.querySelector('[data-springtide-icon="Undo"]');
  if (!acts || !button) return;
  const { undo, redo } = acts;
  const again = redo && `. Redo: ${redo} (Ctrl+Shift+Z or Ctrl+Y)`;
  const title = `${undo ? `Undo: ${undo} (U or Ctrl+Z)` : "There is nothing to undo"}${again}`;
  if (button.title !== title) button.title = title;
  if (button.disabled === Boolean(undo)) button.disabled = !undo;
}

onChange(update);
