// Replaces the shaders of stock viser's meshes, once per frame, for every node that asks for it.
//
// A node asks by a hidden child mesh with the suffix of a shader: "/rope" has a colour at each vertex if there is a
// "/rope/vertex_colors". Everything that changes travels as vertices, so that new scenes, browsers that connect later
// and recordings need no further script.
//
// Of viser this file uses window.__viserMutable: nodeRefFromName (the group of a node), scene (its onBeforeRender runs
// before every frame, so that a new material of viser's never shows without its shader), requestRender and sendMessage.
// Of three it uses Material.onBeforeCompile and the renderer's property map, to see whether a program linked.
//
// app/render/injection.py puts these constants before this file: WATER_UNIFORMS, RAIN_UNIFORMS, MAX_WATERLINES,
// DARK_LIFT, LUMA.

// Each shader: { suffix, unpack(node), update(context), removeUnused() }. `unpack` (optional) brings the vertices up to
// date before the camera of the frame is placed. `update` is called for each node with that suffix. It
// returns the material that has the shader, or null. `removeUnused` (optional) disposes of what removed nodes left.
const shaders = [];
const refused = new WeakSet(); // materials with a program that did not link: they keep viser's own shader

// The mesh of a node is the first child of its group; shadow meshes and child nodes come after it.
function meshOf(name) {
  const group = window.__viserMutable.nodeRefFromName[name];
  return (group && group.children && group.children.find((child) => child.isMesh)) || null;
}

// Give a material another shader; false where its program did not link. viser makes a new material when wireframe,
// opacity, flat shading or side change, so this is done in every frame. key: of the shader; edit(shader): changes it.
function replaceShader(material, key, edit) {
  if (refused.has(material)) return false;
  if (material.userData.springtide !== key) {
    material.userData.springtide = key;
    material.onBeforeCompile = edit;
    material.customProgramCacheKey = () => key;
    material.needsUpdate = true;
  }
  return true;
}

// Programs that the browser is still compiling. It does so beside the page where it has KHR_parallel_shader_compile.
const awaited = new Set();
const LOOK_INTERVAL = 30; // [ms] between two looks at them
let programsReady = 0; // counts on with each of them; frames.js draws when it changes
let isCompiling = false; // whether this frame has begun to use a program, in a browser that compiles while the page waits

function lookForPrograms() {
  const before = programsReady;
  for (const program of awaited) {
    if (program.program && program.isReady?.() === false) continue; // one that is gone has none
    awaited.delete(program);
    programsReady += 1;
  }
  if (awaited.size > 0) setTimeout(lookForPrograms, LOOK_INTERVAL);
  if (programsReady > before) window.__viserMutable.requestRender();
}

// Give an object a material with another shader as soon as its program is compiled; until then it keeps the one that it has.
// Where the page waits for a program, only one is compiled in each frame. key: of the shader; edit(shader): changes it; scene:
// whose lights it has. Returns whether the object has a material with some shader.
function dress(renderer, object, key, edit, camera, scene = object) {
  const { userData } = object, earlier = object.material;
  userData.materials ??= new Map([["", earlier]]); // by key of their shader
  const { materials } = userData, bare = materials.get("");
  if (!materials.has(key)) {
    materials.set(key, bare.clone());
    replaceShader(materials.get(key), key, edit);
  }
  const next = materials.get(key);
  if (next === earlier) return true;
  object.material = next;
  renderer.compile(object, camera, scene);
  const program = renderer.properties.get(next).currentProgram, isBeside = renderer.extensions.has("KHR_parallel_shader_compile");
  if (QUALITY.isWhole() || (isBeside ? program.isReady?.() !== false : !isCompiling)) {
    isCompiling = true;
    return true;
  }
  if (awaited.size === 0) setTimeout(lookForPrograms, LOOK_INTERVAL);
  awaited.add(program);
  object.material = earlier;
  return earlier !== bare;
}

function disposeMaterials(object) {
  for (const material of object.userData.materials?.values() ?? [object.material]) material.dispose();
}

