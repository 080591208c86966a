// What the page says for itself, before viser's own client runs and after the server has ended.
//
// The cover is there from the first bytes of the page. It goes when the panel is drawn; while a scene is compiled it shows
// what the panel says of that (an element of class "springtide-progress"). It comes back when the server does not answer.

(() => {
  "use strict";
  const ALIVE_INTERVAL = 2000; // [ms] between two questions whether the server is still there
  const cover = document.getElementById("springtide-cover");
  const words = document.getElementById("springtide-cover-words");
  // A path is that of a proxy, such as a JupyterHub, or of a pane of several.
  const path = location.pathname.replace(/(pane\/\d+\/)?(index\.html)?$/, "");
  const restart = path === "/" ? "Start it again with the command: springtide" : "Reload this page to start it again.";
  let lost = false;

  function hasWebGL() {
    try {
      return Boolean(document.createElement("canvas").getContext("webgl2"));
    } catch {
      return false;
    }
  }

  function say(text, hidden) {
    if (text !== null && words.textContent !== text) words.textContent = text;
    cover.classList.toggle("springtide-hidden", hidden);
  }

  let waiting = "Connecting to the lab …"; // while there is no panel
  function update() {
    if (lost) return say(`The lab has stopped. ${restart}`, false);
    const progress = document.querySelector(".springtide-progress");
    if (progress) {
      waiting = progress.textContent;
      return say(waiting, false);
    }
    if (document.querySelector(".springtide-panel")) {
      waiting = "Opening the scene …"; // the page is connected from now on
      return say(null, true);
    }
    return say(waiting, false);
  }

  async function ask() {
    let answered = false;
    try {
      answered = (await fetch("springtide-alive", { cache: "no-store" })).ok;
    } catch {
      answered = false;
    }
    if (answered && lost) return void location.reload();
    lost = !answered;
    update();
  }

  if (!hasWebGL()) {
    const notice = document.createElement("div");
    notice.id = "springtide-notice";
    notice.textContent =
      "This browser has no WebGL 2, so the picture cannot be drawn. The panel works. " +
      "Switch hardware acceleration on, or try another browser.";
    document.body.append(notice);
  }
  new MutationObserver(update).observe(document.body, { childList: true, subtree: true, characterData: true });
  setInterval(() => document.visibilityState === "visible" && ask(), ALIVE_INTERVAL);
  update();
})();
