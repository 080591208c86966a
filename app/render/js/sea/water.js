// The shader of water, for "<name>" where there is a "<name>/water_material".
//
// "<name>/water_surface" carries displacement, slope x, slope y and foam of each vertex, packed (packed.js), and
// "<name>/water_rest" the places of the vertices at rest; "<name>/water_lines" objects in the water. The vertices of
// "<name>/water_material" are the uniforms, in the order of WATER_UNIFORMS (app/render/material.py). "Sea" in a name means
// the frame of the node, z up; three's world is rotated against it. viser's own mesh is not drawn: its vertices fill
// textures, which the polar grid (polar_grid.js) and the fragment shader read.

import { contextNumber, drawsFloats } from "../shading/context.js";
import { applyPacked } from "../shading/packed.js";
import { keyWithDetails, QUALITY } from "../shading/quality.js";
import { disposeMaterials, dress, isLinked, meshOf, refused } from "../shading/shaders.js";
import { MAX_WATERLINES, WATER_UNIFORMS } from "../shared.js";
import { makeDome, makeGrid } from "./dome.js";
import { halvedTexture, writeHalfFloats } from "./half_floats.js";
import { disposeLit, lightSea, LIT_FRAGMENT, PLACED } from "./lit_sea.js";
import { aimPolar, finenessOf, setFineness } from "./polar_grid.js";
import { awaitsSky, drawSkyTable, wantSky, withSky } from "./sky_table.js";
import { DOME_FRAGMENT, DOME_VERTEX, PLAIN_FRAGMENT, WATER_FRAGMENT, WATER_VERTEX } from "./water_shader.js";

/** @type {Map<string, Sea>} */
export const seas = new Map(); // name of the node -> resources of its sea
// Name of the node -> its uniforms, kept permanently because viser may reuse a material for a new geometry.
/** @type {Map<string, three.Uniforms>} */
export const uniformsByName = new Map();

// The sky colours of the present sea, which can replace a photograph, or null.
/** @returns {SkyColors | null} */
export function seaSky() {
  const [sea] = seas.values();
  return sea ? { low: sea.uniforms.skyLow.value.toArray(), high: sea.uniforms.skyHigh.value.toArray() } : null;
}

// The uniforms of the drawn sea, or null: its sky lights the objects in it.
export const drawnSea = () => [...seas.values()].find(({ isReady }) => isReady)?.uniforms ?? null;

// Uniforms of three numbers each. three's classes are not in scope, therefore vectors are copied from the mesh.
/** @param {three.Mesh} mesh @param {string[]} names @returns {three.Uniforms} */
export function makeUniforms(mesh, names) {
  return Object.fromEntries(names.map((name) => [name, { value: mesh.position.clone() }]));
}

// Read uniforms from the vertices of a hidden mesh.
/** @param {three.Uniforms} uniforms @param {string[]} names @param {three.Mesh} data */
export function readUniforms(uniforms, names, data) {
  const numbers = data.geometry.attributes.position.array;
  names.forEach((name, k) => uniforms[name].value.fromArray(numbers, 3 * k));
}

/** @param {string} base @param {three.Mesh} mesh */
function uniformsOf(base, mesh) {
  let uniforms = uniformsByName.get(base);
  if (!uniforms) {
    uniforms = makeUniforms(mesh, WATER_UNIFORMS);
    uniforms.standIn = { value: [0.45, 0.55, 0.68] };
    for (const name of ["toSea", "fromSea"]) uniforms[name] = { value: mesh.matrixWorld.clone() };
    const textures = ["wavePlaces", "waveSlopes", "skyTable", "seaVertices", "seaPlaces", "seaRest", "seaTiles", "seaLight"];
    for (const name of textures) uniforms[name] = { value: null };
    uniforms.eye = { value: [0, 0, 0] };
    for (const name of ["polarPlace", "polarSteps"]) uniforms[name] = { value: [0, 0, 0, 0] };
    for (const name of ["polarTurn", "farDepth"]) uniforms[name] = { value: 0 };
    uniforms.waterlines = { value: new Float32Array(12 * MAX_WATERLINES) };
    uniformsByName.set(base, uniforms);
  }
  return uniforms;
}

