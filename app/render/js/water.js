// How water looks: the recipe that patch.js applies to "<name>" where there is a "<name>/water_look".
//
// "<name>/water_aux" carries (slope x, slope y, foam) per vertex, "<name>/water_look" the uniforms, three to a vertex,
// in the order of water.py. Frames: "sea" is the frame of the node (z up); three's world is turned against it.

const WATER_UNIFORMS = [
  "deep", "scatter", "foamColor", "sunDirection", "sunColor", "optics",
  "air", "ripple", "skyline", "fold", "tint", "weather", "place", "state", "grid", "extent", "wireColor",
  "slick", "slickDeep", "slickScatter", "slickOptics", "pit", "pitWay",
];
const seas = new Map(); // base name -> what this file has made for it
const looks = new Map(); // base name -> its uniforms: one set for good, as viser keeps a material for a new geometry

function uniformsOf(base, mesh) {
  if (!looks.has(base)) {
    const uniforms = { toSea: { value: mesh.matrixWorld.clone() }, fromSea: { value: mesh.matrixWorld.clone() } };
    for (const name of WATER_UNIFORMS) uniforms[name] = { value: mesh.position.clone() };
    looks.set(base, uniforms);
  }
  return looks.get(base);
}

function makeSea(mesh, uniforms) {
  return { mesh, geometry: mesh.geometry, uniforms, tiles: [], levels: [], shape: "", dome: null, wire: null };
}

function readLook(sea, look) {
  const array = look.geometry.attributes.position.array;
  WATER_UNIFORMS.forEach((name, k) => sea.uniforms[name].value.fromArray(array, 3 * k));
  sea.uniforms.fromSea.value.copy(sea.mesh.matrixWorld);
  sea.uniforms.toSea.value.copy(sea.mesh.matrixWorld).invert();
}

// Triangles of a grid at every stride-th vertex, with its rim at every vertex: neighbours of any two strides meet
// without a crack. Vertex (i, j) is number i * columns + j.
function levelIndex(rows, columns, stride) {
  const index = [];
  for (let i = 0; i < rows - 1; i += stride) {
    for (let j = 0; j < columns - 1; j += stride) {
      const rim = [];
      const side = (i0, j0, di, dj, onRim) => {
        const step = onRim ? 1 : stride;
        for (let s = 0; s < stride; s += step) rim.push((i0 + di * s) * columns + j0 + dj * s);
      };
      const low = i + stride, right = j + stride;
      side(i, j, 1, 0, j === 0);
      side(low, j, 0, 1, low === rows - 1);
      side(low, right, -1, 0, right === columns - 1);
      side(i, right, 0, -1, i === 0);
      // A fan from the corner that lies furthest inside has no flat triangle.
      const corner = (i === 0 ? low : i) * columns + (j === 0 ? right : j);
      const at = rim.indexOf(corner);
      for (let k = 1; k < rim.length - 1; k++) {
        index.push(rim[at], rim[(at + k) % rim.length], rim[(at + k + 1) % rim.length]);
      }
    }
  }
  return index;
}

// Coarser geometries over the same vertex buffers: nothing is sent and nothing uploaded but their index.
function makeLevels(sea, rows, columns) {
  const Geometry = sea.geometry.constructor;
  const Attribute = sea.geometry.index.constructor;
  for (const stride of [2, 4, 8]) {
    if ((rows - 1) % stride || (columns - 1) % stride || (rows - 1) / stride < 4 || (columns - 1) / stride < 4) break;
    const geometry = new Geometry();
    geometry.setIndex(new Attribute(new Uint32Array(levelIndex(rows, columns, stride)), 1));
    sea.levels.push({ stride, geometry });
  }
}

function makeTiles(sea, count, length) {
  const half = (count - 1) / 2;
  for (let i = -half; i <= half; i++) {
    for (let j = -half; j <= half; j++) {
      if (i === 0 && j === 0) continue;
      const tile = sea.mesh.clone(false);
      tile.position.set(i * length, j * length, 0);
      tile.raycast = () => {}; // clicks are answered by the mesh itself and by the scene
      sea.mesh.parent.add(tile);
      sea.tiles.push(tile);
    }
  }
}

