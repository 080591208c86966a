// Ragged smoke and flames: viser's splats with edges that noise erodes, the more the fainter a splat is.
//
// viser draws all splats of a scene as one mesh, made when the first come and made anew when their number changes. Of
// that material this file uses the name of one uniform, the varyings vRgba and vPosition, and the line that makes the
// opacity; where a new viser has other ones, splats are drawn as viser draws them.

const SMOKE_NOISE = `
  flat in float vSplat;
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
  // The share of a splat's opacity that is left at p, where a soft spot has the share soft.
  float eroded(float soft, vec2 p, float opacity) {
    float coarse = smokeNoise(2.2 * p + 40.0, vSplat), fine = smokeNoise(5.7 * p + 40.0, vSplat + 0.5);
    float limit = mix(0.42, 0.1, min(opacity / 0.5, 1.0));
    return smoothstep(limit, limit + 0.45, soft * (0.25 + coarse + 0.5 * fine));
  }`;
const SPLAT_OPACITY = "float B = exp(A) * vRgba.a;";

let splats = null; // the mesh

function dressSmoke(scene) {
  if (!splats || !splats.parent) {
    splats = scene.children.find((child) => child.material?.uniforms?.textureT_camera_groups) ?? null;
  }
  if (!splats) return;
  replaceShader(splats.material, keyWithDetails("springtide-smoke"), (shader) => {
    const { vertexShader, fragmentShader } = shader;
    const known = [SPLAT_OPACITY, "in vec2 vPosition;"].every((text) => fragmentShader.includes(text));
    if (QUALITY.details() === 0 || !known || !vertexShader.includes("vPosition = position.xy;")) return;
    shader.vertexShader = vertexShader
      .replace("out vec2 vPosition;", "out vec2 vPosition;\nflat out float vSplat;")
      .replace("vPosition = position.xy;", "vPosition = position.xy;\nvSplat = float(sortedIndex % 4096u);");
    shader.fragmentShader = fragmentShader
      .replace("precision mediump float;", "precision highp float;")
      .replace("in vec2 vPosition;", `in vec2 vPosition;\n${SMOKE_NOISE}`)
      .replace(SPLAT_OPACITY, "float B = eroded(exp(A), vPosition, vRgba.a) * vRgba.a;");
  });
}