/** @param {three.Mesh} mesh @param {three.Uniforms} uniforms @returns {Sea} */
function makeSea(mesh, uniforms) {
  // widest, highest: greatest displacement [m] along the level and upwards; cell: of the simulated grid [m]
  const made = { polar: null, plain: null, lit: null, dome: null, triangle: null, isReady: false, isUnlit: false }, size = { widest: 0, highest: 0, cell: 1 };
  return { mesh, geometry: mesh.geometry, uniforms, filled: "", hasOil: false, hasHulls: false, ...made, ...size };
}

/** @typedef {{ isTexture: boolean, version: number, size: string }} FilledTexture */

// Fill a texture with width x height x 4 half-precision numbers (half_floats.js), and its smaller copies with their means where
// it repeats both ways. three binds it but does not fill it: its own class is not in scope, and it takes any object with
// this version for one whose data needs no upload.
/**
 * @param {three.Renderer} renderer @param {FilledTexture | null} texture @param {number} width @param {number} height
 * @param {Uint16Array} halves @param {boolean} repeats
 */
function filledTexture(renderer, texture, width, height, halves, repeats) {
  const gl = renderer.getContext(), size = [width, height, repeats].join();
  texture ??= { isTexture: true, version: 0, size: "" };
  const kept = renderer.properties.get(texture), isNew = texture.size !== size || !kept.__webglTexture;
  if (isNew) {
    gl.deleteTexture(kept.__webglTexture ?? null); // its size is immutable
    kept.__webglTexture = gl.createTexture();
    texture.size = size;
  }
  renderer.state.activeTexture(gl.TEXTURE0);
  renderer.state.bindTexture(gl.TEXTURE_2D, kept.__webglTexture);
  if (isNew) {
    gl.texStorage2D(gl.TEXTURE_2D, repeats ? 1 + Math.floor(Math.log2(Math.max(width, height))) : 1, gl.RGBA16F, width, height);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, repeats ? gl.LINEAR_MIPMAP_LINEAR : gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, repeats ? gl.REPEAT : gl.CLAMP_TO_EDGE);
  }
  /** @type {[flag: number, value: number | boolean][]} */
  const flags = [[gl.UNPACK_FLIP_Y_WEBGL, false], [gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false], [gl.UNPACK_ALIGNMENT, 4]];
  const before = flags.map(([flag]) => [flag, gl.getParameter(flag)]);
  for (const [flag, value] of flags) gl.pixelStorei(flag, value);
  gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, width, height, gl.RGBA, gl.HALF_FLOAT, halves);
  if (repeats && drawsFloats(renderer)) gl.generateMipmap(gl.TEXTURE_2D);
  else if (repeats) {
    for (let level = 1, one = { halves, width, height }; one.width > 1 || one.height > 1; level++) {
      one = halvedTexture(one.halves, one.width, one.height);
      gl.texSubImage2D(gl.TEXTURE_2D, level, 0, 0, one.width, one.height, gl.RGBA, gl.HALF_FLOAT, one.halves);
    }
  }
  for (const [flag, value] of before) gl.pixelStorei(flag, value);
  return texture;
}

