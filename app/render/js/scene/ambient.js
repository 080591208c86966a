// The light of the sky on rough surfaces as a polynomial of second degree in the direction, instead of two lookups a
// pixel in the photograph of the sky: these are a quarter of the cost of a cloth. Spherical harmonics: R. Ramamoorthi,
// P. Hanrahan, "An efficient representation for irradiance environment maps", SIGGRAPH 2001.
//
// The photograph is read once, asynchronously: waiting would mean waiting for all earlier drawing. Without float targets, or if
// the program does not link, three's own lookups stay.

import { startedViewer } from "../core/viewer.js";
import { drawTable, makeTable, TARGET_VERTEX } from "../sea/sky_table.js";
import { contextNumber } from "../shading/context.js";
import { keyWithDetails, QUALITY, withDetails } from "../shading/quality.js";
import { insertAfter, replaceShader } from "../shading/shaders.js";
import { FLOAT, NEAREST, RGBA } from "../shading/three.js";

const AMBIENT = "springtide-ambient"; // key of viser's shader with this light
const ROUGH = 0.9; // roughness above which a reflection is as blurred as this light
const DIRECTIONS = 256, GOLDEN_ANGLE = Math.PI * (3 - Math.sqrt(5)); // evenly over all directions, along a spiral
const MEAN_SQUARES = [1, 1 / 3, 1 / 3, 1 / 3, 1 / 15, 1 / 15, 1 / 15, 4 / 15, 4 / 5]; // of the terms below
const SKY_SAMPLES_FRAGMENT = `
  #define STANDARD
  #include <common>
  #include <cube_uv_reflection_fragment>
  #include <envmap_common_pars_fragment>
  #include <envmap_physical_pars_fragment>
  void main() {
    float k = floor(gl_FragCoord.x), z = 1.0 - (2.0 * k + 1.0) / float(${DIRECTIONS}), a = float(${GOLDEN_ANGLE}) * k;
    vec3 d = vec3(sqrt(1.0 - z * z) * vec2(cos(a), sin(a)), z);
    gl_FragColor = vec4(textureCubeUV(envMap, envMapRotation * d, 1.0).rgb, 1.0);
  }`;
export const AMBIENT_GLSL = `
  uniform vec3 skyTerms[10];
  vec3 skyLight(vec3 normal) {
    vec3 d = inverseTransformDirection(normal, viewMatrix);
    vec3 light = skyTerms[0] + skyTerms[1] * d.x + skyTerms[2] * d.y + skyTerms[3] * d.z;
    #if DETAILS > 0
      light += skyTerms[4] * d.x * d.y + skyTerms[5] * d.y * d.z + skyTerms[6] * d.z * d.x +
               skyTerms[7] * (d.x * d.x - d.y * d.y) + skyTerms[8] * (3.0 * d.z * d.z - 1.0);
    #endif
    return max(light, skyTerms[9]); // the darkest
  }
  #define getIBLIrradiance(normal) (PI * envMapIntensity * skyLight(normal))
  #define getIBLRadiance(view, normal, roughness) (envMapIntensity * skyLight(normal))`;

// At the lowest quality nothing mirrors: suns and the first four terms of the sky light matt surfaces.
const MATT_GLSL = `
  #undef STANDARD
  #define LAMBERT
  #undef RE_Direct
  #undef RE_IndirectDiffuse
  #undef RE_IndirectSpecular
  #define RE_Direct(light, place, normal, view, coat, material, found) \\
    found.directDiffuse += saturate(dot(normal, light.direction)) * light.color * BRDF_Lambert(diffuseColor.rgb)
  #define RE_IndirectDiffuse(irradiance, place, normal, view, coat, material, found) \\
    found.indirectDiffuse += irradiance * BRDF_Lambert(diffuseColor.rgb)`;

