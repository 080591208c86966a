// Open water around a scene seen through its surface, for a mesh of the surface with a child "<name>/open_water": sky, sea to
// the horizon and deep water behind everything; the surface, which mirrors more of the sky at grazing angles, with foam
// around a body; and on the bed (underwater.js) the shadow of that body, and dark water at its ends.
//
// The child's vertices are the uniform below, but with the body in the frame of the nodes, z up. The colours are those of
// the screen.

import { insertAfter, meshOf, replaceShader } from "../shading/shaders.js";
import { makeDome } from "./dome.js";
import { WEB_STEP } from "./underwater.js";

const OPEN_VERTEX = `
  varying vec3 vRay;
  void main() {
    gl_Position = vec4(position.xy, farDepth, 1.0);
    vec4 view = inverse(projectionMatrix) * vec4(position.xy, 0.5, 1.0);
    vRay = inverse(mat3(viewMatrix)) * (view.xyz / view.w);
  }`;
const MESHED = `
  // Half side of the surface, depth, size of the scene [m]; x, z, heading of the body; its half sides, corner.
  uniform vec3 openWater[3];
  // Where the surface is drawn by its mesh, 1, and where behind everything, 0; p from the middle [m].
  float meshed(vec2 p) { vec2 a = abs(p) / openWater[0].x; return 1.0 - smoothstep(0.7, 0.97, max(a.x, a.y)); }`;
const OPEN_GLSL = `
  ${MESHED}
  uniform float openTime;
  const vec3 DEEP = vec3(0.035, 0.165, 0.255), LIT = vec3(0.36, 0.62, 0.70), SUN = vec3(-0.89, 0.30, 0.34);
  // Noise of mean 1/2 between random numbers at whole places, and its two slopes.
  vec3 noiseAndSlope(vec2 p) {
    vec2 i = floor(p), f = p - i, u = f * f * (3.0 - 2.0 * f), du = 6.0 * f * (1.0 - f);
    const uvec2 FACTORS = uvec2(1597334673u, 3812015801u);
    uvec2 low = uvec2(ivec2(i)) * FACTORS, high = low + FACTORS;
    uvec4 corners = uvec4(low.x ^ low.y, high.x ^ low.y, low.x ^ high.y, high.x ^ high.y) * FACTORS.x;
    vec4 random = vec4(corners >> 8) / 16777216.0;
    vec2 along = mix(random.xz, random.yw, u.x), across = mix(random.xy, random.zw, u.y);
    return vec3(mix(along.x, along.y, u.y), du * vec2(across.y - across.x, along.y - along.x));
  }
  float noise(vec2 p) { return noiseAndSlope(p).x; }
  // The sky towards d without clouds, and how much of them there is by p, their place.
  vec3 clearSky(vec3 d) {
    float sun = max(dot(d, SUN), 0.0);
    vec3 color = mix(vec3(0.84, 0.89, 0.93), vec3(0.27, 0.48, 0.73), 1.0 - exp(-3.5 * max(d.y, 0.0)));
    return color + vec3(1.0, 0.86, 0.62) * (0.22 * pow(sun, 12.0) + pow(sun, 700.0));
  }
  vec2 cloudPlace(vec3 d) { return 1.3 * d.xz / (max(d.y, 0.0) + 0.12); }
  vec3 withClouds(vec3 color, vec3 d, float cloud) {
    return mix(color, vec3(0.96, 0.97, 0.98), 0.7 * smoothstep(0.48, 0.8, cloud) * smoothstep(0.0, 0.2, d.y));
  }
  vec3 skyColor(vec3 d) {
    vec2 p = cloudPlace(d);
    return withClouds(clearSky(d), d, 0.5 * noise(p) + 0.3 * noise(2.3 * p + 7.0) + 0.2 * noise(5.1 * p));
  }
  // In moving water, small clouds are not seen.
  vec3 mirroredSky(vec3 d) { return withClouds(clearSky(d), d, 0.6 * noise(cloudPlace(d)) + 0.2); }
  float mirrored(float cosine) { return 0.02 + 0.98 * pow(1.0 - clamp(cosine, 0.0, 1.0), 5.0); }
  // The normal of the surface with ripples, which are lost in the distance [m].
  vec3 rippled(vec3 normal, vec2 p, float away, float t) {
    vec2 q = 40.0 * p / openWater[0].z;
    // Turned against each other, so that their squares are not seen.
    const mat2 TURN = mat2(0.84, 0.54, -0.54, 0.84), TURN_2 = mat2(0.26, 0.97, -0.97, 0.26);
    vec2 slope = 0.8 * TURN * noiseAndSlope(0.7 * q * TURN + 0.7 * t).yz
      + 0.5 * TURN_2 * noiseAndSlope(1.3 * q * TURN_2 - vec2(0.7, -0.8) * t).yz;
    return normalize(normal + 0.22 * exp(-away / (2.5 * openWater[0].z)) * vec3(slope.x, 0.0, slope.y));
  }
  // Sky and sun in the surface, seen along d from above, and how much they hide of what is below it.
  vec4 seaColor(vec3 d, vec3 normal) {
    vec3 up = reflect(d, normal);
    up.y = abs(up.y);
    // Not quite edge on, or each crest would be a bright line.
    float sky = min(mirrored(max(dot(-d, normal), -0.6 * d.y)), 0.75);
    float glint = min(9.0 * sky * pow(max(dot(up, SUN), 0.0), 400.0), 0.9 - sky);
    return vec4((sky * mirroredSky(up) + glint * vec3(1.0, 0.96, 0.86)) / (sky + glint), sky + glint);
  }
  // Visible part along d of a colour under water, through the level sea where its mesh does not draw it.
  vec3 seenThrough(vec3 color, vec3 d) {
    if (cameraPosition.y < 0.0 || d.y >= 0.0) return color;
    float away = -cameraPosition.y / d.y, lost = smoothstep(6.0, 90.0, away / openWater[0].z);
    vec2 p = cameraPosition.xz + away * d.xz;
    float level = 1.0 - meshed(p);
    if (level + lost <= 0.0) return color;
    vec4 sea = seaColor(d, rippled(vec3(0, 1, 0), p, away, openTime));
    return mix(mix(color, sea.rgb, sea.a * level), clearSky(vec3(d.x, 0.02, d.z)), lost);
  }
  // Distance [m] of a level place to the outline of the body.
  float toBody(vec2 p) {
    vec2 r = p - openWater[1].xy;
    float c = cos(openWater[1].z), s = sin(openWater[1].z);
    r = abs(vec2(c * r.x + s * r.y, c * r.y - s * r.x)) - openWater[2].xy;
    return length(max(r, 0.0)) + min(max(r.x, r.y), 0.0) - openWater[2].z;
  }`;
