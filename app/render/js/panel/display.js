// Display settings of this browser: light or dark, and the size of its text. Each browser remembers its own.
//
// Without a choice the panel follows the system. The server gives this browser viser's dark theme and a dark floor; the colour
// scheme is set here at once, so that nothing flashes in between.

import { tell } from "../core/channel.js";
import { page } from "../core/life.js";
import { store, stored } from "../core/storage.js";
import { onControls, onValues } from "../core/watch.js";
import { onPress } from "./buttons.js";

const SCHEME = "data-mantine-color-scheme";
/** @typedef {keyof typeof CHOICES} Choice */
const CHOICES = { dark: "springtide-dark", large: "springtide-large" };
const NAMES = /** @type {Choice[]} */ (Object.keys(CHOICES));
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
  for (const name of NAMES) {
    const button = document.querySelector(`[data-springtide-act=${name}]`), pressed = String(chosen(name));
    if (button && button.getAttribute("aria-pressed") !== pressed) button.setAttribute("aria-pressed", pressed);
  }
  for (const label of document.querySelectorAll(".mantine-Switch-label")) {
    // viser's own switch, which would do nothing here.
    if (label.textContent === "Dark Mode") label.closest(".mantine-Switch-root")?.style.setProperty("display", "none");
  }
  // The server draws the floor for each browser, light unless it knows otherwise.
  wasDark ||= chosen("dark");
  if (wasDark) tell("dark", chosen("dark"));
}
let wasDark = false;

for (const name of NAMES) {
  onPress(name, () => {
    store(CHOICES[name], chosen(name) ? "no" : "yes");
    apply();
  });
}
onPress("display", () => document.querySelector("[data-springtide-is~=settings]")?.click()); // viser's own settings
page.listen(systemDark, "change", apply);
page.listen(window, "storage", (event) => Object.values(CHOICES).includes(event.key ?? "") && apply());
// viser's client sets its own scheme when it starts; the switches come with each scene.
onControls(apply);
onValues(apply);
