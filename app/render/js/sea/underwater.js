// View of water from below its surface, on a mesh with colours at its vertices (vertex_colors.js) that has a child
// "<name>/underwater": webs of light that waves focus, which fade with depth, and particles. The first vertex of that
// child is the uniform below, except for the time. Where the colour is redder than blue there is oil, and neither.

import { insertAfter, meshOf } from "../shading/shaders.js";

// The place [m] that is drawn, y up from the mean level of the sea.
/** @param {three.Shader} shader */
export function addPlace(shader) {
  insertAfter(shader, "vertexShader", "common", "varying vec3 vPlace;");
  insertAfter(shader, "fragmentShader", "common", "varying vec3 vPlace;");
  insertAfter(shader, "vertexShader", "begin_vertex", "vPlace = (modelMatrix * vec4(position, 1.0)).xyz;");
}

export const UNDERWATER_GLSL = `
  uniform vec3 underwater; // strength of the webs, size of their meshes [m], time [s]
  // Webs of light on a level plane, 0 to 1.
  float webs(vec2 p, float t) {
    float a = sin(3.1 * p.x + 1.2 * p.y + 1.6 * sin(2.3 * p.y - 1.1 * p.x + t));
    float b = sin(3.0 * p.y - 1.4 * p.x + 1.6 * sin(2.2 * p.x + 0.9 * p.y - 0.8 * t));
    vec2 ridge = 1.0 - abs(vec2(a, b));
    return max(ridge.x * ridge.x * ridge.x, ridge.y * ridge.y * ridge.y);
  }
  // Light on particles, one of many sizes in some cells of a grid.
  float particles(vec3 p) {
    vec3 i = floor(p), r = fract(sin(vec3(dot(i, vec3(12.9, 78.2, 37.7)), dot(i, vec3(39.3, 11.1, 83.2)),
                                          dot(i, vec3(73.2, 52.2, 9.1)))) * 43758.5);
    float size = 0.05 + 0.1 * r.z;
    return (1.0 - smoothstep(0.4 * size, size, distance(p - i, 0.3 + 0.4 * r))) * step(0.75, r.x);
  }
  vec3 seenUnderwater(vec3 color) {
    float water = smoothstep(0.0, 0.02, color.b - color.r), depth = max(-vPlace.y, 0.0) / underwater.y;
    // The sun's rays bring the webs down, and to the side.
    float light = underwater.x * exp(-0.8 * depth) * (2.6 * webs((vPlace.xz + 0.4 * vPlace.y) / underwater.y, underwater.z) - 0.5);
    return color * (1.0 + water * light) + water * 0.10 * exp(-0.5 * depth) * particles(9.0 * vPlace / underwater.y);
  }`;

/** @type {Map<string, three.Uniform<three.Vector3>>} */
const underwaters = new Map(); // name of the node -> its uniform, kept permanently like those of seas

export const WEB_STEP = 1 / 30; // [s] by which the webs advance with each frame of the water

// The uniform of a node with the child, otherwise null.
/** @param {string} base @param {three.Mesh} mesh */
export function underwaterOf(base, mesh) {
  const data = meshOf(`${base}/underwater`);
  if (!data) return null;
  const uniform = underwaters.get(base) ?? { value: mesh.position.clone() };
  const moving = meshOf("/water") || mesh; // a bed does not move
  underwaters.set(base, uniform);
  uniform.value.fromArray(data.geometry.attributes.position.array);
  uniform.value.z = WEB_STEP * moving.geometry.attributes.position.version;
  return uniform;
}
