// The shader of water, for "<name>" where there is a "<name>/water_material".
//
// "<name>/water_surface" carries displacement, slope x, slope y and foam of each vertex, packed (packed.js), and
// "<name>/water_rest" where the vertices rest; "<name>/water_lines" what stands in the water. The vertices of "<name>/water_material" are the uniforms, in the order of
// WATER_UNIFORMS (app/render/material.py). "Sea" in a name means the frame of the node,
// z up; three's world is rotated against it.

const seas = new Map(); // name of the node -> what this file has made for it
// Name of the node -> its uniforms. They are kept for good, because viser may keep a material for a new geometry.
const uniformsByName = new Map();

// Uniforms of three numbers each. three's classes are not in scope, therefore vectors are copied from the mesh.
function makeUniforms(mesh, names) {
  return Object.fromEntries(names.map((name) => [name, { value: mesh.position.clone() }]));
}

// Read uniforms from the vertices of a hidden mesh.
function readUniforms(uniforms, names, data) {
  const numbers = data.geometry.attributes.position.array;
  names.forEach((name, k) => uniforms[name].value.fromArray(numbers, 3 * k));
}

function uniformsOf(base, mesh) {
  if (!uniformsByName.has(base)) {
    const uniforms = makeUniforms(mesh, WATER_UNIFORMS);
    for (const name of ["toSea", "fromSea"]) uniforms[name] = { value: mesh.matrixWorld.clone() };
    for (const name of ["wavePlaces", "waveSlopes", "skyTable"]) uniforms[name] = { value: null };
    uniforms.waterlines = { value: Array.from({ length: 4 * MAX_WATERLINES }, () => mesh.position.clone().set(0, 0, 0)) };
    uniformsByName.set(base, uniforms);
  }
  return uniformsByName.get(base);
}

function makeSea(mesh, uniforms) {
  return { mesh, geometry: mesh.geometry, uniforms, tiles: [], levels: [], shape: "", filled: -1, dome: null, wire: null };
}

// Fill a texture with n x n x 4 numbers, and its smaller copies with their means. three binds it but does not fill it:
// its own class is not in scope, and it takes any object with this version for one whose data needs no upload.
function filledTexture(renderer, texture, n, numbers) {
  const gl = renderer.getContext();
  texture ??= { isTexture: true, version: 0 };
  const name = (renderer.properties.get(texture).__webglTexture ??= gl.createTexture());
  renderer.state.activeTexture(gl.TEXTURE0);
  renderer.state.bindTexture(gl.TEXTURE_2D, name);
  const flags = [gl.UNPACK_FLIP_Y_WEBGL, gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL];
  const kept = flags.map((flag) => gl.getParameter(flag));
  for (const flag of flags) gl.pixelStorei(flag, false);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA16F, n, n, 0, gl.RGBA, gl.FLOAT, numbers);
  flags.forEach((flag, k) => gl.pixelStorei(flag, kept[k]));
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
  gl.generateMipmap(gl.TEXTURE_2D);
  return texture;
}

// The waves of a square tile as the textures that the shader reads (WATER_GLSL.waves), where they have changed.
function fillWaves(sea, renderer, rest) {
  const [rows, columns] = sea.uniforms.grid.value.toArray();
  const { position, slopeAndFoam } = sea.geometry.attributes;
  if (rows === 0 || sea.filled === slopeAndFoam.version) return;
  sea.filled = slopeAndFoam.version;
  const n = rows - 1;
  const [places, slopes] = [new Float32Array(4 * n * n), new Float32Array(4 * n * n)];
  for (let i = 0, to = 0; i < n; i++) {
    for (let j = 0; j < n; j++, to += 4) {
      const from = 3 * (i * columns + j);
      for (let axis = 0; axis < 3; axis++) {
        places[to + axis] = position.array[from + axis] - rest[from + axis];
        slopes[to + axis] = slopeAndFoam.array[from + axis];
      }
      slopes[to + 3] = slopes[to] ** 2 + slopes[to + 1] ** 2;
    }
  }
  for (const [name, numbers] of [["wavePlaces", places], ["waveSlopes", slopes]]) {
    sea.uniforms[name].value = filledTexture(renderer, sea.uniforms[name].value, n, numbers);
  }
}

function readMaterial(sea, data) {
  readUniforms(sea.uniforms, WATER_UNIFORMS, data);
  sea.uniforms.fromSea.value.copy(sea.mesh.matrixWorld);
  sea.uniforms.toSea.value.copy(sea.mesh.matrixWorld).invert();
}

// Triangles of a grid at every stride-th vertex, but at every vertex of its rim, so that tiles of different strides
// meet without a gap. Vertex (i, j) has the number i * columns + j.
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
      // A fan from the corner that is farthest from the rim has no degenerate triangle.
      const corner = (i === 0 ? low : i) * columns + (j === 0 ? right : j);
      const at = rim.indexOf(corner);
      for (let k = 1; k < rim.length - 1; k++) {
        index.push(rim[at], rim[(at + k) % rim.length], rim[(at + k + 1) % rim.length]);
      }
    }
  }
  return index;
}

