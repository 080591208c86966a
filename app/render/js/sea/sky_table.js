// The photograph of the sky as a table by azimuth, elevation and blur, which the shaders of water, sky and rain look up.
// It is redrawn when the photograph or a uniform that it depends on changes. A browser that cannot draw into half floats, or
// does not link the table's program, has no table: each pixel then reads the photograph itself, or its substitute
// (scene/photograph.js).

import { startedViewer } from "../core/viewer.js";
import { contextNumber } from "../shading/context.js";
import { withDetails } from "../shading/quality.js";
import { dress, isLinked, refused } from "../shading/shaders.js";
import { CLAMP, HALF_FLOAT, LINEAR, REPEAT, RGBA } from "../shading/three.js";
import { makeDome } from "./dome.js";
import { SKY_BLUR, SKY_COLUMNS, SKY_ROWS, SKY_TABLE, WATER_GLSL } from "./water_shader.js";

const SKY_UNIFORMS = ["skyline", "skyFold", "skyTint", "sunDirection"]; // its arguments
// Of a triangle that covers its target.
export const TARGET_VERTEX = "void main() { gl_Position = vec4(position.xy, 0.5, 1.0); }";
const SKY_TABLE_FRAGMENT = `
  ${SKY_TABLE.replace("#define SKY_TABLE", "")}
  #define STANDARD
  #define DETAILS 0
  ${WATER_GLSL.noise}
  ${WATER_GLSL.sky}
  void main() {
    int row = int(gl_FragCoord.y), block = row / SKY_ROWS;
    float a = 6.2831853 * gl_FragCoord.x / float(${SKY_COLUMNS}), up = float(row - block * SKY_ROWS) / float(SKY_ROWS - 1);
    float e = 1.5707963 * up * up;
    // Each row is made of two looks at the sky, where those without a table (WATER_GLSL.sky) are, so that all pixels do the
    // same: a software renderer does for each pixel what any row needs.
    vec3 d = vec3(cos(e) * vec2(cos(a), sin(a)), sin(e)), ways[2] = vec3[](d, d);
    vec2 blurs = block < SKY_BLURS ? vec2(SKY_BLUR[min(block, SKY_BLURS - 1)]) : vec2(0.08, 0.33);
    if (row == SKY_HEIGHT - 3) ways = vec3[](levelOf(d), levelOf(d));
    if (row == SKY_HEIGHT - 2) ways = vec3[](levelOf(sunDirection), levelOf(-sunDirection));
    if (row >= SKY_HEIGHT - 3) blurs = vec2(skyFold.y);
    if (row == SKY_HEIGHT - 1) { ways = vec3[](vec3(0.0, 0.0, 1.0), vec3(0.0, 0.0, 1.0)); blurs = vec2(1.0); }
    vec3 seen[2];
    for (int k = 0; k < 2; k++) seen[k] = sky(ways[k], blurs[k]);
    vec3 c = block == SKY_BLURS ? withEvenHue(seen[0], seen[1]) : 0.5 * (seen[0] + seen[1]);
    gl_FragColor = vec4(c, 1.0);
  }`;

const SKY_PATIENCE = 3000; // [ms] for a sea to wait for its photograph
let skyWanted = Infinity; // [ms] when it began to

// True if a sea still waits for the photograph of the sky: without it, other programs would be compiled, for seconds.
/** @param {three.Scene} scene */
export function awaitsSky(scene) {
  return !scene.environment && performance.now() < skyWanted + SKY_PATIENCE;
}

export function wantSky() {
  if (skyWanted < Infinity) return;
  skyWanted = performance.now();
  setTimeout(() => startedViewer().requestRender(), SKY_PATIENCE);
}

/** @type {Map<string, Table>} */
export const skyTables = new Map(); // name of the node -> { target, dome, key }, kept permanently like its uniforms
export let skiesDrawn = 0; // tests read it

// Give the materials of an object outside the scene its photograph of the sky.
/** @param {three.Mesh} object @param {three.Scene} scene */
export function litBy(object, { environment, environmentIntensity, environmentRotation }) {
  for (const material of object.userData.materials?.values() ?? [object.material]) {
    Object.assign(material, { envMap: environment, envMapIntensity: environmentIntensity });
    material.envMapRotation.copy(environmentRotation);
  }
}

// A triangle that covers a target, and the target.
/** @param {Beside} sea @param {three.Target} target */
export function makeTable(sea, target) {
  const dome = makeDome(sea);
  dome.removeFromParent();
  dome.material.fog = dome.material.toneMapped = dome.material.depthTest = false;
  return { target, dome, key: "" };
}

// Draw a table with the shader that `edit` makes, unless it already has this key. True if it is drawn, false if the program did
// not link, null until it is compiled.
/**
 * @param {three.Renderer} renderer @param {three.Scene} scene @param {Table} table
 * @param {string} key @param {string} name @param {(shader: three.Shader) => void} edit
 */
export function drawTable(renderer, scene, table, key, name, edit) {
  const { target, dome } = table, { camera } = startedViewer();
  if (refused.has(dome.material)) return false;
  if (table.key === key) return true;
  litBy(dome, scene);
  const before = renderer.getRenderTarget();
  renderer.setRenderTarget(target);
  const isDressed = dress(renderer, dome, name, edit, camera);
  if (isDressed) renderer.render(dome, camera);
  renderer.setRenderTarget(before);
  if (!isDressed) return null;
  table.key = key;
  return isLinked(renderer, dome.material);
}

// Draw the table of the sea `base`, unless it already shows this photograph and these uniforms. False until it is compiled.
/** @param {string} base @param {Sea} sea @param {three.Renderer} renderer @param {three.Scene} scene */
export function drawSkyTable(base, sea, renderer, scene) {
  const photograph = scene.environment, Target = photograph?.renderTarget?.constructor;
  if (!Target || !renderer.extensions.has("EXT_color_buffer_float")) return true;
  const { uniforms } = sea, { environmentIntensity, environmentRotation } = scene;
  const numbers = [...SKY_UNIFORMS, "fromSea"].flatMap((name) => uniforms[name].value.toArray());
  const key = [contextNumber(), photograph.uuid, photograph.version, environmentIntensity, ...environmentRotation.toArray(), ...numbers].join();
  let table = skyTables.get(base);
  if (!table) {
    const how = { type: HALF_FLOAT, format: RGBA, minFilter: LINEAR, magFilter: LINEAR, wrapS: REPEAT, wrapT: CLAMP };
    const rows = (SKY_BLUR.length + 1) * SKY_ROWS + 3;
    table = makeTable(sea, new Target(SKY_COLUMNS, rows, { ...how, depthBuffer: false }));
    skyTables.set(base, table);
  }
  const isNew = table.key !== key;
  const isDrawn = drawTable(renderer, scene, table, key, "springtide-sky-table", (shader) => {
    Object.assign(shader.uniforms, uniforms);
    shader.vertexShader = TARGET_VERTEX;
    shader.fragmentShader = SKY_TABLE_FRAGMENT;
  });
  if (isDrawn && isNew) skiesDrawn += 1;
  uniforms.skyTable.value = isDrawn === false ? null : table.target.texture;
  return isDrawn !== null;
}

// The text of a fragment shader that shows the sky of these uniforms.
/** @param {string} source @param {three.Uniforms} uniforms */
export function withSky(source, uniforms) {
  return withDetails(uniforms.skyTable.value ? `${SKY_TABLE}\n${source}` : source);
}
