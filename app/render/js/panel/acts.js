// The button "Undo": its hint names the act that it takes back. Without one it is disabled, and the hint says so.

import { onChange } from "../core/watch.js";

function update() {
  const told = document.querySelector("[data-springtide-undo]");
  /** @type {HTMLButtonElement | null} */
  const button = document.querySelector('[data-springtide-icon="Undo"]');
  if (!told || !button) return;
  const { springtideUndo: undo = "", springtideRedo: redo = "" } = told.dataset;
  const again = redo && `. Redo: ${redo} (Ctrl+Shift+Z)`;
  const title = `${undo ? `Undo: ${undo} (U or Ctrl+Z)` : "There is nothing to undo"}${again}`;
  if (button.title !== title) button.title = title;
  if (button.disabled === Boolean(undo)) button.disabled = !undo;
}

onChange(update);
