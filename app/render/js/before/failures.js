// The message on the cover if the page cannot start: one sentence with advice. Written for old browsers too.

(function () {
  "use strict";
  var OLDEST = "Chrome or Edge 120, Firefox 121, Safari 17.4"; // as in docs/platforms.md
  var PATIENCE = 8000; // [ms] after which a page without a panel shows the error
  var springtide = (window.__springtide = window.__springtide || {});
  var began = Date.now(), error = "";

  function say() {
    var words = document.getElementById("springtide-cover-words");
    if (words && springtide.failure) words.textContent = springtide.failure;
  }

  /** @param {string} text */
  function fail(text) {
    springtide.failure = springtide.failure || text;
    document.documentElement.setAttribute("data-springtide-failed", "");
    say();
  }

  function hasWebGL() {
    try {
      var gl = document.createElement("canvas").getContext("webgl2");
      var release = gl && gl.getExtension("WEBGL_lose_context");
      if (release) release.loseContext(); // browsers allow few contexts
      return Boolean(gl);
    } catch (refused) {
      return false;
    }
  }

  function isOld() {
    var has = window.CSS && CSS.supports && CSS.supports("selector(:has(a))");
    var script = window.HTMLScriptElement;
    var maps = script && script.supports && script.supports("importmap");
    return !has || !maps || !Element.prototype.checkVisibility || !("ariaPressed" in Element.prototype);
  }

  // viser's client fails if the browser names an unknown language, as with LANG=C.
  function mendLanguage() {
    try {
      new Intl.NumberFormat(navigator.language);
    } catch (refused) {
      Object.defineProperty(navigator, "language", { value: "en-US" });
      Object.defineProperty(navigator, "languages", { value: ["en-US"] });
    }
  }

  /** @param {Event & { error?: Error, reason?: Error, message?: string }} event */
  function note(event) {
    var reason = event.error || event.reason;
    error = error || String((reason && reason.message) || event.message || "");
  }
  addEventListener("error", note);
  addEventListener("unhandledrejection", note);

  mendLanguage();
  if (isOld()) fail("This browser is too old for the lab. The oldest supported versions are " + OLDEST + ".");
  else if (!hasWebGL()) {
    fail("This browser cannot draw the scenes: WebGL 2 is missing or switched off. Switch on hardware acceleration in its " +
         "settings and reload this page, or use another browser.");
  }
  addEventListener("DOMContentLoaded", say);
  var timer = setInterval(function () {
    if (document.querySelector(".springtide-panel")) {
      clearInterval(timer); // it has started
      removeEventListener("error", note);
      removeEventListener("unhandledrejection", note);
    } else if (Date.now() > began + PATIENCE && error) {
      fail("The page could not start: " + error.replace(/\.?$/, ". ") + "Load it again, or use another browser; the oldest that " +
           "work are " + OLDEST + ".");
    }
  }, 500);
})();
