// The mesh of a sea: a fan of rings and spokes about a place behind the eye, over the part of the water that is in view.
//
// Steps between rings grow with the distance from the eye and with its height over the water. Beyond MAX_WAVES the sea is
// level, and its rings double up to the horizon. The vertices are numbers of rings and spokes, which the shader places
// (WATER_VERTEX). Rings are ordered from near to far, so that near waves hide far ones before these are shaded.

const MAX_WAVES = 3000; // [m] from the eye, within which waves move vertices
const MAX_REACH = 2e5; // [m] of the last ring
export const DOUBLED = 8; // rings from MAX_WAVES on
const EDGE_SAMPLES = 8; // of each side of the view
const HIGHEST = 0.05; // [rad] over the horizon up to which there may be waves
const MIN_HALF = 0.2, MAX_HALF = 1.35; // [rad] half the angle of the fan
const LEAST_STEP = 0.3; // step between the nearest rings, in cells of the simulated grid, for a low eye
const MANY_PIXELS = 600_000; // of a canvas, above which triangles are smaller
// Rings with waves, spokes, and the step between rings over the distance from the eye, by `finenessOf`.
export const POLAR = [
  { rings: 80, spokes: 40, step: 0.08 },
  { rings: 180, spokes: 56, step: 0.045 },
  { rings: 240, spokes: 72, step: 0.03 },
];

// Fineness of the grid for a canvas and details of the shaders, 0 to 2: a small triangle costs as much as a large one.
/** @param {WebGL2RenderingContext} canvas @param {number} details */
export function finenessOf({ drawingBufferWidth, drawingBufferHeight }, details) {
  if (details === 0) return 0;
  return drawingBufferWidth * drawingBufferHeight > MANY_PIXELS ? 2 : 1;
}

// Set the fineness of a sea's mesh.
/** @param {GriddedSea} sea @param {number} fineness */
export function setFineness(sea, fineness) {
  const { rings, spokes } = POLAR[fineness], rows = rings + DOUBLED;
  const numbers = new Float32Array(3 * rows * spokes), index = new Uint32Array(6 * (rows - 1) * (spokes - 1));
  for (let ring = 0, k = 0, at = 0; ring < rows; ring++) {
    for (let spoke = 0; spoke < spokes; spoke++, k += 3) {
      [numbers[k], numbers[k + 1]] = [ring, spoke];
      if (ring === rows - 1 || spoke === spokes - 1) continue;
      const a = k / 3, b = a + spokes;
      index.set([a, b, b + 1, a, b + 1, a + 1], at);
      at += 6;
    }
  }
  const geometry = new sea.geometry.constructor(), { position } = sea.geometry.attributes;
  geometry.setAttribute("position", new position.constructor(numbers, 3));
  geometry.setIndex(new sea.geometry.index.constructor(index, 1));
  sea.polar.geometry.dispose();
  sea.polar.geometry = geometry;
  sea.polar.userData.fineness = fineness;
}

// The border of a camera's view as directions in the frame of the sea, up to HIGHEST, and its points on the horizon.
/** @param {Sea} sea @param {three.Camera} camera */
function viewBorder(sea, camera) {
  const v = sea.mesh.position.clone(), border = [], found = [];
  for (let k = 0; k < 4 * EDGE_SAMPLES; k++) {
    const along = (2 * (k % EDGE_SAMPLES)) / EDGE_SAMPLES - 1;
    const [x, y] = [[along, -1], [1, along], [-along, 1], [-1, -along]][Math.floor(k / EDGE_SAMPLES)];
    v.set(x, y, 0.5).applyMatrix4(camera.projectionMatrixInverse).transformDirection(camera.matrixWorld);
    border.push(v.transformDirection(sea.uniforms.toSea.value).toArray());
  }
  for (const [k, a] of border.entries()) {
    const b = border[(k + 1) % border.length];
    if (a[2] <= HIGHEST) found.push(a);
    for (const level of [0, HIGHEST]) {
      const part = (level - a[2]) / (b[2] - a[2]);
      if (part > 0 && part < 1) found.push(a.map((c, axis) => c + part * (b[axis] - c)));
    }
  }
  return found;
}

