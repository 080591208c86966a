// The shader of rain, for "<name>" where there is a "<name>/rain_material".
//
// The mesh has four vertices for each drop: the tail of its streak, then three around its head. The vertices of
// "<name>/rain_material" are the uniforms, in the order of RAIN_UNIFORMS (app/render/material.py).

const RAIN_VERTEX = `
  uniform mat4 toSea;
  uniform vec3 streak; // half the width of a head [m]; smallest half width [rad], below which it is drawn paler instead
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

shaders.push({
  suffix: "/rain_material",
  update({ base, mesh, data }) {
    const [sea] = seas.values(); // its sky lights the drops
    if (!sea) return null;
    const uniforms = (mesh.userData.rain ??= makeUniforms(mesh, RAIN_UNIFORMS));
    readUniforms(uniforms, RAIN_UNIFORMS, data);
    const edit = (shader) => {
      Object.assign(shader.uniforms, sea.uniforms, uniforms);
      shader.vertexShader = RAIN_VERTEX;
      shader.fragmentShader = RAIN_FRAGMENT;
    };
    return replaceShader(mesh.material, `springtide-rain${base}`, edit) ? mesh.material : null;
  },
});
