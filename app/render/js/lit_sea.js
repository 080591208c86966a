// The light of a sea, found once for each pixel of the canvas.
//
// A graphics processor shades at least 2 x 2 pixels for each triangle, and also waves that nearer ones hide later. So the
// polar grid first writes which place of the sea each pixel shows, one triangle finds the light of these places, and the
// grid is drawn once more with these colours, with all samples of the canvas along its edges. This needs the table of the
// sky (sky_table.js), which shows that the browser draws into floats; elsewhere the grid itself is shaded.

const FLOAT = 1015, NEAREST = 1003; // three's constants

const PLACES_FRAGMENT = `
  ${WATER_PLACE}
  layout(location = 1) out highp vec4 restAndSteps;
  void main() {
    cutOut();
    vec3 at = seaPlace();
    gl_FragColor = vec4(at, 1.0);
    restAndSteps = vec4(vRest, stepsAt(at));
  }`;
const LIGHT_FRAGMENT = `
  #define STANDARD
  uniform mat4 toSea;
  uniform highp sampler2D seaPlaces, seaRest;
  ${WATER_LIGHT}
  void main() {
    vec4 at = texelFetch(seaPlaces, ivec2(gl_FragCoord.xy), 0), rest = texelFetch(seaRest, ivec2(gl_FragCoord.xy), 0);
    if (at.w == 0.0) discard;
    gl_FragColor = vec4(shadeSea(at.xyz, rest.xy, rest.zw), 1.0);
  }`;
// A pixel on the edge of a wave has the light of what its middle shows, which may be another wave or the sky: the edge
// takes the light of the neighbour that shows the same wave.
const LIT_FRAGMENT = `
  ${WATER_PLACE}
  ${WATER_GLSL.noise}
  ${WATER_GLSL.waves}
  ${WIRE_GLSL}
  uniform highp sampler2D seaPlaces;
  uniform highp sampler2D seaLight;
  const float SAME_WAVE = 0.03; // difference between distances from the eye, over the distance
  void main() {
    cutOut();
    vec3 eye = eyePlace();
    float far = distance(seaPlace(), eye), least = 1e9;
    ivec2 pixel = ivec2(gl_FragCoord.xy), last = textureSize(seaPlaces, 0) - 1, found = pixel;
    for (int k = 0; k < 9 && least > SAME_WAVE; k++) {
      // The pixel, those below, beside and above it, and the corners.
      ivec2 near = clamp(pixel + (k == 0 ? ivec2(0) : k < 5 ? ivec2(k % 2 * (k - 2), (k + 1) % 2 * (k - 3))
                                                            : ivec2(k % 2 * 2 - 1, k < 7 ? -1 : 1)), ivec2(0), last);
      vec4 place = texelFetch(seaPlaces, near, 0);
      float off = place.w == 0.0 ? 1e8 : abs(distance(place.xyz, eye) / far - 1.0);
      if (off < least) { least = off; found = near; }
    }
    if (least > 1e7) discard;
    gl_FragColor = vec4(texelFetch(seaLight, found, 0).rgb, 1.0);
    #ifdef WIRE
      gl_FragColor.rgb = mix(gl_FragColor.rgb, wireColor, wireAt(vRest));
    #endif
    #include <tonemapping_fragment>
    #include <colorspace_fragment>
  }`;

// What this needs of a sea: the grid with a material of its own, the triangle, and what they are drawn into.
function makeLit(sea) {
  const grid = new sea.mesh.constructor(sea.polar.geometry, new sea.mesh.material.constructor());
  grid.frustumCulled = false;
  const triangle = makeDome(sea);
  triangle.removeFromParent();
  triangle.material.depthTest = false;
  for (const { material } of [grid, triangle]) material.fog = material.toneMapped = false;
  return { grid, triangle, places: null, light: null, size: "" };
}

function disposeLit(sea) {
  const { lit } = sea;
  if (!lit) return;
  for (const one of [lit.grid.material, lit.triangle.geometry, lit.triangle.material, lit.places, lit.light]) one?.dispose();
  sea.lit = null;
}

// Find the light of every pixel of the sea; false where this browser cannot.
function lightSea(base, sea, renderer, scene, camera, defines, key) {
  const { uniforms } = sea;
  if (!uniforms.skyTable.value) return false;
  const lit = (sea.lit ??= makeLit(sea)), before = renderer.getRenderTarget(), gl = renderer.getContext();
  if (refused.has(lit.grid.material) || refused.has(lit.triangle.material)) return false;
  const [width, height] = before ? [before.width, before.height] : [gl.drawingBufferWidth, gl.drawingBufferHeight];
  if (lit.size !== [width, height].join()) {
    lit.size = [width, height].join();
    lit.places?.dispose();
    lit.light?.dispose();
    const Target = skyTables.get(base).target.constructor, how = { format: RGBA, minFilter: NEAREST, magFilter: NEAREST };
    lit.places = new Target(width, height, { ...how, type: FLOAT, count: 2 });
    lit.light = new Target(width, height, { ...how, type: HALF_FLOAT, depthBuffer: false });
    [uniforms.seaPlaces.value, uniforms.seaRest.value] = lit.places.textures;
    uniforms.seaLight.value = lit.light.texture;
  }
  lit.grid.geometry = sea.polar.geometry;
  lit.grid.material.side = sea.mesh.material.side;
  replaceShader(lit.grid.material, `${key} places`, (shader) => {
    Object.assign(shader.uniforms, uniforms);
    shader.vertexShader = defines + WATER_VERTEX;
    shader.fragmentShader = defines + PLACES_FRAGMENT;
  });
  litBy(lit.triangle.material, scene);
  replaceShader(lit.triangle.material, keyWithDetails(`${key} light`), (shader) => {
    Object.assign(shader.uniforms, uniforms);
    shader.vertexShader = TARGET_VERTEX;
    shader.fragmentShader = withSky(defines + LIGHT_FRAGMENT, uniforms);
  });
  const alpha = renderer.getClearAlpha();
  renderer.setClearAlpha(0);
  for (const [target, drawn] of [[lit.places, lit.grid], [lit.light, lit.triangle]]) {
    renderer.setRenderTarget(target);
    renderer.clear();
    renderer.render(drawn, camera);
  }
  renderer.setClearAlpha(alpha);
  renderer.setRenderTarget(before);
  return isLinked(renderer, lit.grid.material) && isLinked(renderer, lit.triangle.material);
}
