// Two changes of viser's client in the page of a replay. The recording stands at its start until its first picture is whole,
// which is when the cover goes. And the sky and the lights stay as a round ends: viser's client would go back to its own until
// it has decoded those of the recording again, which takes seconds without a graphics card, and is seen as a flash with one.
//
// Of viser this file uses that its client is put into the head as one script, and the expressions below. If a new viser differs,
// its recordings begin and its rounds end as it has them.

(() => {
  "use strict";
  const COVER = '"#springtide-cover:not(.springtide-hidden)"';
  /** @type {[pattern: RegExp, text: string][]} */
  const CHANGES = [
    [/\bcurrentTime\+=\(/, `currentTime+=document.querySelector(${COVER})?0:(`],
    [/[\w$]+\.useEnvironment\.set\([\w$]+\(\)\)/, "0"],
  ];
  const { head } = document, append = head.appendChild.bind(head);
  head.appendChild = (node) => {
    if (node instanceof HTMLScriptElement && CHANGES.some(([pattern]) => pattern.test(node.text))) {
      for (const [pattern, text] of CHANGES) node.text = node.text.replace(pattern, () => text);
      head.appendChild = append;
    }
    return append(node);
  };
})();