/** @type {{ value: three.Vector3[] | null }} */
export const skyTerms = { value: null }; // the nine terms, and the least light of all directions
const LIKELY_SKY = [0.7, 0.75, 0.8]; // until the photograph is read
export let skiesRead = 0; // frames.js draws when it changes
let isReading = false; // true while the photograph is on its way from the graphics card
// True if the light of rough surfaces is not that of the visible sky yet.
export const awaitsLight = () => isReading;
/** @type {Float32Array | null} */
let photographed = null; // the light of the photograph in DIRECTIONS, red, green, blue and one more number each
let litAs = ""; // sky of the terms
/** @type {Table | null} */
let samples = null; // the table with which the photograph is read

/** @param {three.Shader} shader */
export function addAmbient(shader) {
  Object.assign(shader.uniforms, { skyTerms });
  insertAfter(shader, "fragmentShader", "envmap_physical_pars_fragment", AMBIENT_GLSL);
  shader.fragmentShader = withDetails(shader.fragmentShader);
  if (QUALITY.details() === 0) shader.fragmentShader = shader.fragmentShader.replace("#include <lights_physical_fragment>", MATT_GLSL);
}

// The terms of the polynomial in a direction.
/** @param {number} x @param {number} y @param {number} z */
function termsOf(x, y, z) {
  return [1, x, y, z, x * y, y * z, z * x, x * x - y * y, 3 * z * z - 1];
}

// Read the photograph if it is another one, or is turned.
/** @param {three.Renderer} renderer @param {three.Scene} scene @param {three.Mesh} mesh */
function readSky(renderer, scene, mesh) {
  const photograph = scene.environment, Target = photograph?.renderTarget?.constructor;
  if (!Target || !renderer.extensions.has("EXT_color_buffer_float")) return;
  const key = [contextNumber(), photograph.uuid, photograph.version, ...scene.environmentRotation.toArray()].join();
  if (samples?.key === key) return;
  const how = { type: FLOAT, format: RGBA, minFilter: NEAREST, magFilter: NEAREST, depthBuffer: false };
  const table = (samples ??= makeTable({ geometry: mesh.geometry, mesh }, new Target(DIRECTIONS, 1, how)));
  const isDrawn = drawTable(renderer, scene, table, key, "springtide-sky-samples", (shader) => {
    shader.vertexShader = TARGET_VERTEX;
    shader.fragmentShader = SKY_SAMPLES_FRAGMENT;
  });
  if (!isDrawn) return;
  skyTerms.value ??= [...MEAN_SQUARES, 0].map((_, i) => mesh.position.clone().fromArray(i === 0 ? LIKELY_SKY : [0, 0, 0]));
  const numbers = new Float32Array(4 * DIRECTIONS);
  /** @type {three.ReadTarget} */
  const asked = [table.target, 0, 0, DIRECTIONS, 1, numbers];
  const take = () => {
    if (table.key !== key) return;
    [photographed, litAs, isReading] = [numbers, "", false];
    skiesRead += 1;
    startedViewer().requestRender();
  };
  if (QUALITY.isWhole()) {
    renderer.readRenderTargetPixels(...asked);
    take();
  } else {
    isReading = true;
    renderer.readRenderTargetPixelsAsync(...asked).then(take, () => (isReading = false)); // it fails if the context is lost
  }
}

const CLEAR_OF_LAND = 0.5; // sine of the elevation above which land does not contribute to the photograph's light
const SEA_LIGHT = 0.3; // fraction of the sky's light that the sea returns

