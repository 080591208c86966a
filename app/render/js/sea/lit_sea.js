// The light of a sea, found once for each pixel of the canvas.
//
// A graphics processor shades at least 2 x 2 pixels for each triangle, and also waves that nearer ones hide later. So the
// polar grid first writes the place of the sea in each pixel, tiles of the canvas compute the light of these places, and the
// grid is drawn again with these colours, with all samples of the canvas along its edges. This needs the table of the
// sky (sky_table.js), which shows that the browser can draw into floats; otherwise the grid itself is shaded.

import { keyWithDetails } from "../shading/quality.js";
import { disposeMaterials, dress, isLinked } from "../shading/shaders.js";
import { FLOAT, HALF_FLOAT, NEAREST, RGBA } from "../shading/three.js";
import { makeDome, makeGrid } from "./dome.js";
import { DOUBLED, POLAR } from "./polar_grid.js";
import { litBy, skyTables, TARGET_VERTEX, withSky } from "./sky_table.js";
import { POLAR_GLSL, TILE, TILE_GLSL, WATER_GLSL, WATER_LIGHT, WATER_PLACE, WATER_VERTEX, WIRE_GLSL } from "./water_shader.js";

export const PLACED = "#define PLACED\n"; // for WATER_VERTEX

// The vertices of the polar grid, computed once for both drawings. Even columns hold the place of a vertex, odd ones its place at
// rest.
const VERTICES_FRAGMENT = `
  ${POLAR_GLSL}
  void main() {
    vec2 rest, at = floor(gl_FragCoord.xy);
    vec3 place = placeOf(at.y, floor(0.5 * at.x), rest);
    gl_FragColor = vec4(mod(at.x, 2.0) < 0.5 ? place : vec3(rest, 0.0), 1.0);
  }`;
const PLACES_FRAGMENT = `
  ${WATER_PLACE}
  layout(location = 1) out highp vec4 restAndSteps;
  void main() {
    cutOut();
    vec3 at = seaPlace();
    gl_FragColor = vec4(at, distance(at, eye));
    restAndSteps = vec4(vRest, stepsAt(at));
  }`;
// Tiles of the view that hold sea, and those that hold anything else, with the pixels around them. A software renderer computes
// the light of a pixel that is hidden or discarded, too: tiles without sea, or without sky, are not drawn at all.
const TILES_FRAGMENT = `
  uniform highp sampler2D seaPlaces;
  void main() {
    ivec2 first = ${TILE} * ivec2(gl_FragCoord.xy) - 1, last = textureSize(seaPlaces, 0) - 1;
    float wet = 0.0;
    for (int y = 0; y < ${TILE + 2}; y++) for (int x = 0; x < ${TILE + 2}; x++) {
      wet += texelFetch(seaPlaces, clamp(first + ivec2(x, y), ivec2(0), last), 0).w > 0.0 ? 1.0 : 0.0;
    }
    gl_FragColor = vec4(wet > 0.0, wet < ${(TILE + 2) ** 2}.0, 0.0, 1.0);
  }`;
const LIGHT_VERTEX = `
  ${TILE_GLSL}
  void main() { gl_Position = tileCorner(0, 0.5); }`;
const LIGHT_FRAGMENT = `
  #define STANDARD
  uniform vec3 eye;
  uniform highp sampler2D seaPlaces, seaRest;
  ${WATER_LIGHT}
  void main() {
    vec4 at = texelFetch(seaPlaces, ivec2(gl_FragCoord.xy), 0), rest = texelFetch(seaRest, ivec2(gl_FragCoord.xy), 0);
    gl_FragColor = vec4(shadeSea(at.xyz, rest.xy, rest.zw), 1.0);
  }`;
