// Changes of the drawing where this browser shows the lab dark (display.js): colours of vertices, and labels (labels.js).

import { DARK_LIFT, LUMA } from "../shared.js";

export const isDark = () => document.documentElement.classList.contains("springtide-dark");

// The sRGB colour `name` on a dark floor, in GLSL: `lifted` in app/render/colormap.py.
export const glslLifted = (/** @type {string} */ name) =>
  `mix(${name}, vec3(1.0), ${DARK_LIFT.toFixed(3)} * (1.0 - dot(${name}, vec3(${LUMA.join(", ")}))))`;