// Update the textures of the waves that the shader reads (WATER_GLSL.waves), if they have changed. The vertices of a tile are
// rows and columns, closed by the last ones; those of rings are the rings in order, then the middle.
/** @param {Sea} sea @param {three.Renderer} renderer @param {Float32Array} rest */
function fillWaves(sea, renderer, rest) {
  const { position, slopeAndFoam } = sea.geometry.attributes;
  const { grid, ringLaw, gridMiddle, wavePlaces, waveSlopes } = sea.uniforms;
  const [rows, columns, length] = grid.value.toArray(), isRings = ringLaw.value.y > 0;
  const filled = `${contextNumber()} ${slopeAndFoam.version}`;
  if (sea.filled === filled) return;
  sea.filled = filled;
  const [height, width] = isRings ? [rows, columns] : [rows - 1, columns - 1], middle = gridMiddle.value.toArray();
  /** @type {(i: number, j: number) => number} */
  const vertexAt = isRings ? (i, j) => (i === 0 ? rest.length / 3 - 1 : (i - 1) * width + j) : (i, j) => i * columns + j;
  const [places, slopes] = [new Uint16Array(4 * width * height), new Uint16Array(4 * width * height)];
  let [widest, highest] = [0, 0];
  for (let i = 0, to = 0; i < height; i++) {
    for (let j = 0; j < width; j++, to += 4) {
      const from = 3 * vertexAt(i, j);
      const x = position.array[from] - rest[from] - middle[0], y = position.array[from + 1] - rest[from + 1] - middle[1];
      const z = position.array[from + 2] - rest[from + 2];
      const a = slopeAndFoam.array[from], b = slopeAndFoam.array[from + 1], foam = slopeAndFoam.array[from + 2];
      writeHalfFloats(places, to, x, y, z, 0);
      writeHalfFloats(slopes, to, a, b, foam, a * a + b * b);
      widest = Math.max(widest, Math.abs(x), Math.abs(y));
      highest = Math.max(highest, Math.abs(z));
    }
  }
  // Pieces of a tile that are blended with the same variance may be higher than any of them.
  [sea.widest, sea.highest] = [1.5 * widest, (isRings ? 1 : 1.5) * highest];
  sea.cell = isRings ? ringLaw.value.y : length / (rows - 1);
  for (const [one, halves] of /** @type {const} */ ([[wavePlaces, places], [waveSlopes, slopes]])) {
    one.value = filledTexture(renderer, one.value, width, height, halves, !isRings);
  }
}

/** @param {ShadedNode} node */
function readMaterial({ base, mesh, data }) {
  const uniforms = uniformsOf(base, mesh);
  readUniforms(uniforms, WATER_UNIFORMS, data);
  uniforms.fromSea.value.copy(mesh.matrixWorld);
  uniforms.toSea.value.copy(mesh.matrixWorld).invert();
}

/** @param {Sea} sea */
function disposeSea(sea) {
  disposeLit(sea);
  for (const drawn of [sea.polar, sea.plain, sea.dome]) {
    if (!drawn) continue;
    drawn.removeFromParent();
    disposeMaterials(drawn);
  }
  sea.polar?.geometry.dispose();
  sea.triangle?.dispose();
  sea.polar = sea.plain = sea.dome = sea.triangle = null;
}

// Give plain water its program: it is drawn while the browser compiles those of the sea. True if it has one.
/**
 * @param {Sea} sea @param {three.Renderer} renderer @param {three.Camera} camera @param {three.Scene} scene
 * @param {Variant} shape
 */
function dressPlain(sea, renderer, camera, scene, shape) {
  sea.plain ??= makeGrid(sea);
  return dress(renderer, sea.plain, `${shape.key} plain`, (shader) => {
    Object.assign(shader.uniforms, sea.uniforms);
    shader.vertexShader = shape.defines + WATER_VERTEX;
    shader.fragmentShader = shape.defines + PLAIN_FRAGMENT;
  }, camera, scene);
}

const IN_TILES = " in tiles"; // in the name of a shader of the sky

// Give a sea and its sky their programs. True if they have them.
/**
 * @param {string} base @param {GriddedSea} sea @param {Pick<ShadedContext, "renderer" | "camera" | "scene">} context
 * @param {{ shape: Variant, light: Variant, whole: Variant }} variants
 */
