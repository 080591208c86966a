// Links and set-ups: what stands in the address of this page is sent to the lab once, and a file that is chosen is read
// here and sent as text. The lab checks both. A link that the lab has made is shown with this page's own address.

(() => {
  "use strict";
  const MAX_LENGTH = 5000; // [characters] that the lab takes
  const ASKED = 3000; // [ms] after a press of "Copy link" within which a link is copied to the clipboard
  const VISER_NAMES = new Set([
    "darkMode", "dummyWindowDimensions", "dummyWindowTitle", "fixedDpr", "forceOrbitOriginTool", "hideViserLogo",
    "initialCameraLookAt", "initialCameraPosition", "initialCameraUp", "logCamera", "playbackPath", "showStats", "websocket",
  ]);
  let query = new URLSearchParams(location.search).has("scene") ? location.search : "";
  let pressed = -Infinity;

  function send(text) {
    const uuid = document.querySelector("[data-springtide-inbox]")?.dataset.springtideInbox;
    const post = window.__viserMutable?.sendMessage;
    if (!uuid || !post) return false;
    post({ type: "GuiUpdateMessage", uuid, updates: { value: text } });
    return true;
  }

  // What viser's client itself takes from an address is not for the lab.
  function ofLab(search) {
    const found = new URLSearchParams(search);
    for (const name of [...found.keys()]) if (VISER_NAMES.has(name)) found.delete(name);
    return `?${found}`;
  }

  function completeLinks() {
    for (const link of document.querySelectorAll("[data-springtide-link]:not([data-springtide-done])")) {
      link.dataset.springtideDone = "";
      link.href = location.origin + location.pathname + link.dataset.springtideLink;
      link.textContent = link.href;
      if (performance.now() - pressed < ASKED) navigator.clipboard?.writeText(link.href).catch(() => {});
    }
  }

  function update() {
    if (query && document.querySelector(".springtide-panel[data-state]") && send(ofLab(query))) query = "";
    completeLinks();
  }

  document.addEventListener("click", (event) => {
    const button = event.target instanceof Element && event.target.closest("button");
    if (button && button.textContent === "Copy link") pressed = performance.now();
  }, true);
  document.addEventListener("change", async (event) => {
    const field = event.target;
    if (!(field instanceof HTMLInputElement) || !("springtideLoad" in field.dataset) || !field.files.length) return;
    const file = field.files[0];
    // What is too long is sent as far as the lab reads, so that the lab says what is wrong with it.
    send((await file.slice(0, 4 * MAX_LENGTH).text()).slice(0, MAX_LENGTH) || " ");
    field.value = "";
  });
  new MutationObserver(update).observe(document.body, { childList: true, subtree: true });
  update();
})();
