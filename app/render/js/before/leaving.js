// A page that the user leaves disconnects at once, so that the lab counts no hidden browser.
//
// A browser may cache such a page for the way back, with the worker that holds viser's connection, which then stays open
// though nothing reads it. Terminating the worker closes it, even while the page is being frozen. A page that is shown again
// reloads.

(() => {
  "use strict";
  /** @type {Worker[]} */
  const workers = [];
  window.Worker = class extends Worker {
    /** @param {ConstructorParameters<typeof Worker>} all */
    constructor(...all) {
      super(...all);
      workers.push(this);
    }
  };
  addEventListener("pagehide", () => workers.forEach((worker) => worker.terminate()));
  addEventListener("pageshow", (event) => event.persisted && location.reload());
})();