// Whether the program of a material linked. If a driver refuses it, the material gets viser's shader back, so that the
// mesh is still drawn, and the server is not told that the shader is active.
function isLinked(renderer, material) {
  const program = renderer.properties.get(material).currentProgram;
  if (!program) return false; // not drawn yet
  const gl = renderer.getContext();
  if (program.__springtide === undefined) {
    program.__springtide = gl.getProgramParameter(program.program, gl.LINK_STATUS);
  }
  if (program.__springtide) return true;
  refused.add(material);
  material.onBeforeCompile = () => {};
  material.customProgramCacheKey = () => "";
  material.needsUpdate = true;
  return false;
}

// Insert text after the include of one of three's shader chunks.
function insertAfter(shader, stage, chunk, text) {
  shader[stage] = shader[stage].replace(`#include <${chunk}>`, `#include <${chunk}>\n${text}`);
}

// A colour at each vertex, for any mesh with a child "<name>/vertex_colors", which carries the positions of its vertices
// and their sRGB colours in 0..1, packed (packed.js).
shaders.push({
  suffix: "/vertex_colors",
  update({ base, mesh, data }) {
    if (!applyPacked(mesh, data, "vertexColor", null)) return null;
    const dark = isDark(), underwater = underwaterOf(base, mesh), open = openPartOf(base, underwater);
    const isAmbient = skyTerms.value && isRough(mesh.material);
    const edit = (shader) => {
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
});

const REPORT_INTERVAL = 500; // [ms] between two looks for a field that has had no report
const PAGE = Math.random().toString(36).slice(2, 10); // viser passes on only what changes the value of a field
let drawn = "", reported = "";

// Report the names of the nodes that are drawn with their shader, once to each field and whenever they change. The
// field comes after the script, and each scene has its own.
function report() {
  const uuid = document.querySelector("[data-springtide-shaders]")?.dataset.springtideShaders;
  const send = window.__viserMutable.sendMessage;
  if (!uuid || !send || reported === `${uuid}\n${drawn}`) return;
  reported = `${uuid}\n${drawn}`;
  send({ type: "GuiUpdateMessage", uuid, updates: { value: `${PAGE}\n${drawn}` } });
}

// Call a function for each shader and node that asks for it: { base, mesh, data }.
function forEachShaded(call) {
  const nodes = window.__viserMutable.nodeRefFromName;
  for (const name of Object.keys(nodes)) {
    for (const shader of shaders) {
      if (!name.endsWith(shader.suffix) || !nodes[name]) continue;
      const base = name.slice(0, -shader.suffix.length), mesh = meshOf(base), data = meshOf(name);
      if (mesh && data) call(shader, { base, mesh, data });
    }
  }
}

let paced = null; // the renderer whose frames are paced

function beforeRender(renderer, scene, camera) {
  if (paced !== renderer) {
    paced = renderer;
    makeOpaque(renderer, scene);
    QUALITY.start(renderer);
    paceFrames(renderer);
  }
  window.__springtide = { memory: () => ({ ...renderer.info.memory }), quality: QUALITY, skiesDrawn }; // tests read it
  QUALITY.beforeRender(renderer);
  isCompiling = false;
  shrinkPhotograph(renderer, scene);
  drawOneLightOfEachSun(scene);
  const active = [];
  forEachShaded((shader, node) => {
    const material = shader.update({ ...node, renderer, scene, camera });
    if (material && isLinked(renderer, material)) active.push(node.base);
  });
  for (const shader of shaders) if (shader.removeUnused) shader.removeUnused();
  lightMeshes(renderer, scene);
  dressSmoke(scene);
  dressLabels(renderer, scene, camera);
  drawn = active.sort().join("\n");
  report();
}

// The script may arrive before viser has made its canvas.
function install() {
  const viewer = window.__viserMutable;
  if (!viewer || !viewer.scene || !viewer.nodeRefFromName) return void setTimeout(install, 50);
  const earlier = viewer.scene.onBeforeRender.springtideEarlier || viewer.scene.onBeforeRender;
  const hook = function (renderer, scene, camera, target) {
    forEachShaded((shader, node) => shader.unpack?.(node)); // the camera (camera.js) stays above this frame's water
    earlier.call(this, renderer, scene, camera, target);
    beforeRender(renderer, scene, camera);
  };
  hook.springtideEarlier = earlier;
  viewer.scene.onBeforeRender = hook;
  clearInterval(window.__springtideReports); // of an earlier connection
  window.__springtideReports = setInterval(report, REPORT_INTERVAL);
  viewer.requestRender();
}
