// A sentence over the page that stays until it is closed.

// id: of its only element. A text that is "" takes it away.
/** @param {string} id @param {string} text */
export function notice(id, text) {
  document.getElementById(id)?.remove();
  if (!text) return;
  const made = document.createElement("div"), close = document.createElement("button");
  made.id = id;
  made.className = "springtide-notice";
  made.setAttribute("role", "alert");
  made.textContent = text;
  close.type = "button";
  close.textContent = "Close";
  close.addEventListener("click", () => made.remove());
  made.append(close);
  document.body.append(made);
}
