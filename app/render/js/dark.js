// What is drawn otherwise where this browser shows the lab dark (display.js): labels, and colours of vertices.

const isDark = () => document.documentElement.classList.contains("springtide-dark");

// The sRGB colour `name` on a dark floor, in GLSL: `lifted` in app/render/colormap.py.
const glslLifted = (name) =>
  `mix(${name}, vec3(1.0), ${DARK_LIFT.toFixed(3)} * (1.0 - dot(${name}, vec3(${LUMA.join(", ")}))))`;

// viser draws all labels of a scene by a few materials, dark on light. Light on dark is the same text with two other
// colours; where a new viser has other lines, labels stay as they are.
const LABEL_COLOURS = [
  ["gl_FragColor = vec4(0.0, 0.0, 0.0, a);", "gl_FragColor = vec4(0.91, 0.93, 0.95, a);"],
  ["gl_FragColor = vec4(1.0, 1.0, 1.0, 0.85 * vAlpha);", "gl_FragColor = vec4(0.10, 0.12, 0.15, 0.85 * vAlpha);"],
];

function darkenLabels(scene) {
  const dark = isDark();
  scene.traverse((object) => {
    if (!object.material?.uniforms?.uLabelData) return;
    replaceShader(object.material, `springtide-label-${dark ? "dark" : "light"}`, (shader) => {
      if (!dark) return;
      for (const [light, other] of LABEL_COLOURS) shader.fragmentShader = shader.fragmentShader.replace(light, other);
    });
  });
}
