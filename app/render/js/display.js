// How this browser shows the panel: light or dark, and the size of its text. Each browser remembers its own.
//
// Without a choice the panel is as dark as the system asks for. The server is told, which gives this browser viser's dark
// theme and a dark floor; the colour scheme is set here at once, so that nothing flashes in between.

(() => {
  "use strict";
  const SCHEME = "data-mantine-color-scheme";
  const CHOICES = { dark: "springtide-dark", large: "springtide-large" };
  const systemDark = matchMedia("(prefers-color-scheme: dark)");

  function chosen(name) {
    const stored = localStorage.getItem(CHOICES[name]);
    return stored === null ? name === "dark" && systemDark.matches : stored === "yes";
  }

  function apply() {
    const scheme = chosen("dark") ? "dark" : "light";
    document.documentElement.classList.toggle("springtide-large", chosen("large"));
    document.documentElement.classList.toggle("springtide-dark", chosen("dark"));
    if (document.documentElement.getAttribute(SCHEME) !== scheme) document.documentElement.setAttribute(SCHEME, scheme);
    for (const button of document.querySelectorAll("[data-springtide-switch]")) {
      const pressed = String(chosen(button.dataset.springtideSwitch));
      if (button.getAttribute("aria-pressed") !== pressed) button.setAttribute("aria-pressed", pressed);
    }
    for (const label of document.querySelectorAll(".mantine-Switch-label")) {
      // viser's own, which would do nothing here.
      if (label.textContent === "Dark Mode") label.closest(".mantine-Switch-root").style.display = "none";
    }
    tellServer();
  }

  // The server draws the floor for each browser: light, or dark.
  const told = new Map(); // identifier of a panel's hidden button -> whether this panel's scene is dark
  function tellServer() {
    const holder = document.querySelector("[data-springtide-dark]");
    const send = window.__viserMutable?.sendMessage;
    if (!holder || !send) return;
    const { springtideDark, springtideLight } = holder.dataset;
    const dark = chosen("dark");
    if ((told.get(springtideDark) ?? false) === dark) return; // a scene begins light
    told.set(springtideDark, dark);
    send({ type: "GuiUpdateMessage", uuid: dark ? springtideDark : springtideLight, updates: { value: true } });
  }

  document.addEventListener("click", (event) => {
    if (event.target instanceof Element && event.target.closest("[data-springtide-display]")) {
      document.querySelector("button:has(.tabler-icon-adjustments)")?.click(); // viser's own settings
      return;
    }
    const button = event.target instanceof Element && event.target.closest("[data-springtide-switch]");
    if (!button) return;
    const name = button.dataset.springtideSwitch;
    localStorage.setItem(CHOICES[name], chosen(name) ? "no" : "yes");
    apply();
  });
  systemDark.addEventListener("change", apply);
  addEventListener("storage", (event) => Object.values(CHOICES).includes(event.key) && apply());
  // viser's client sets its own scheme when it starts; the switches come with each scene.
  new MutationObserver(apply).observe(document.documentElement, {
    attributes: true, attributeFilter: [SCHEME],
  });
  new MutationObserver(apply).observe(document.body, { childList: true, subtree: true });
  apply();
})();