const OPEN_FRAGMENT = `
  varying vec3 vRay;
  ${OPEN_GLSL}
  void main() {
    vec3 d = normalize(vRay), color = d.y < 0.0 ? seenThrough(DEEP, d) : skyColor(d);
    if (cameraPosition.y < 0.0) color = mix(DEEP, LIT, 0.8 * smoothstep(-0.15, 0.9, d.y));
    gl_FragColor = vec4(color, 1.0);
  }`;
// The place that is drawn of the surface, which is level where its mesh ends: a trough there would be a hole in the sea.
const OPEN_PLACE = `
  transformed.z *= meshed(position.xy);
  vPlace = (modelMatrix * vec4(transformed, 1.0)).xyz;`;
// At the end of the shader of the surface.
const OPEN_SURFACE = `
  vec3 d = normalize(vPlace - cameraPosition), upwards = inverseTransformDirection(normalize(vNormal), viewMatrix);
  upwards *= sign(upwards.y);
  float meshedShare = meshed(vPlace.xz), away = distance(vPlace, cameraPosition);
  // A slope that faces away, behind its crest or at the end of the mesh, mirrors as level water does.
  float faces = cameraPosition.y > vPlace.y ? smoothstep(0.0, 0.05, -dot(d, upwards)) : 1.0;
  vec3 n = rippled(normalize(mix(vec3(0, 1, 0), upwards, meshedShare * faces)), vPlace.xz, away, openTime);
  // From below: a window to the sky, and around it the deep mirrored.
  vec3 window = mix(LIT, vec3(0.93), 0.5), deep = mix(DEEP, LIT, 0.5 * exp(-away / openWater[0].z));
  vec4 sea = cameraPosition.y > vPlace.y ? seaColor(d, n) : vec4(mix(deep, window, smoothstep(0.45, 0.85, dot(d, n))), 0.85);
  float size = openWater[2].y + openWater[2].z, beside = abs(toBody(vPlace.xz)) / size;
  float bubbles = noise(14.0 * vPlace.xz / size + 0.3 * openTime) + 0.5 * exp(-24.0 * beside);
  float foam = exp(-8.0 * beside) * smoothstep(0.3, 0.8, bubbles);
  gl_FragColor = vec4(mix(sea.rgb, vec3(0.95, 0.97, 0.98), foam), max(sea.a, 0.9 * foam) * meshedShare);`;