// A pixel, those beside, below and above it, and the corners; their columns and rows as digits of base 4, counted from -1.
const AROUND = [[0, 0], [-1, 0], [0, -1], [1, 0], [0, 1], [1, -1], [-1, -1], [1, 1], [-1, 1]];
/** @param {number} axis */
const digitsOf = (axis) => AROUND.reduce((sum, offset, k) => sum + (offset[axis] + 1) * 4 ** k, 0);
// A pixel on the edge of a wave has the light of what its middle shows, which may be another wave or the sky: the edge
// takes the light of the neighbour that shows the same wave.
export const LIT_FRAGMENT = `
  ${WATER_PLACE}
  ${WATER_GLSL.noise}
  ${WATER_GLSL.waves}
  ${WIRE_GLSL}
  uniform highp sampler2D seaPlaces;
  uniform highp sampler2D seaLight;
  const float SAME_WAVE = 0.03; // difference between distances from the eye, over the distance
  void main() {
    cutOut();
    float far = distance(seaPlace(), eye), least = 1e9;
    ivec2 pixel = ivec2(gl_FragCoord.xy), last = textureSize(seaPlaces, 0) - 1, found = pixel;
    for (int k = 0; k < ${AROUND.length} && least > SAME_WAVE; k++) {
      ivec2 near = clamp(pixel + (ivec2(${digitsOf(0)}, ${digitsOf(1)}) >> 2 * k & 3) - 1, ivec2(0), last);
      float place = texelFetch(seaPlaces, near, 0).w, off = place == 0.0 ? 1e8 : abs(place / far - 1.0);
      if (off < least) { least = off; found = near; }
    }
    if (least > 1e7) discard;
    gl_FragColor = vec4(texelFetch(seaLight, found, 0).rgb, 1.0);
    #ifdef WIRE
      gl_FragColor.rgb = mix(gl_FragColor.rgb, wireColor, wireAt(vRest));
    #endif
    #include <tonemapping_fragment>
    #include <colorspace_fragment>
  }`;

// Resources of a lit sea: the grid with a second material, a triangle, tiles, and their render targets.
/** @param {Sea} sea @returns {LitSea} */
function makeLit(sea) {
  const grid = makeGrid(sea), [corners, triangle, light] = [makeDome(sea), makeDome(sea), makeDome(sea)];
  const targets = { vertices: null, places: null, counts: null, lights: null };
  for (const drawn of [corners, grid, triangle, light]) {
    drawn.removeFromParent();
    Object.assign(drawn.material, { fog: false, toneMapped: false, depthTest: drawn === grid });
  }
  return { corners, grid, triangle, light, tiles: null, ...targets, size: "" };
}

// Two triangles for each tile: its column, its row, and a number for each corner.
/** @param {Sea} sea @param {number} columns @param {number} rows */
function makeTiles(sea, columns, rows) {
  const count = columns * rows, numbers = new Float32Array(12 * count), index = new Uint32Array(6 * count);
  for (let k = 0; k < 4 * count; k++) {
    const tile = k >> 2;
    numbers.set([tile % columns, Math.floor(tile / columns), k & 3], 3 * k);
  }
  for (let tile = 0; tile < count; tile++) index.set([0, 1, 3, 0, 3, 2].map((corner) => 4 * tile + corner), 6 * tile);
  const tiles = new sea.geometry.constructor();
  tiles.setAttribute("position", new sea.geometry.attributes.position.constructor(numbers, 3));
  tiles.setIndex(new sea.geometry.index.constructor(index, 1));
  return tiles;
}

/** @param {LitSea} lit */
function disposeTargets(lit) {
  for (const one of [lit.tiles, lit.vertices, lit.places, lit.counts, lit.lights]) one?.dispose();
}

/** @param {Sea} sea */
export function disposeLit(sea) {
  const { lit } = sea;
  if (!lit) return;
  disposeTargets(lit);
  for (const { geometry } of [lit.corners, lit.triangle, lit.light]) geometry.dispose();
  for (const drawn of [lit.corners, lit.grid, lit.triangle, lit.light]) disposeMaterials(drawn);
  sea.lit = null;
}

