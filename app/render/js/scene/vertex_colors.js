// A colour at each vertex, for any mesh with a child "<name>/vertex_colors", which carries the positions of its vertices
// and their sRGB colours in 0..1, packed (packed.js).

import { addOpenWater, OPEN_BASE, openPartOf } from "../sea/open_water.js";
import { addPlace, UNDERWATER_GLSL, underwaterOf } from "../sea/underwater.js";
import { glslLifted, isDark } from "../shading/dark.js";
import { applyPacked } from "../shading/packed.js";
import { keyWithDetails } from "../shading/quality.js";
import { insertAfter, replaceShader } from "../shading/shaders.js";
import { addAmbient, isRough, skyTerms } from "./ambient.js";

/** @type {NodeShader} */
export const vertexColors = {
  suffix: "/vertex_colors",
  update({ base, mesh, data }) {
    if (!applyPacked(mesh, data, "vertexColor", null)) return null;
    const dark = isDark(), underwater = underwaterOf(base, mesh), open = openPartOf(base, underwater);
    const isAmbient = skyTerms.value && isRough(mesh.material);
    const edit = (/** @type {three.Shader} */ shader) => {
      if (open) shader.fragmentShader = OPEN_BASE[open];
      insertAfter(shader, "vertexShader", "common", "attribute vec3 vertexColor; varying vec3 vVertexColor;");
      insertAfter(shader, "vertexShader", "begin_vertex", `
        vVertexColor = ${dark ? glslLifted("vertexColor") : "vertexColor"};
        vVertexColor = pow(max(vVertexColor, 0.0), vec3(2.2));`);
      insertAfter(shader, "fragmentShader", "common", "varying vec3 vVertexColor;");
      insertAfter(shader, "fragmentShader", "color_fragment",
                  `diffuseColor.rgb = ${underwater ? "seenUnderwater(vVertexColor)" : "vVertexColor"};`);
      if (open) addOpenWater(shader, open);
      else if (isAmbient) addAmbient(shader);
      if (!underwater) return;
      Object.assign(shader.uniforms, { underwater });
      insertAfter(shader, "fragmentShader", "common", UNDERWATER_GLSL);
      addPlace(shader);
    };
    const key = `springtide-vertex-colors-${dark ? "dark" : "light"}${underwater ? base : ""}${open}`;
    return replaceShader(mesh.material, isAmbient ? keyWithDetails(`${key}-ambient`) : key, edit) ? mesh.material : null;
  },
};
