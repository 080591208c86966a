// Corrects the address of the page before viser's client reads it.
//
// The client connects to a websocket at the page's address without its last slash. Below the path of a proxy this is not the
// lab's path, so there the page adds its file name. The client would also connect to, or play, the address that a link
// names in "websocket" or "playbackPath", and run the JavaScript from there. And if the page has a path, the client
// would write its websocket into the address bar.

(() => {
  "use strict";
  const NOT_FROM_LINKS = ["websocket", "playbackPath"];
  const replace = history.replaceState.bind(history);

  /** @param {string | URL} address */
  function own(address) {
    const found = new URL(address, location.href);
    for (const name of NOT_FROM_LINKS) if (found.searchParams.has(name)) found.searchParams.delete(name);
    if (found.pathname !== "/" && found.pathname.endsWith("/")) found.pathname += "index.html";
    return found.href;
  }

  history.replaceState = (state, title, address) => replace(state, title, address && own(address));
  history.replaceState(null, "", location.href);
})();
