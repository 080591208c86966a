// How rain looks: the recipe that patch.js applies to "<name>" where there is a "<name>/rain_look".
//
// The mesh has four vertices a drop: the tail of its streak, then three about its head. "<name>/rain_look" is two
// vertices: opacity, exposure, the distance [m] within which streaks fade, as a lens does with what is too near; half
// the width of a head [m], and the least angle [rad] it is drawn at, paler as it is wider.

const RAIN_VERTEX = `
  uniform mat4 toSea;
  uniform vec3 streak; // half width [m], least half width [rad]
  varying vec3 vSea;
  varying float vBody;
  #include <common>
  void main() {
    #include <begin_vertex>
    int corner = gl_VertexID % 4;
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
  uniform vec3 rain; // opacity, exposure, distance within which streaks fade [m]
  ${WATER_GLSL.noise}
  ${WATER_GLSL.sky}
  varying vec3 vSea;
  varying float vBody;
  void main() {
    vec3 from = vSea - (toSea * vec4(cameraPosition, 1.0)).xyz;
    float far = length(from);
    // A drop shows the sky upside down, and passes most of what comes from behind it.
    vec3 light = 0.6 * ambientLight() + 0.5 * horizon(from / far);
    light += sunColor * place.y * 0.3 * pow(max(dot(from / far, sunDirection), 0.0), 12.0);
    float alpha = rain.x * vBody * smoothstep(rain.z, 4.0 * rain.z, far);
    gl_FragColor = vec4(light * rain.y, alpha);
    #include <tonemapping_fragment>
    #include <colorspace_fragment>
  }`;

recipes.push({
  suffix: "/rain_look",
  frame({ base, mesh, channel }) {
    const [sea] = seas.values(); // its sky lights the drops
    if (!sea) return null;
    const look = channel.geometry.attributes.position.array;
    const vector = () => ({ value: mesh.position.clone() });
    const uniforms = (mesh.userData.rain ??= { rain: vector(), streak: vector() });
    uniforms.rain.value.fromArray(look, 0);
    uniforms.streak.value.fromArray(look, 3);
    const edit = (shader) => {
      Object.assign(shader.uniforms, sea.uniforms, uniforms);
      shader.vertexShader = RAIN_VERTEX;
      shader.fragmentShader = RAIN_FRAGMENT;
    };
    return dress(mesh.material, `springtide-rain${base}`, edit) ? mesh.material : null;
  },
});
