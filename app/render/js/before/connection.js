// The connection to the lab, which viser's client holds in a worker.
//
// A page that is left lets go of the lab at once, so that the lab counts no browser that nobody sees. A browser may keep a
// page that was left, to show it again when the user goes back. It keeps the worker too, and the connection stays open though
// nothing reads it. Ending the worker closes the connection, also while the page is being frozen. A page that is shown again
// reloads.
//
// Without a connection viser's client has its worker try again each second, which ends the attempt under way. Chromium delays
// attempts by up to five seconds once many have failed, so that after a minute none would succeed: here each has its time.
// Messages that a newer viser adds pass unchanged.
//
// viser's client tries again only while its page has the focus. A page that is seen without it, on a projector or in a frame
// beside others, would stand still. Here a page that is visible counts as one with the focus.

(() => {
  "use strict";
  const PATIENCE = 6000; // [ms] for an attempt, which viser's client itself ends after five seconds
  /** @type {Worker[]} */
  const workers = [];
  window.Worker = class extends Worker {
    #began = -Infinity; // [ms] the attempt under way

    /** @param {ConstructorParameters<typeof Worker>} all */
    constructor(...all) {
      super(...all);
      workers.push(this);
      this.addEventListener("message", ({ data }) => {
        if (data?.type === "closed") this.#began = -Infinity;
      });
    }

    /** @param {any} message @param {any} [how] */
    postMessage(message, how) {
      const now = performance.now(), kind = message?.type;
      if (kind === "retry" && now < this.#began + PATIENCE) return;
      if (kind === "retry" || kind === "set_server") this.#began = now;
      super.postMessage(message, how);
    }
  };
  const isVisible = () => document.visibilityState === "visible";
  document.hasFocus = isVisible;
  document.addEventListener("visibilitychange", () => dispatchEvent(new Event(isVisible() ? "focus" : "blur")));
  addEventListener("pagehide", () => workers.forEach((worker) => worker.terminate()));
  addEventListener("pageshow", (event) => event.persisted && location.reload());
})();
