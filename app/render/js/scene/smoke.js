// Smoke and flames with rough edges: viser's splats, eroded by noise of two sizes, and smoke with a sunny side.
//
// viser draws all splats of a scene as one mesh, which it replaces when their number changes. Of its material this file uses
// the names of some uniforms and variables, the varyings vRgba and vPosition, and the lines that compute place, opacity and
// colour. If a new viser differs, splats are drawn as viser draws them.

import { uniformsByName } from "../sea/water.js";
import { keyWithDetails, QUALITY } from "../shading/quality.js";
import { replaceShader } from "../shading/shaders.js";

const SMOKE_NOISE = `
  flat in float vSplat;
  flat in vec3 vSun; // towards the sun, in the frame of vPosition and towards the eye
  float smokeHash(vec3 p) {
    uvec3 q = uvec3(ivec3(p)) * uvec3(1597334673u, 3812015801u, 2798796415u);
    return float(((q.x ^ q.y ^ q.z) * 1597334673u) >> 8) / 16777216.0;
  }
  float smokeNoise(vec2 p, float which) {
    vec2 i = floor(p), f = p - i, u = f * f * (3.0 - 2.0 * f);
    float low = mix(smokeHash(vec3(i, which)), smokeHash(vec3(i + vec2(1.0, 0.0), which)), u.x);
    float high = mix(smokeHash(vec3(i + vec2(0.0, 1.0), which)), smokeHash(vec3(i + vec2(1.0, 1.0), which)), u.x);
    return mix(low, high, u.y);
  }
  // Noise of two sizes, of mean 1, by which a splat is denser here than there.
  float billows(vec2 p) {
    return 0.2 + 1.1 * smokeNoise(1.9 * p + 40.0, vSplat) + 0.5 * smokeNoise(5.3 * p + 40.0, vSplat + 0.5);
  }
  // The share of a splat's opacity that is left where a soft spot has the share soft. The thinner the smoke, the more
  // of it is gone, and the denser is the rest.
  float eroded(float soft, float dense, float opacity) {
    float limit = mix(0.3, 0.1, min(opacity / 0.5, 1.0));
    return (1.0 + limit) * smoothstep(limit, limit + 0.45, soft * dense) * mix(1.3, 1.0, min(opacity / 0.5, 1.0));
  }
  // Smoke is lit as a ball with bumps: brighter towards the sun, the more where it is dense. Flames shine by themselves.
  vec3 litSmoke(vec3 rgb, vec2 p, float dense) {
    float shines = smoothstep(0.1, 0.3, rgb.r - rgb.b);
    vec3 n = vec3(p, sqrt(max(1.6 - dot(p, p), 0.0))) / 1.265;
    float lit = 1.0 + 0.5 * dot(n, vSun) + 0.5 * (dense - 1.0);
    return rgb * mix(clamp(lit, 0.35, 1.9), 1.0, shines);
  }`;
const SPLAT_OPACITY = "float B = exp(A) * vRgba.a;";
const SPLAT_COLOUR = "gl_FragColor = vec4(vRgba.rgb, B);";
// viser draws each splat as a square out to where it is 1/50 as dense, and drops what is less than 1/100 opaque; a
// smaller square holds all of that. Eroded, it ends where the densest smoke does (1.8 exp(-r r) < 0.1), at r = 1.7.
const SPLAT_PLACE = "vPosition = position.xy;", SPLAT_SIDES = ["position.x * v1", "position.y * v2"];
const SMALLER = { plain: "0.5 * sqrt(clamp(log(100.0 * vRgba.a), 0.0, 4.0))", eroded: "0.85" }; // factors on its half side of 2
const SPLAT_AXES = ["vec2 diagonalVector", "mat4 T_camera_group"]; // the first axis on the screen; from sea to camera

/** @type {three.Mesh | null} */
let splats = null; // the mesh

// The text of their vertex shader, with squares scaled by a factor, and further outputs for the fragments.
/** @param {string} vertexShader @param {string} factor @param {string} more */
function smallerSplats(vertexShader, factor, more = "") {
  for (const side of SPLAT_SIDES) vertexShader = vertexShader.replace(side, side.replace("position", "vPosition"));
  return vertexShader.replace(SPLAT_PLACE, `vPosition = position.xy * ${factor};${more}`);
}

/** @param {three.Scene} scene */
export function dressSmoke(scene) {
  if (!splats || !splats.parent) {
    splats = scene.children.find((child) => child.material?.uniforms?.textureT_camera_groups) ?? null;
  }
  const [sea] = uniformsByName.values();
  if (!splats || !sea) return;
  replaceShader(splats.material, keyWithDetails("springtide-smoke"), (shader) => {
    const { vertexShader, fragmentShader } = shader;
    const known = [SPLAT_OPACITY, SPLAT_COLOUR, "in vec2 vPosition;"].every((text) => fragmentShader.includes(text))
      && [SPLAT_PLACE, ...SPLAT_SIDES, ...SPLAT_AXES].every((text) => vertexShader.includes(text));
    if (!known) return;
    if (QUALITY.details() === 0) return void (shader.vertexShader = smallerSplats(vertexShader, SMALLER.plain));
    shader.uniforms.sunDirection = sea.sunDirection;
    shader.vertexShader = smallerSplats(vertexShader, SMALLER.eroded, `
        vSplat = float(sortedIndex % 4096u);
        vec3 toSun = mat3(T_camera_group) * sunDirection;
        vSun = vec3(dot(toSun.xy, diagonalVector), dot(toSun.xy, vec2(diagonalVector.y, -diagonalVector.x)), toSun.z);`)
      .replace("out vec2 vPosition;", "out vec2 vPosition;\nflat out float vSplat;\nflat out vec3 vSun;\nuniform vec3 sunDirection;");
    shader.fragmentShader = fragmentShader
      .replace("precision mediump float;", "precision highp float;")
      .replace("in vec2 vPosition;", `in vec2 vPosition;\n${SMOKE_NOISE}`)
      .replace(SPLAT_OPACITY, "float dense = billows(vPosition), B = min(eroded(exp(A), dense, vRgba.a) * vRgba.a, 1.0);")
      .replace(SPLAT_COLOUR, "gl_FragColor = vec4(litSmoke(vRgba.rgb, vPosition, dense), B);");
  });
}
