// A veil over the old picture after a change of preset, until the picture of the new run is complete: the panel shows the new
// values at once, while the lab may still compile and the browser may still draw.
//
// `data-springtide-veil` of the document greys the picture (page.css).

import { topicState } from "../core/channel.js";
import { springtide } from "../core/springtide.js";
import { onChange, onLook } from "../core/watch.js";
import { Waiting } from "./waiting.js";

const root = document.documentElement;
const waiting = new Waiting();
const words = document.createElement("div");
words.id = "springtide-veil";
words.setAttribute("role", "status");
document.body.append(words);

function look() {
  const { awaited } = topicState("acts") ?? {}, { scene } = topicState("picture") ?? {};
  const { placed = "" } = document.querySelector(".springtide-panel[data-placed]")?.dataset ?? {};
  const { showsWhole, awaitPicture } = springtide;
  const isVeiled = waiting.look(performance.now(), { panel: String(scene), awaited: String(awaited ?? ""), placed }, () => showsWhole?.() ?? true, () => awaitPicture?.());
  if (isVeiled === "springtideVeil" in root.dataset) return;
  if (isVeiled) root.dataset.springtideVeil = "";
  else delete root.dataset.springtideVeil;
  words.textContent = isVeiled ? "Preparing the picture of these settings …" : "";
}

onChange(look);
onLook(look);