// Place the grid for a camera, and draw only the rings needed.
/** @param {GriddedSea} sea @param {three.Camera} camera */
export function aimPolar(sea, camera) {
  const { polar, uniforms } = sea, { rings, spokes, step } = POLAR[polar.userData.fineness ?? 0];
  const v = sea.mesh.position.clone(), e = camera.matrixWorld.elements;
  const eye = v.setFromMatrixPosition(camera.matrixWorld).applyMatrix4(uniforms.toSea.value).toArray();
  uniforms.eye.value = eye;
  /** @type {(x: number, y: number, z: number) => number[]} */
  const turned = (x, y, z) => v.set(x, y, z).transformDirection(uniforms.toSea.value).toArray();
  const up = turned(e[4], e[5], e[6]), ahead = turned(-e[8], -e[9], -e[10]);
  // Ahead, or if the camera looks steeply up or down, upwards in its picture.
  const middle = Math.atan2(ahead[1] - ahead[2] * up[1], ahead[0] - ahead[2] * up[0]);
  // Intersections of the border with the highest and the lowest waves: [distance, angle from the middle].
  const points = [];
  for (const [x, y, z] of viewBorder(sea, camera)) {
    const flat = Math.hypot(x, y), turn = Math.atan2(y, x) - middle;
    for (const height of [-sea.highest, sea.highest]) {
      const far = Math.min((flat * Math.max(eye[2] - height, 0)) / Math.max(-z, 1e-9), MAX_REACH);
      points.push([far, turn - 2 * Math.PI * Math.round(turn / (2 * Math.PI))]);
    }
  }
  polar.visible = points.length > 0;
  if (!polar.visible) return;
  const farthest = Math.max(...points.map(([far]) => far));
  const turns = points.filter(([far]) => far > 0.25 * farthest).map(([, turn]) => turn);
  const axis = 0.5 * (Math.min(...turns) + Math.max(...turns));
  const half = Math.min(Math.max(Math.max(...turns) - axis, MIN_HALF), MAX_HALF);
  // The middle of the grid lies so far behind the eye that the fan holds all of these points, moved by waves.
  const moved = points.map(([far, turn]) => [far * Math.cos(turn - axis), Math.abs(far * Math.sin(turn - axis))]);
  const back = Math.max(0, ...moved.map(([u, v]) => (v + sea.widest) / Math.tan(half) - u + sea.widest));
  const radii = moved.map(([u, v]) => Math.hypot(u + back, v));
  const nearest = Math.max(0.95 * Math.min(...radii) - sea.widest, 0);
  const height = Math.max(eye[2], (LEAST_STEP * sea.cell) / step);
  const ringOf = (/** @type {number} */ radius) => Math.asinh((radius - back) / height);
  const withWaves = Math.min(Math.max(...radii) + sea.widest, back + MAX_WAVES);
  const span = Math.max(ringOf(withWaves) - ringOf(nearest), step);
  const wide = Math.max(step, span / (rings - 2));
  const first = wide * Math.floor(ringOf(nearest) / wide), count = Math.ceil((ringOf(withWaves) - first) / wide);
  const isFar = Math.max(...radii) > back + MAX_WAVES;
  // The angle between spokes has few values, and spokes turn by multiples of it, so that they stand still while the camera turns.
  const between = 2 ** (Math.ceil(8 * Math.log2((2 * half) / (spokes - 3))) / 8);
  const direction = middle + axis;
  uniforms.polarPlace.value = [eye[0] - back * Math.cos(direction), eye[1] - back * Math.sin(direction), back, height];
  uniforms.polarSteps.value = [first, wide, first + wide * count, between];
  uniforms.polarTurn.value = between * Math.floor((direction - half) / between);
  polar.geometry.setDrawRange(0, 6 * (spokes - 1) * (isFar ? count + DOUBLED - 1 : count));
}