// The light in DIRECTIONS on bodies in a sea, from that of the photograph, which was taken on land: sky and sea replace the
// land, and under a grey sky the light is grey. uniforms: of the sea.
/** @param {Float32Array} numbers @param {three.Uniforms} uniforms */
export function overSea(numbers, { skyTint, clouds }) {
  /** @type {number[]} */
  const tint = skyTint.value.toArray();
  const cover = Math.min(Math.max(clouds.value.x, 0), 1), found = numbers.slice();
  const heights = Array.from({ length: DIRECTIONS }, (_, k) => {
    const z = 1 - (2 * k + 1) / DIRECTIONS;
    return Math.sqrt(1 - z * z) * Math.sin(GOLDEN_ANGLE * k); // three's y is up
  });
  const high = [...heights.keys()].filter((k) => heights[k] > CLEAR_OF_LAND);
  const mean = tint.map((share, i) => (share * high.reduce((sum, k) => sum + numbers[4 * k + i], 0)) / high.length);
  const grey = 0.3 * mean[0] + 0.5 * mean[1] + 0.2 * mean[2];
  for (const [k, height] of heights.entries()) {
    const even = Math.max(cover, 1 - Math.max(height, 0) / CLEAR_OF_LAND), level = 0.5 + 0.5 * height;
    for (let i = 0; i < 3; i++) {
      const sky = mean[i] + cover * (grey - mean[i]), light = sky * (level + SEA_LIGHT * (1 - level));
      found[4 * k + i] = tint[i] * numbers[4 * k + i] + even * (light - tint[i] * numbers[4 * k + i]);
    }
  }
  return found;
}

// Bring the terms up to date. uniforms: of the sea that is drawn, or null.
/** @param {three.Uniforms | null} uniforms */
function renewTerms(uniforms) {
  const now = uniforms ? [...uniforms.skyTint.value.toArray(), uniforms.clouds.value.x].join() : "land";
  if (!photographed || litAs === now) return;
  litAs = now;
  setTerms(uniforms ? overSea(photographed, uniforms) : photographed);
}

// The terms of a sky with these colours in DIRECTIONS, red, green, blue and one more number each.
/** @param {ArrayLike<number>} numbers */
export function setTerms(numbers) {
  const directions = Array.from({ length: DIRECTIONS }, (_, k) => {
    const z = 1 - (2 * k + 1) / DIRECTIONS, level = Math.sqrt(1 - z * z), a = GOLDEN_ANGLE * k;
    return termsOf(level * Math.cos(a), level * Math.sin(a), z);
  });
  const all = skyTerms.value ?? [], terms = all.slice(0, -1), least = all[terms.length], color = least.clone();
  for (const [i, term] of terms.entries()) {
    term.set(0, 0, 0);
    for (const [k, direction] of directions.entries()) {
      term.addScaledVector(color.fromArray(numbers, 4 * k), direction[i] / (DIRECTIONS * MEAN_SQUARES[i]));
    }
  }
  least.set(Infinity, Infinity, Infinity);
  for (const direction of directions) {
    color.set(0, 0, 0);
    for (const [i, term] of terms.entries()) color.addScaledVector(term, direction[i]);
    least.min(color);
  }
  least.max(color.set(0, 0, 0));
}

// True if a material has this light. At the lowest quality all have.
/** @param {three.Material} material */
export const isRough = ({ roughness }) => roughness >= ROUGH || QUALITY.details() === 0;

// Give viser's own meshes this light; those with our shaders request it themselves. uniforms: of the sea that is drawn, or null.
/** @param {three.Renderer} renderer @param {three.Scene} scene @param {three.Uniforms | null} uniforms */
export function lightMeshes(renderer, scene, uniforms) {
  /** @type {three.Material[]} */
  const lit = [];
  /** @type {three.Mesh[]} */
  const plain = []; // ordinary meshes, not instanced ones: their class makes the triangle
  scene.traverseVisible((object) => {
    if (!object.isMesh || object.layers.mask === 0) return;
    lit.push(...[object.material].flat().filter((one) => one.isMeshStandardMaterial && !one.isMeshPhysicalMaterial));
    const isPlain = Object.getPrototypeOf(object.constructor) === Object.getPrototypeOf(scene.constructor);
    if (isPlain && object.material.isMeshStandardMaterial) plain.push(object);
  });
  if (plain.length > 0) readSky(renderer, scene, plain[0]);
  renewTerms(uniforms);
  for (const one of skyTerms.value ? lit : []) {
    const { springtide } = one.userData;
    if (springtide && !springtide.startsWith(AMBIENT)) continue;
    if (isRough(one)) replaceShader(one, keyWithDetails(AMBIENT), addAmbient);
    else if (springtide) replaceShader(one, "", () => {});
  }
}
