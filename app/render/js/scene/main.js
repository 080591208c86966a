// Draws the scene: replaces the shaders of viser's meshes, once per frame, for every node that requests it.
//
// A node requests a shader by a hidden child mesh with its suffix: "/rope" has a colour at each vertex if there is a
// "/rope/vertex_colors". All data travels as vertices, so that new scenes, browsers that connect later and recordings need no
// further script. A lab that draws by viser's public interface alone has no topic "picture": there nothing is
// replaced.

import { topicState, tell } from "../core/channel.js";
import { Life, page } from "../core/life.js";
import { beforeRender } from "../core/render_hook.js";
import { springtide } from "../core/springtide.js";
import { startedViewer } from "../core/viewer.js";
import { onLook } from "../core/watch.js";
import { openWater } from "../sea/open_water.js";
import { rain } from "../sea/rain.js";
import { skiesDrawn } from "../sea/sky_table.js";
import { drawnSea, seaSky, water } from "../sea/water.js";
import { followContext } from "../shading/context.js";
import { QUALITY } from "../shading/quality.js";
import { beginFrame, isLinked, meshOf } from "../shading/shaders.js";
import { lightMeshes } from "./ambient.js";
import { contact } from "./contact.js";
import { pictured } from "./cover.js";
import { makeOpaque, paceFrames } from "./frames.js";
import { renewInstances } from "./instances.js";
import { dressLabels } from "./labels.js";
import { preparePhotograph } from "./photograph.js";
import { dressSmoke } from "./smoke.js";
import { drawOneLightOfEachSun } from "./sun.js";
import { vertexColors } from "./vertex_colors.js";
import { wet } from "./wet.js";

// Each shader: { suffix, unpack(node), update(context), removeUnused() }. `unpack` (optional) brings the vertices up to
// date before the camera of the frame is placed. `update` is called for each node with that suffix. It
// returns the material that has the shader, or null. `removeUnused` (optional) disposes of the resources of removed nodes.
/** @type {NodeShader[]} */
const SHADERS = [vertexColors, openWater, contact, water, rain, wet];

/** @type {string[]} */
let drawn = [];
const isPlain = () => !topicState("picture") && document.querySelector(".springtide-panel[data-state]") !== null;

// Report the names of the nodes that are drawn with their shader, and whether the picture of the scene is whole: the run waits
// for that.
function report() {
  const scene = topicState("picture")?.scene;
  if (scene) tell("drawn", { scene, isWhole: pictured === scene, nodes: drawn });
}

// Call a function for each shader and each node that requests it: { base, mesh, data }.
/** @param {(shader: NodeShader, node: ShadedNode) => void} call */
function forEachShaded(call) {
  const nodes = startedViewer().nodeRefFromName;
  for (const name of Object.keys(nodes)) {
    for (const shader of SHADERS) {
      if (!name.endsWith(shader.suffix) || !nodes[name]) continue;
      const base = name.slice(0, -shader.suffix.length), mesh = meshOf(base), data = meshOf(name);
      if (mesh && data) call(shader, { base, mesh, data });
    }
  }
}

/** @type {{ renderer: three.Renderer, life: Life } | null} */
let current = null; // the renderer, and the life of its resources

/** @param {three.Renderer} renderer @param {three.Scene} scene */
function follow(renderer, scene) {
  current?.life.end();
  current = { renderer, life: new Life() };
  springtide.quality = QUALITY;
  springtide.memory = () => ({ ...renderer.info.memory });
  makeOpaque(renderer, scene);
  followContext(renderer, current.life);
  QUALITY.start(renderer, current.life);
  paceFrames(renderer, current.life);
}

/** @param {three.Renderer} renderer @param {three.Scene} scene @param {three.Camera} camera */
function dressScene(renderer, scene, camera) {
  if (isPlain() || renderer.getContext().isContextLost()) return; // no program links without a context
  if (current?.renderer !== renderer) follow(renderer, scene);
  QUALITY.beforeRender(renderer);
  beginFrame();
  renewInstances(renderer, scene);
  preparePhotograph(renderer, scene, seaSky());
  drawOneLightOfEachSun(scene);
  /** @type {string[]} */
  const active = [];
  forEachShaded((shader, node) => {
    const material = shader.update({ ...node, renderer, scene, camera });
    if (material && isLinked(renderer, material)) active.push(node.base);
  });
  for (const shader of SHADERS) shader.removeUnused?.();
  lightMeshes(renderer, scene, drawnSea());
  dressSmoke(scene);
  dressLabels(renderer, scene, camera);
  springtide.skiesDrawn = skiesDrawn;
  drawn = active.sort();
  report();
}

page.own(() => current?.life.end());
beforeRender("data", () => forEachShaded((shader, node) => shader.unpack?.(node)));
beforeRender("materials", dressScene);
onLook(report);
