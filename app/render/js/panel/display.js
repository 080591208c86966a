// Display settings of this browser: light or dark, and the size of its text. Each browser remembers its own.
//
// Without a choice the panel follows the system. The server gives this browser viser's dark theme and a dark floor; the colour
// scheme is set here at once, so that nothing flashes in between.

import { page } from "../core/life.js";
import { store, stored } from "../core/storage.js";
import { connectionNumber, send } from "../core/viewer.js";
import { onControls, onValues } from "../core/watch.js";

const SCHEME = "data-mantine-color-scheme";
/** @typedef {keyof typeof CHOICES} Choice */
const CHOICES = { dark: "springtide-dark", large: "springtide-large" };
const systemDark = matchMedia("(prefers-color-scheme: dark)");

/** @param {Choice} name */
function chosen(name) {
  const choice = stored(CHOICES[name]);
  return choice === null ? name === "dark" && systemDark.matches : choice === "yes";
}

function apply() {
  const scheme = chosen("dark") ? "dark" : "light";
  document.documentElement.classList.toggle("springtide-large", chosen("large"));
  document.documentElement.classList.toggle("springtide-dark", chosen("dark"));
  if (document.documentElement.getAttribute(SCHEME) !== scheme) document.documentElement.setAttribute(SCHEME, scheme);
  for (const button of document.querySelectorAll("[data-springtide-switch]")) {
    const pressed = String(chosen(/** @type {Choice} */ (button.dataset.springtideSwitch)));
    if (button.getAttribute("aria-pressed") !== pressed) button.setAttribute("aria-pressed", pressed);
  }
  for (const label of document.querySelectorAll(".mantine-Switch-label")) {
    // viser's own switch, which would do nothing here.
    if (label.textContent === "Dark Mode") label.closest(".mantine-Switch-root")?.style.setProperty("display", "none");
  }
  tellServer();
}

// The server draws the floor for each browser: light, or dark.
let told = ""; // the connection, the panel's hidden button, and the scheme, as sent last
function tellServer() {
  const holder = document.querySelector("[data-springtide-dark]");
  if (!holder) return;
  const { springtideDark, springtideLight } = holder.dataset;
  const dark = chosen("dark");
  const panel = `${connectionNumber()} ${springtideDark}`, now = `${panel} ${dark}`;
  if (now === told || (!dark && !told.startsWith(panel))) return; // a scene begins light
  if (send(dark ? springtideDark : springtideLight, true)) told = now;
}

page.listen(document, "click", (event) => {
  if (event.target instanceof Element && event.target.closest("[data-springtide-display]")) {
    document.querySelector("[data-springtide-is-settings]")?.click(); // viser's own settings
    return;
  }
  const button = event.target instanceof Element && event.target.closest("[data-springtide-switch]");
  if (!button) return;
  const name = /** @type {Choice} */ (button.dataset.springtideSwitch);
  store(CHOICES[name], chosen(name) ? "no" : "yes");
  apply();
});
page.listen(systemDark, "change", apply);
page.listen(window, "storage", (event) => Object.values(CHOICES).includes(event.key ?? "") && apply());
// viser's client sets its own scheme when it starts; the switches come with each scene.
onControls(apply);
onValues(apply);