// The same of the bed.
const OPEN_BED = `
  vec2 sunwards = 0.35 * SUN.xz * openWater[0].y; // light under water falls steeply
  float shade = 1.0 - smoothstep(-0.02 * openWater[0].y, 0.10 * openWater[0].y, toBody(vPlace.xz + sunwards));
  gl_FragColor.rgb *= 1.0 - 0.55 * shade;
  // Lost in the water with the distance, sooner here and later there.
  float off = length(vPlace.xz) / openWater[0].x + 0.22 * (noise(5.0 * vPlace.xz / openWater[0].x + 3.0) - 0.5);
  gl_FragColor.rgb = mix(gl_FragColor.rgb, DEEP, smoothstep(0.30, 0.94, off));
  gl_FragColor.rgb = seenThrough(gl_FragColor.rgb, normalize(vPlace - cameraPosition));`;

// Their shaders without three's lights, which would cost more than everything here: the mirroring surface does not use them, and
// on the level bed they are one factor.
export const OPEN_BASE = {
  surface: `
  #include <common>
  varying vec3 vNormal;
  void main() {
    #include <dithering_fragment>
  }`,
  bed: `
  #include <common>
  // Light over the colour of the bed, and what it mirrors: about what three's lights and the sky come to.
  const vec3 BED_LIGHT = vec3(2.25, 2.5, 2.7);
  const float BED_GLEAM = 0.045;
  void main() {
    vec4 diffuseColor = vec4(1.0);
    #include <color_fragment>
    gl_FragColor = vec4(BED_LIGHT * diffuseColor.rgb + BED_GLEAM, 1.0);
    #include <tonemapping_fragment>
    #include <colorspace_fragment>
    #include <dithering_fragment>
  }`,
};

/** @type {three.Uniform<three.Vector3[] | null>} */
const openWaterUniform = { value: null };
const openUniforms = { openWater: openWaterUniform, openTime: { value: 0 }, farDepth: { value: 1 } };
/** @type {{ mesh: three.Mesh, dome: three.Mesh } | null} */
let openDome = null; // { mesh of the surface, dome }

// Role in open water of a mesh with colours at its vertices: "surface", "bed" or "".
/** @param {string} base @param {object | null} underwater */
export function openPartOf(base, underwater) {
  if (meshOf(`${base}/open_water`)) return "surface";
  return underwater && meshOf("/water/open_water") ? "bed" : "";
}

/** @param {three.Shader} shader @param {"surface" | "bed"} part */
export function addOpenWater(shader, part) {
  Object.assign(shader.uniforms, openUniforms);
  insertAfter(shader, "fragmentShader", "common", OPEN_GLSL);
  if (part === "surface") {
    insertAfter(shader, "vertexShader", "common", `varying vec3 vPlace;${MESHED}`);
    insertAfter(shader, "fragmentShader", "common", "varying vec3 vPlace;");
    insertAfter(shader, "vertexShader", "begin_vertex", OPEN_PLACE);
  }
  insertAfter(shader, "fragmentShader", "dithering_fragment", part === "bed" ? OPEN_BED : OPEN_SURFACE);
}

function removeOpenDome() {
  openDome?.dome.removeFromParent();
  openDome?.dome.geometry.dispose();
  openDome?.dome.material.dispose();
  openDome = null;
}

/** @type {NodeShader} */
export const openWater = {
  suffix: "/open_water",
  removeUnused() {
    if (openDome && meshOf("/water") !== openDome.mesh) removeOpenDome();
  },
  update({ mesh, data, renderer }) {
    const numbers = data.geometry.attributes.position.array;
    const vectors = (openUniforms.openWater.value ??= [0, 1, 2].map(() => mesh.position.clone()));
    vectors.forEach((vector, k) => vector.fromArray(numbers, 3 * k));
    const [x, y, heading] = vectors[1].toArray(), { position } = mesh;
    const at = mesh.localToWorld(position.clone().set(x, y, 0));
    const ahead = mesh.localToWorld(position.clone().set(x + Math.cos(heading), y + Math.sin(heading), 0));
    vectors[1].set(at.x, at.z, Math.atan2(ahead.z - at.z, ahead.x - at.x));
    openUniforms.openTime.value = WEB_STEP * mesh.geometry.attributes.position.version;
    openUniforms.farDepth.value = renderer.state.buffers.depth.getReversed() ? 0 : 1;
    if (openDome?.mesh !== mesh) {
      if (openDome) removeOpenDome();
      openDome = { mesh, dome: makeDome({ geometry: mesh.geometry, mesh }) };
    }
    replaceShader(openDome.dome.material, "springtide-open-dome", (shader) => {
      Object.assign(shader.uniforms, openUniforms);
      shader.vertexShader = `uniform float farDepth;\n${OPEN_VERTEX}`;
      shader.fragmentShader = OPEN_FRAGMENT;
    });
    return null; // the surface gets its colours from another child
  },
};