function makeDome(sea) {
  const geometry = new sea.geometry.constructor();
  const Attribute = sea.geometry.attributes.position.constructor;
  geometry.setAttribute("position", new Attribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
  const material = new sea.mesh.material.constructor();
  material.depthWrite = false;
  const dome = new sea.mesh.constructor(geometry, material);
  dome.frustumCulled = false;
  dome.renderOrder = 1e6;
  dome.raycast = () => {};
  sea.mesh.parent.add(dome);
  return dome;
}

function makeWire(sea) {
  const material = new sea.mesh.material.constructor();
  material.wireframe = true;
  const wire = sea.mesh.clone(false);
  wire.material = material;
  wire.raycast = () => {};
  sea.mesh.parent.add(wire);
  return wire;
}

function unmakeSea(sea) {
  for (const made of [...sea.tiles, sea.dome, sea.wire]) if (made) made.removeFromParent();
  for (const level of sea.levels) {
    level.geometry.attributes = {}; // shared: they belong to viser's geometry
    level.geometry.dispose();
  }
  if (sea.dome) sea.dome.geometry.dispose(), sea.dome.material.dispose();
  if (sea.wire) sea.wire.material.dispose();
  sea.tiles = [];
  sea.levels = [];
  sea.dome = sea.wire = null;
}

function chooseLevels(sea, camera) {
  const [length, cell] = [sea.uniforms.grid.value.z, sea.uniforms.grid.value.z / (sea.uniforms.grid.value.x - 1)];
  const eye = camera.getWorldPosition(sea.mesh.position.clone()).applyMatrix4(sea.uniforms.toSea.value);
  for (const tile of sea.tiles) {
    const dx = Math.max(0, Math.abs(eye.x - tile.position.x - length / 2) - length / 2);
    const dy = Math.max(0, Math.abs(eye.y - tile.position.y - length / 2) - length / 2);
    const far = Math.hypot(dx, dy, eye.z);
    let geometry = sea.geometry;
    for (const level of sea.levels) if ((level.stride * cell) / far < 0.012) geometry = level.geometry;
    tile.geometry = geometry;
  }
}

// Give a mesh the "vertices" of a hidden mesh as one more vertex attribute. Same object, so no copy and no upload of
// its own: viser swaps the array behind it at each update. False while the two differ in length.
function share(mesh, attribute, channel) {
  const source = channel.geometry.attributes.position;
  if (!source || source.count !== mesh.geometry.attributes.position.count) return false;
  if (mesh.geometry.attributes[attribute] !== source) mesh.geometry.setAttribute(attribute, source);
  return true;
}

recipes.push({
  suffix: "/water_look",
  sweep() {
    for (const [base, sea] of seas) {
      if (meshOf(base)) continue;
      unmakeSea(sea);
      seas.delete(base);
    }
  },
  frame({ base, mesh, channel, renderer, camera }) {
    const aux = meshOf(`${base}/water_aux`);
    if (!aux || !share(mesh, "aux", aux)) return null;
    let sea = seas.get(base);
    if (!sea || sea.mesh !== mesh || sea.geometry !== mesh.geometry) {
      if (sea) unmakeSea(sea);
      seas.set(base, (sea = makeSea(mesh, uniformsOf(base, mesh))));
      mesh.geometry.computeVertexNormals = () => {}; // they come with aux: viser need not derive them each frame
    }
    readLook(sea, channel);
    const [rows, columns, length] = sea.uniforms.grid.value.toArray();
    const [count, domed, wired] = sea.uniforms.extent.value.toArray();
    const shape = [rows, columns, length, count].join();
    if (sea.shape !== shape) {
      unmakeSea(sea);
      sea.shape = shape;
      if (rows > 0 && count > 1) {
        makeLevels(sea, rows, columns);
        makeTiles(sea, count, length);
      }
    }
    const edit = (shader) => {
      Object.assign(shader.uniforms, sea.uniforms);
      shader.vertexShader = WATER_GLSL.vertex;
      shader.fragmentShader = WATER_FRAGMENT;
    };
    if (!dress(mesh.material, `springtide-water${base}`, edit)) {
      unmakeSea(sea);
      delete mesh.geometry.computeVertexNormals;
      return null;
    }
    for (const { geometry } of sea.levels) {
      geometry.boundingSphere = mesh.geometry.boundingSphere;
      for (const name of ["position", "aux"]) {
        if (geometry.attributes[name] !== mesh.geometry.attributes[name]) {
          geometry.setAttribute(name, mesh.geometry.attributes[name]);
        }
      }
    }
    for (const tile of sea.tiles) {
      tile.material = mesh.material;
      tile.updateMatrixWorld();
    }
    chooseLevels(sea, camera);

    if (domed && !sea.dome) sea.dome = makeDome(sea);
    if (sea.dome) {
      sea.dome.visible = domed > 0;
      dress(sea.dome.material, "springtide-dome", (shader) => {
        // viser asks three for a reversed depth buffer; a browser without clip control does not get one.
        const farDepth = { value: renderer.state.buffers.depth.getReversed() ? 0 : 1 };
        Object.assign(shader.uniforms, sea.uniforms, { farDepth });
        shader.vertexShader = DOME_VERTEX;
        shader.fragmentShader = DOME_FRAGMENT;
      });
    }
    if (wired && !sea.wire) sea.wire = makeWire(sea);
    if (sea.wire) {
      sea.wire.visible = wired > 0;
      sea.wire.updateMatrixWorld();
      dress(sea.wire.material, "springtide-wire", (shader) => {
        Object.assign(shader.uniforms, { wireColor: sea.uniforms.wireColor });
        // A little nearer to the eye than the water it lies on.
        splice(shader, "vertexShader", "project_vertex", "gl_Position = projectionMatrix * (mvPosition * vec4(vec3(0.998), 1.0));");
        splice(shader, "fragmentShader", "common", "uniform vec3 wireColor;");
        shader.fragmentShader = shader.fragmentShader.replace("#include <opaque_fragment>", "gl_FragColor = vec4(wireColor, 1.0);");
      });
    }
    // The plain stand-ins that other browsers may need are not for this one.
    for (const part of ["foam", "wire", "sea", "slick"]) {
      const name = `${base}/plain_${part}`;
      const standIn = meshOf(name);
      if (standIn) standIn.visible = false;
    }
    return mesh.material;
  },
});
