// The shader of rain and of spray, for "<name>" where there is a "<name>/rain_material".
//
// The mesh has four vertices for each drop: the tail of its streak, then three around its head. The vertices of
// "<name>/rain_material" are the uniforms, in the order of RAIN_UNIFORMS (app/render/material.py). With a box (streak.z)
// the drops are around the camera: the shader alone places them, by their number and the time. Rain falls there. Spray (a
// life above 0) leaves the water where foam is fresh, and the wind takes it along; each drop is a soft patch of mist.

import { keyWithDetails, QUALITY } from "../shading/quality.js";
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
  uniform vec3 spray; // life of a drop [s] (0: rain), speed with which it leaves the water [m/s], least foam that throws it
  varying vec3 vSea;
  varying float vBody;
  varying vec2 vPatch; // place in a patch of spray, whose edge is at 1; 0 in rain
  ${WATER_GLSL.noise}
  ${WATER_GLSL.waves}
  const int SPRAY_TRIES = 6; // places at random: a drop of spray takes the one with the freshest foam
  const float SPRAY_AHEAD = 0.45; // distance from the eye to the middle of the box, over the side of the box
  const float SPRAY_LAG = 0.4; // [s] in which it reaches the speed of the wind
  const float SPRAY_STRETCH = 2.2; // length of a patch along its way over its width
  // A drop of spray. It has another place in each of its lives.
  void placeSpray(int corner) {
    float number = float(gl_VertexID / 4);
    vec2 a = hash2(vec2(number, 1.0)), b = hash2(vec2(number, 2.0));
    float turn = seaState.x / spray.x + a.x, life = floor(turn), age = turn - life, time = age * spray.x;
    vec3 eye = (toSea * vec4(cameraPosition, 1.0)).xyz;
    vec3 ahead = mat3(toSea) * -vec3(viewMatrix[0].z, viewMatrix[1].z, viewMatrix[2].z);
    vec2 middle = eye.xy + SPRAY_AHEAD * streak.z * normalize(ahead.xy + 1e-6), rest = middle;
    float foam = 0.0;
    for (int k = 0; k < SPRAY_TRIES; k++) {
      vec2 from = hash2(vec2(number, float(SPRAY_TRIES) * life + float(k + 3))) * streak.z - middle;
      vec2 place = middle + mod(from + 0.5 * streak.z, streak.z) - 0.5 * streak.z;
      float white = wavesAt(waveSlopes, place, pieceShare(place, eye), 0.0, true).z;
      if (white > foam) {
        foam = white;
        rest = place;
      }
    }
    float fresh = smoothstep(0.0, 0.3, (foam - spray.z) / (1.0 - spray.z));
    if (fresh <= 0.0) {
      gl_Position = vec4(0.0, 0.0, 2.0, 1.0); // outside of the view
      return;
    }
    float lag = SPRAY_LAG * (1.0 - exp(-time / SPRAY_LAG)), up = spray.y * mix(0.3, 1.0, b.x);
    vec3 water = vec3(rest, 0.0) + wavesAt(wavePlaces, rest, pieceShare(rest, eye), 0.0, false).xyz;
    float radius = streak.x * mix(0.1, 1.0, b.y * b.y * b.y) * mix(0.4, 1.0, age);
    vec3 at = water + vec3(dropMotion.xy * (time - lag), 0.5 * radius + up * time * (1.0 - age));
    float far = distance(at, eye);
    float wide = max(radius, streak.y * far), angle = 2.0944 * float(corner - 1);
    vec3 toDrop = (at - eye) / far, across = normalize(cross(vec3(dropMotion.xy, 0.0), toDrop)), along = cross(toDrop, across);
    vSea = at;
    vPatch = corner > 0 ? 2.0 * vec2(cos(angle), sin(angle)) : vec2(0.0); // the circle in the triangle
    vSea += wide * (SPRAY_STRETCH * vPatch.x * along + vPatch.y * across);
    gl_Position = projectionMatrix * viewMatrix * fromSea * vec4(vSea, 1.0);
    float thin = mix(1.0, 0.4, b.y) * radius / wide; // the wider a patch, the thinner
    vBody = fresh * thin * smoothstep(0.0, 0.1, age) * (1.0 - smoothstep(0.3, 1.0, age));
  }
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
    vPatch = vec2(0.0);
    if (spray.x > 0.0) {
      placeSpray(corner);
      return;
    }
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
  uniform vec3 spray;
  uniform vec3 rain; // opacity, exposure, distance [m] within which streaks fade, as they do before a lens
  ${WATER_GLSL.noise}
  ${WATER_GLSL.sky}
  varying vec3 vSea;
  varying float vBody;
  varying vec2 vPatch;
  void main() {
    vec3 from = vSea - (toSea * vec4(cameraPosition, 1.0)).xyz;
    float far = length(from);
    // A drop shows the sky upside down, and lets most of the light behind it pass.
    vec3 light = 0.6 * ambientLight() + 0.5 * horizon(from / far);
    if (spray.x > 0.0) { // as white as foam
      vec3 around = meanHorizon();
      light = mix(0.65 * behindRain(ambientLight(), vec3(0.0, 0.0, 1.0)) + 0.35 * around, around, clouds.x) + 0.16 * sunLight;
    }
    light += sunLight * lens.z * 0.3 * pow(max(dot(from / far, sunDirection), 0.0), 12.0);
    float inside = max(1.0 - dot(vPatch, vPatch), 0.0);
    float alpha = rain.x * vBody * inside * inside * smoothstep(rain.z, 4.0 * rain.z, far);
    if (spray.x > 0.0) alpha *= exp(-pow(far / lens.x, 1.5));
    gl_FragColor = vec4(light * rain.y, alpha);
    #include <tonemapping_fragment>
    #include <colorspace_fragment>
  }`;

const SPRAY_DRAWN = [0.3, 0.6, 1]; // share of the drops of spray, by level of detail

// Spray is ornament: fewer drops on slow pages, and none for people who want less motion.
/** @param {three.Mesh} mesh */
function dressSpray({ geometry, material }) {
  material.depthWrite = false; // patches do not hide each other
  const drops = (geometry.index?.count ?? 0) / 9, isStill = matchMedia("(prefers-reduced-motion: reduce)").matches;
  geometry.drawRange.count = isStill ? 0 : 9 * Math.round(SPRAY_DRAWN[QUALITY.details()] * drops);
}

/** @type {NodeShader} */
export const rain = {
  suffix: "/rain_material",
  update({ base, mesh, data }) {
    const [sea] = seas.values(); // its sky lights the drops
    if (!sea) return null;
    mesh.frustumCulled = false; // the drops surround the camera, wherever it is
    const uniforms = (mesh.userData.rain ??= makeUniforms(mesh, RAIN_UNIFORMS));
    readUniforms(uniforms, RAIN_UNIFORMS, data);
    if (uniforms.spray.value.x > 0) dressSpray(mesh);
    const edit = (/** @type {three.Shader} */ shader) => {
      Object.assign(shader.uniforms, sea.uniforms, uniforms);
      shader.vertexShader = RAIN_VERTEX;
      shader.fragmentShader = withSky(RAIN_FRAGMENT, sea.uniforms);
    };
    return replaceShader(mesh.material, keyWithDetails(`springtide-rain${base}`), edit) ? mesh.material : null;
  },
};