/** @param {string} base @param {GriddedSea} sea @param {LitSea} lit @param {number} width @param {number} height */
function resizeLit(base, sea, lit, width, height) {
  const { uniforms } = sea, columns = Math.ceil(width / TILE), rows = Math.ceil(height / TILE);
  const { rings, spokes } = POLAR[sea.polar.userData.fineness ?? 0], size = [width, height, rings].join();
  if (lit.size === size) return;
  lit.size = size;
  disposeTargets(lit);
  const table = skyTables.get(base);
  if (!table) return;
  const Target = table.target.constructor, how = { format: RGBA, minFilter: NEAREST, magFilter: NEAREST };
  lit.vertices = new Target(2 * spokes, rings + DOUBLED, { ...how, type: FLOAT, depthBuffer: false });
  lit.places = new Target(width, height, { ...how, type: FLOAT, count: 2 });
  lit.counts = new Target(columns, rows, { ...how, depthBuffer: false });
  lit.lights = new Target(width, height, { ...how, type: HALF_FLOAT, depthBuffer: false });
  lit.tiles = lit.light.geometry = makeTiles(sea, columns, rows);
  uniforms.seaVertices.value = lit.vertices.texture;
  [uniforms.seaPlaces.value, uniforms.seaRest.value] = lit.places.textures;
  [uniforms.seaTiles.value, uniforms.seaLight.value] = [lit.counts.texture, lit.lights.texture];
}

// Compute the light of every pixel of the sea: false if this browser cannot, null while it compiles the programs.
/**
 * @param {string} base @param {GriddedSea} sea @param {three.Renderer} renderer
 * @param {three.Scene} scene @param {three.Camera} camera @param {Variant} shape @param {Variant} light
 */
export function lightSea(base, sea, renderer, scene, camera, shape, light) {
  const { uniforms } = sea;
  if (!uniforms.skyTable.value || sea.isUnlit) return false;
  const lit = (sea.lit ??= makeLit(sea)), before = renderer.getRenderTarget(), gl = renderer.getContext();
  resizeLit(base, sea, lit, before?.width ?? gl.drawingBufferWidth, before?.height ?? gl.drawingBufferHeight);
  Object.assign(lit.grid, { geometry: sea.polar.geometry, visible: sea.polar.visible });
  litBy(lit.light, scene);
  /** @type {[three.Target | null, three.Mesh, string, string, string][]} */
  const passes = [
    [lit.vertices, lit.corners, `${shape.key} vertices`, TARGET_VERTEX, shape.defines + VERTICES_FRAGMENT],
    [lit.places, lit.grid, `${shape.key} places`, PLACED + WATER_VERTEX, shape.defines + PLACES_FRAGMENT],
    [lit.counts, lit.triangle, "springtide-water tiles", TARGET_VERTEX, TILES_FRAGMENT],
    [lit.lights, lit.light, keyWithDetails(`${light.key} light`), LIGHT_VERTEX, withSky(light.defines + LIGHT_FRAGMENT, uniforms)],
  ];
  const alpha = renderer.getClearAlpha();
  let isWhole = true;
  renderer.setClearAlpha(0);
  for (const [target, drawn, key, vertexShader, fragmentShader] of passes) {
    renderer.setRenderTarget(target);
    const isDressed = dress(renderer, drawn, key, (shader) => {
      Object.assign(shader.uniforms, uniforms);
      Object.assign(shader, { vertexShader, fragmentShader });
    }, camera);
    isWhole &&= isDressed;
    if (!isDressed) continue;
    renderer.clear();
    renderer.render(drawn, camera);
  }
  renderer.setClearAlpha(alpha);
  renderer.setRenderTarget(before);
  if (!isWhole) return null;
  sea.isUnlit = !passes.every(([, drawn]) => isLinked(renderer, drawn.material));
  return !sea.isUnlit;
}
