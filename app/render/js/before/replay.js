// Keeps the sky and the lights of a replay as a round ends. viser's client would go back to its own until it has decoded those of
// the recording again, which takes seconds without a graphics card, and is seen as a flash with one.
//
// Of viser this file uses that its client is put into the head as one script, and the expression below. If a new viser differs,
// its rounds begin as it has them.

(() => {
  "use strict";
  const RESET = /[\w$]+\.useEnvironment\.set\([\w$]+\(\)\)/, { head } = document, append = head.appendChild.bind(head);
  head.appendChild = (node) => {
    if (node instanceof HTMLScriptElement && RESET.test(node.text)) {
      node.text = node.text.replace(RESET, "0");
      head.appendChild = append;
    }
    return append(node);
  };
})();