// Coarser geometries on the same vertex buffers: only their index is uploaded.
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
      tile.raycast = () => {}; // clicks are handled by the mesh itself and by the scene
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

function disposeSea(sea) {
  for (const made of [...sea.tiles, sea.dome, sea.wire]) if (made) made.removeFromParent();
  for (const level of sea.levels) {
    level.geometry.attributes = {}; // they belong to viser's geometry
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

// Until a sea's programs are compiled, and where its mesh is made anew, the photograph behind it would show its land. The
// page's own sky is seen there instead. Without the shader the photograph is the sky.
function showPhotograph(scene, shown) {
  if (!shown && scene.background) [scene.userData.photograph, scene.background] = [scene.background, null];
  if (shown && !scene.background) scene.background = scene.userData.photograph || null;
}

shaders.push({
  suffix: "/water_material",
  removeUnused() {
    for (const [base, sea] of seas) {
      if (meshOf(base)) continue;
      disposeSea(sea);
      seas.delete(base);
    }
  },
  update({ base, mesh, data, renderer, scene, camera }) {
    showPhotograph(scene, false);
    const surface = meshOf(`${base}/water_surface`), rest = meshOf(`${base}/water_rest`);
    if (!surface || !rest) return null;
    let sea = seas.get(base);
    if (!sea || sea.mesh !== mesh || sea.geometry !== mesh.geometry) {
      if (sea) disposeSea(sea);
      seas.set(base, (sea = makeSea(mesh, uniformsOf(base, mesh))));
      mesh.geometry.computeVertexNormals = () => {}; // the slopes replace them: viser need not compute them each frame
    }
    if (!applyPacked(mesh, surface, "slopeAndFoam", rest.geometry.attributes.position.array)) return null;
    readMaterial(sea, data);
    drawSkyTable(base, sea, renderer, scene);
    fillWaves(sea, renderer, rest.geometry.attributes.position.array);
    const lines = meshOf(`${base}/water_lines`);
    if (lines) {
      const numbers = lines.geometry.attributes.position.array;
      sea.uniforms.waterlines.value.forEach((vector, k) => vector.fromArray(numbers, 3 * k));
    }
    const [rows, columns, length] = sea.uniforms.grid.value.toArray();
    const [count, drawSky, wireframe] = sea.uniforms.extent.value.toArray();
    const shape = [rows, columns, length, count].join();
    if (sea.shape !== shape) {
      disposeSea(sea);
      sea.shape = shape;
      if (rows > 0 && count > 1) {
        makeLevels(sea, rows, columns);
        makeTiles(sea, count, length);
      }
    }
    const isCut = sea.uniforms.cutout.value.z > 0;
    const edit = (shader) => {
      Object.assign(shader.uniforms, sea.uniforms);
      shader.vertexShader = waterVertex(false);
      shader.fragmentShader = withSky(isCut ? `#define CUTOUT\n${WATER_FRAGMENT}` : WATER_FRAGMENT, sea.uniforms);
    };
    if (!replaceShader(mesh.material, keyWithDetails(`springtide-water${base}${isCut ? " cut" : ""}`), edit)) {
      disposeSea(sea);
      delete mesh.geometry.computeVertexNormals;
      showPhotograph(scene, true);
      return null;
    }
    for (const { geometry } of sea.levels) {
      geometry.boundingSphere = mesh.geometry.boundingSphere;
      for (const name of ["position", "slopeAndFoam"]) {
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

    if (drawSky && !sea.dome) sea.dome = makeDome(sea);
    if (sea.dome) {
      sea.dome.visible = drawSky > 0;
      replaceShader(sea.dome.material, keyWithDetails("springtide-dome"), (shader) => {
        // viser asks three for a reversed depth buffer; a browser without clip control has none.
        const farDepth = { value: renderer.state.buffers.depth.getReversed() ? 0 : 1 };
        Object.assign(shader.uniforms, sea.uniforms, { farDepth });
        shader.vertexShader = DOME_VERTEX;
        shader.fragmentShader = withSky(DOME_FRAGMENT, sea.uniforms);
      });
    }
    if (wireframe && !sea.wire) sea.wire = makeWire(sea);
    if (sea.wire) {
      sea.wire.visible = wireframe > 0;
      sea.wire.updateMatrixWorld();
      replaceShader(sea.wire.material, "springtide-wire", (shader) => {
        Object.assign(shader.uniforms, sea.uniforms);
        shader.vertexShader = waterVertex(true);
        shader.fragmentShader = WIRE_FRAGMENT;
      });
    }
    // The server may add meshes for browsers without this shader (Water._draw_plain); here they are hidden.
    for (const part of ["foam", "wire", "sea", "slick"]) {
      const plain = meshOf(`${base}/plain_${part}`);
      if (plain) plain.visible = false;
    }
    return mesh.material;
  },
});
