// A replay: its scene, under the cover until the first picture is complete.

import { onChange, onLook } from "../core/watch.js";
import { awaitsPicture, showCover } from "../scene/cover.js";
import "../scene/main.js";

const update = () => showCover(null, !awaitsPicture("replay"));
onChange(update);
onLook(update);
