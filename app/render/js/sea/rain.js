// The shader of rain, for "<name>" where there is a "<name>/rain_material".
//
// The mesh has four vertices for each drop: the tail of its streak, then three around its head. The vertices of
// "<name>/rain_material" are the uniforms, in the order of RAIN_UNIFORMS (app/render/material.py). With a box (streak.z)
// the drops fall around the camera: the shader alone places them, by their number and the time.

import { keyWithDetails } from "../shading/quality.js";
import { replaceShader } from "../shading/shaders.js";
import { RAIN_UNIFORMS } from "../shared.js";
import { withSky } from "./sky_table.js";
import { makeUniforms, readUniforms, seas } from "./water.js";
import { WATER_GLSL } from "./water_shader.js";

const RAIN_VERTEX = `
  uniform mat4 toSea;
  uniform mat4 fromSea;
  uniform vec3 seaState;
  uniform vec3 streak; // half width of a head [m]; smallest half width [rad], below it is paler; side of the box [m] or 0
  uniform vec3 dropSizes; // slope parameter of the sizes [1/mm], factor on the speed of fall, time of exposure [s]
  uniform vec3 dropMotion; // wind x, y [m/s], unused
  varying vec3 vSea;
  varying float vBody;
  ${WATER_GLSL.noise}
  // A drop of the box: diameter [mm] by Marshall and Palmer, speed [m/s] by Atlas (sim/particles/rain.py).
  void placeDrop(int corner) {
    float number = float(gl_VertexID / 4);
    vec2 a = hash2(vec2(number, 1.0)), b = hash2(vec2(number, 2.0));
    float diameter = 0.5 - log(1.0 - b.y * (1.0 - exp(-5.5 * dropSizes.x))) / dropSizes.x;
    float speed = dropSizes.y * clamp(9.65 - 10.3 * exp(-0.6 * diameter), 0.0, 9.17);
    vec3 velocity = vec3(dropMotion.xy, -speed);
    vec3 eye = (toSea * vec4(cameraPosition, 1.0)).xyz;
    vec3 from = vec3(a, b.x) * streak.z + velocity * seaState.x - eye;
    vec3 at = eye + mod(from + 0.5 * streak.z, streak.z) - 0.5 * streak.z;
    float wide = max(streak.x * diameter, streak.y * distance(at, eye)), angle = 2.0944 * float(corner - 1);
    vec3 across = normalize(cross(velocity, at - eye));
    vec3 off = corner == 0 ? -dropSizes.z * velocity : wide * (cos(angle) * across + vec3(0.0, 0.0, sin(angle)));
    vSea = at + off;
    gl_Position = projectionMatrix * viewMatrix * fromSea * vec4(vSea, 1.0);
    vBody = (corner == 0 ? 0.1 : 1.0) * pow(streak.x * diameter / wide, 0.5);
  }
  void main() {
    int corner = gl_VertexID % 4;
    if (streak.z > 0.0) {
      placeDrop(corner);
      return;
    }
    #include <begin_vertex>
    float far = length((modelViewMatrix * vec4(position, 1.0)).xyz);
    float wide = max(streak.x, streak.y * far);
    float angle = 2.0944 * float(corner - 1);
    if (corner > 0) transformed += (wide - streak.x) * vec3(cos(angle), sin(angle), 0.0);
    #include <project_vertex>
    vSea = (toSea * modelMatrix * vec4(position, 1.0)).xyz;
    vBody = (corner == 0 ? 0.1 : 1.0) * pow(streak.x / wide, 0.7);
  }`;
const RAIN_FRAGMENT = `
  #define STANDARD
  uniform mat4 toSea;
  uniform vec3 rain; // opacity, exposure, distance [m] within which streaks fade, as they do before a lens
  ${WATER_GLSL.noise}
  ${WATER_GLSL.sky}
  varying vec3 vSea;
  varying float vBody;
  void main() {
    vec3 from = vSea - (toSea * vec4(cameraPosition, 1.0)).xyz;
    float far = length(from);
    // A drop shows the sky upside down, and lets most of the light behind it pass.
    vec3 light = 0.6 * ambientLight() + 0.5 * horizon(from / far);
    light += sunLight * lens.z * 0.3 * pow(max(dot(from / far, sunDirection), 0.0), 12.0);
    float alpha = rain.x * vBody * smoothstep(rain.z, 4.0 * rain.z, far);
    gl_FragColor = vec4(light * rain.y, alpha);
    #include <tonemapping_fragment>
    #include <colorspace_fragment>
  }`;

/** @type {NodeShader} */
export const rain = {
  suffix: "/rain_material",
  update({ base, mesh, data }) {
    const [sea] = seas.values(); // its sky lights the drops
    if (!sea) return null;
    mesh.frustumCulled = false; // the drops surround the camera, wherever it is
    const uniforms = (mesh.userData.rain ??= makeUniforms(mesh, RAIN_UNIFORMS));
    readUniforms(uniforms, RAIN_UNIFORMS, data);
    const edit = (/** @type {three.Shader} */ shader) => {
      Object.assign(shader.uniforms, sea.uniforms, uniforms);
      shader.vertexShader = RAIN_VERTEX;
      shader.fragmentShader = withSky(RAIN_FRAGMENT, sea.uniforms);
    };
    return replaceShader(mesh.material, keyWithDetails(`springtide-rain${base}`), edit) ? mesh.material : null;
  },
};