function dressSea(base, sea, { renderer, camera, scene }, { shape, light, whole }) {
  const hasTable = drawSkyTable(base, sea, renderer, scene);
  const isLit = lightSea(base, sea, renderer, scene, camera, shape, light);
  const key = isLit === false ? keyWithDetails(whole.key) : `${shape.key} lit`;
  const hasSurface = dress(renderer, sea.polar, key, (shader) => {
    Object.assign(shader.uniforms, sea.uniforms);
    shader.vertexShader = (isLit === false ? shape.defines : PLACED) + WATER_VERTEX;
    shader.fragmentShader = isLit === false ? withSky(whole.defines + WATER_FRAGMENT, sea.uniforms) : shape.defines + LIT_FRAGMENT;
  }, camera, scene);
  if (sea.uniforms.shown.value.x > 0 && !sea.dome) {
    sea.dome = makeDome(sea);
    sea.triangle = sea.dome.geometry;
  }
  if (!sea.dome) return hasTable && isLit !== null && hasSurface;
  const inTiles = isLit === false ? "" : IN_TILES;
  const hasDome = dress(renderer, sea.dome, keyWithDetails(`springtide-dome${inTiles}`), (shader) => {
    Object.assign(shader.uniforms, sea.uniforms);
    shader.vertexShader = isLit === false ? DOME_VERTEX : `#define TILES\n${DOME_VERTEX}`;
    shader.fragmentShader = withSky(DOME_FRAGMENT, sea.uniforms);
  }, camera, scene);
  // It keeps its shader until the new one is compiled.
  const drawn = sea.dome.material.userData.springtide?.includes(IN_TILES) ? sea.lit?.tiles : sea.triangle;
  if (drawn) sea.dome.geometry = drawn;
  return hasTable && isLit !== null && hasSurface && hasDome;
}

// Until a sea's programs are compiled, and while its mesh is remade, the photograph behind it would show its land. The page's own
// sky is shown there instead. Without the shader the photograph is the sky.
/** @param {three.Scene} scene @param {boolean} shown */
function showPhotograph(scene, shown) {
  if (!shown && scene.background) [scene.userData.photograph, scene.background] = [scene.background, null];
  if (shown && !scene.background) scene.background = scene.userData.photograph || null;
}

// Of the page: background of the cover, and of a sea without a sky; and the colour of words on it (cover.css, page.css).
const SKY = "--springtide-sky", INK = "--springtide-ink", DARK_INK = "#1b2a3a", LIGHT_INK = "#eef3f8";
const DARK_SKY = 0.18; // light of a sky below which words on it are light
const OVERCAST = 0.5; // light of a grey sky over that of a clear one
const UNTONED = 0.8; // light over that of a colour of the page

/** @param {number[]} color linear */
const lightness = ([r, g, b]) => 0.3 * r + 0.5 * g + 0.2 * b;

// Until the sky is ready, its mean colour is shown: that of the haze, which the server sets for each sky, grey under clouds.
/** @param {Sea} sea @param {three.Scene} scene */
function standIn({ uniforms }, scene) {
  if (!scene.fog) return;
  const { r, g, b } = scene.fog.color, cover = Math.min(Math.max(uniforms.clouds.value.x, 0), 1);
  const grey = OVERCAST * lightness([r, g, b]), mixed = [r, g, b].map((light) => light + cover * (grey - light));
  uniforms.standIn.value = mixed.map((light) => UNTONED * light);
  const { style } = document.documentElement, color = scene.fog.color.clone().fromArray(mixed).getStyle();
  if (style.getPropertyValue(SKY) === color) return;
  style.setProperty(SKY, color);
  style.setProperty(INK, lightness(mixed) < DARK_SKY ? LIGHT_INK : DARK_INK);
}

