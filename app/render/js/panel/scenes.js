// The pictures of the scenes: a press on one chooses it in the panel's list of scenes.

import { page } from "../core/life.js";
import { send } from "../core/viewer.js";

page.listen(document, "click", ({ target }) => {
  const button = target instanceof Element ? target.closest("[data-springtide-scene]") : null;
  const { springtideChooser } = button?.closest("[data-springtide-chooser]")?.dataset ?? {};
  if (button) send(springtideChooser, button.dataset.springtideScene);
});
