// A lab that is shown beside others: its page is a frame of the page with the panes (beside.html).
//
// A page that stands alone goes there as soon as the lab says that it has others beside it. In a frame the panel is hidden
// until it is asked for, and the picture takes the whole frame, so that all frames show the same part at the same scale.

(() => {
  "use strict";
  const framed = (() => {
    try {
      return window.parent !== window && window.parent.springtideBeside === true;
    } catch {
      return false; // a page of another address shows this one
    }
  })();
  if (framed) {
    document.documentElement.classList.add("springtide-framed", "springtide-bare");
    // viser connects again only while its page has the focus, which one frame has at most: all have it with their page.
    const hasFocus = () => window.parent.document.hasFocus();
    let had = hasFocus();
    document.hasFocus = hasFocus;
    setInterval(() => {
      if (hasFocus() !== had) dispatchEvent(new Event((had = !had) ? "focus" : "blur"));
    }, 1000); // [ms]
  }

  function update() {
    if (!framed && document.querySelector('[data-springtide-beside]:not([data-springtide-beside="[]"])')) {
      location.replace(new URL(`beside${location.search}`, location.href));
    }
  }

  new MutationObserver(update).observe(document.body, { childList: true, subtree: true });
  update();
})();
