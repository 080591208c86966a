// The material patch: dresses stock viser's meshes from the inside, once per frame, for every node that asks.
//
// A mesh asks by having a hidden child mesh whose name ends in a recipe's suffix: "/rope" is painted when there is a
// "/rope/paint". So new scenes, late joiners and recordings need no further script: everything that changes travels as
// ordinary vertices, which viser culls.
//
// Of viser this file uses window.__viserMutable: nodeRefFromName (the group of a node), scene (its onBeforeRender runs
// before every frame, so that a material that viser has just made anew is never drawn undressed) and requestRender.
// Of three it uses Material.onBeforeCompile and the renderer's property map, to see whether a program linked.

const recipes = []; // { suffix, frame(context) -> the material it dressed or null, sweep() what is left of removed nodes }
const failed = new Set(); // materials whose program did not link: left as viser made them

// The mesh of a node is the first child of its group; shadow meshes and child nodes come after it.
function meshOf(name) {
  const group = window.__viserMutable.nodeRefFromName[name];
  return (group && group.children && group.children.find((child) => child.isMesh)) || null;
}

// viser makes a new material when wireframe, opacity, flat shading or side change: dress whichever is there.
function dress(material, key, edit) {
  if (failed.has(material)) return false;
  if (material.userData.springtide !== key) {
    material.userData.springtide = key;
    material.onBeforeCompile = edit;
    material.customProgramCacheKey = () => key;
    material.needsUpdate = true;
  }
  return true;
}

// A driver that refuses the program must not leave a hole in the picture: undress and say nothing of being alive.
function linked(renderer, material) {
  const program = renderer.properties.get(material).currentProgram;
  if (!program) return false; // not drawn yet
  const gl = renderer.getContext();
  if (program.__springtide === undefined) {
    program.__springtide = gl.getProgramParameter(program.program, gl.LINK_STATUS);
  }
  if (program.__springtide) return true;
  failed.add(material);
  material.onBeforeCompile = () => {};
  material.customProgramCacheKey = () => "";
  material.needsUpdate = true;
  return false;
}

function splice(shader, stage, chunk, text) {
  shader[stage] = shader[stage].replace(`#include <${chunk}>`, `#include <${chunk}>\n${text}`);
}

// Per-vertex colours on any mesh with a child "<name>/paint": the latter half of its vertices, which no face names, is the
// sRGB in 0..1 of the former.
recipes.push({
  suffix: "/paint",
  frame({ mesh }) {
    const attributes = mesh.geometry.attributes;
    if (!attributes.position) return null;
    const numbers = attributes.position.array;
    const half = numbers.length / 2;
    if (!attributes.paint || attributes.paint.array.length !== half) {
      mesh.geometry.setAttribute("paint", new attributes.position.constructor(numbers.subarray(half), 3));
    } else if (attributes.paint.of !== numbers) {
      attributes.paint.array = numbers.subarray(half);
      attributes.paint.needsUpdate = true;
    }
    attributes.paint.of = numbers;
    const edit = (shader) => {
      splice(shader, "vertexShader", "common", "attribute vec3 paint; varying vec3 vPaint;");
      splice(shader, "vertexShader", "begin_vertex", "vPaint = pow(max(paint, 0.0), vec3(2.2));");
      splice(shader, "fragmentShader", "common", "varying vec3 vPaint;");
      splice(shader, "fragmentShader", "color_fragment", "diffuseColor.rgb = vPaint;");
    };
    return dress(mesh.material, "springtide-paint", edit) ? mesh.material : null;
  },
});

let told = "";

// The answer to the server: token and names of what is drawn dressed, where viser's Python can read it
// (ClientHandle.local_storage; the prefix is the one its client puts before such keys). Written when it changes.
function tell(alive) {
  const answer = [TOKEN, ...alive.sort()].join("\n");
  if (answer === told) return;
  told = answer;
  try {
    localStorage.setItem("viser-user:springtide-patch", answer);
  } catch {
    // A browser without storage draws as well as any other; the server then believes it plain.
  }
}

function beforeRender(renderer, scene, camera) {
  // viser fades the picture in over the first five frames after its sky is there: many seconds where frames are slow.
  if (scene.environment) renderer.domElement.style.opacity = "1";
  window.__springtide = { memory: () => ({ ...renderer.info.memory }) }; // what a leak would show in
  const nodes = window.__viserMutable.nodeRefFromName;
  const alive = [];
  for (const name of Object.keys(nodes)) {
    for (const recipe of recipes) {
      if (!name.endsWith(recipe.suffix) || !nodes[name]) continue;
      const base = name.slice(0, -recipe.suffix.length);
      const mesh = meshOf(base);
      const channel = meshOf(name);
      if (!mesh || !channel) continue;
      const material = recipe.frame({ base, mesh, channel, renderer, scene, camera });
      if (material && linked(renderer, material)) alive.push(base);
    }
  }
  for (const recipe of recipes) if (recipe.sweep) recipe.sweep();
  tell(alive);
}

// The script may arrive before the canvas is there.
function install() {
  const viewer = window.__viserMutable;
  if (!viewer || !viewer.scene || !viewer.nodeRefFromName) return void setTimeout(install, 50);
  const earlier = viewer.scene.onBeforeRender.springtideEarlier || viewer.scene.onBeforeRender;
  const hook = function (renderer, scene, camera, target) {
    earlier.call(this, renderer, scene, camera, target);
    beforeRender(renderer, scene, camera);
  };
  hook.springtideEarlier = earlier;
  viewer.scene.onBeforeRender = hook;
  viewer.requestRender();
}