/** @type {NodeShader & Required<Pick<NodeShader, "unpack">>} */
export const water = {
  suffix: "/water_material",
  removeUnused() {
    for (const [base, sea] of seas) {
      if (meshOf(base)) continue;
      disposeSea(sea);
      seas.delete(base);
    }
    if (!seas.size) for (const name of [SKY, INK]) document.documentElement.style.removeProperty(name);
  },
  unpack({ base, mesh, data }) {
    readMaterial({ base, mesh, data });
    const surface = meshOf(`${base}/water_surface`), rest = meshOf(`${base}/water_rest`);
    if (!surface || !rest) return false;
    return applyPacked(mesh, surface, "slopeAndFoam", rest.geometry.attributes.position.array);
  },
  update({ base, mesh, data, renderer, scene, camera }) {
    if (refused.has(mesh.material)) {
      const earlier = seas.get(base);
      if (earlier) disposeSea(earlier);
      mesh.layers.mask = 1;
      Reflect.deleteProperty(mesh.geometry, "computeVertexNormals"); // restores that of its class
      showPhotograph(scene, true);
      return null;
    }
    showPhotograph(scene, false);
    const surface = meshOf(`${base}/water_surface`), rest = meshOf(`${base}/water_rest`);
    if (!surface || !rest) return null;
    let sea = seas.get(base);
    if (!sea || sea.mesh !== mesh || sea.geometry !== mesh.geometry) {
      if (sea) disposeSea(sea);
      seas.set(base, (sea = makeSea(mesh, uniformsOf(base, mesh))));
      mesh.geometry.computeVertexNormals = () => {}; // the slopes replace them: viser need not compute them each frame
    }
    wantSky();
    mesh.layers.mask = 0; // the polar grid is drawn in its place
    if (!this.unpack({ base, mesh, data })) return null;
    standIn(sea, scene);
    fillWaves(sea, renderer, rest.geometry.attributes.position.array);
    const lines = meshOf(`${base}/water_lines`);
    if (lines) sea.uniforms.waterlines.value = lines.geometry.attributes.position.array;
    const { shown, ringLaw, cutout, slick, waterlines } = sea.uniforms, [drawSky, wireframe] = shown.value.toArray();
    // Compiling takes seconds: a sea keeps the programs for oil and hulls after these are removed.
    sea.hasOil ||= slick.value.z > 0;
    sea.hasHulls ||= waterlines.value[6] > 0; // the corner of the first one
    const parts = { RINGS: ringLaw.value.y, CUTOUT: cutout.value.z, WIRE: wireframe, OIL: sea.hasOil, HULLS: sea.hasHulls };
    /** @param {(keyof typeof parts)[]} names @returns {Variant} */
    const variantOf = (...names) => {
      const defined = names.filter((name) => parts[name] > 0);
      const defines = defined.map((name) => `#define ${name}\n`).join("");
      return { key: [`springtide-water${base}`, ...defined].join(" "), defines };
    };
    const shape = variantOf("RINGS", "CUTOUT", "WIRE"), light = variantOf("RINGS", "OIL", "HULLS");
    const whole = variantOf("RINGS", "CUTOUT", "WIRE", "OIL", "HULLS");
    // viser asks three for a reversed depth buffer; a browser without clip control has none.
    sea.uniforms.farDepth.value = renderer.state.buffers.depth.getReversed() ? 0 : 1;
    const fineness = finenessOf(renderer.getContext(), QUALITY.details());
    const polar = (sea.polar ??= makeGrid(sea)), gridded = /** @type {GriddedSea} */ (sea);
    if (polar.userData.fineness !== fineness) setFineness(gridded, fineness);
    aimPolar(gridded, camera);
    const isInView = polar.visible;
    // If only one program is compiled in a frame, that of plain water comes first.
    const hasPlain = sea.isReady || dressPlain(sea, renderer, camera, scene, shape);
    sea.isReady = !awaitsSky(scene) && dressSea(base, gridded, { renderer, camera, scene }, { shape, light, whole });
    if (sea.isReady && isLinked(renderer, polar.material) === false) {
      refused.add(mesh.material);
      return this.update({ base, mesh, data, renderer, scene, camera });
    }
    polar.visible = isInView && sea.isReady;
    const showsPlain = isInView && hasPlain && !sea.isReady;
    if (sea.plain) Object.assign(sea.plain, { geometry: polar.geometry, visible: showsPlain });
    if (sea.dome) sea.dome.visible = drawSky > 0 && sea.isReady;
    // The server may add meshes for browsers without this shader (Water._draw_plain); here they are hidden.
    for (const part of ["foam", "wire", "sea", "slick"]) {
      const plain = meshOf(`${base}/plain_${part}`);
      if (plain) plain.visible = false;
    }
    return sea.isReady ? polar.material : null;
  },
};
