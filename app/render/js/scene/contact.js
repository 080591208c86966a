// The contact shadow of "<name>" if there is a "<name>/contact_shadow": a copy of its mesh, flattened on the floor and dark where
// the mesh is near it. The floor's own shadow is equally dark at every height.

import { startedViewer } from "../core/viewer.js";
import { meshOf, replaceShader } from "../shading/shaders.js";

const CONTACT_VERTEX = `
  varying float vDark;
  const float CONTACT_HEIGHT = 0.09; // [m] over the floor at which 1/e of the darkness is left
  void main() {
    vec3 place = (modelMatrix * vec4(position, 1.0)).xyz, outward = normalize(mat3(modelMatrix) * normal);
    float height = max(place.y, 0.0);
    place.xz += (0.015 + 0.5 * height) * outward.xz; // the wider the higher
    vDark = 0.75 * exp(-height / CONTACT_HEIGHT) * smoothstep(0.0, 0.7, outward.y);
    gl_Position = projectionMatrix * viewMatrix * vec4(place.x, 0.002, place.z, 1.0);
  }`;
const CONTACT_FRAGMENT = `
  varying float vDark;
  void main() { gl_FragColor = vec4(0.0, 0.0, 0.0, vDark); }`;

/** @type {Map<string, { mesh: three.Mesh, shadow: three.Mesh }>} */
const contacts = new Map(); // name of the node -> { mesh, shadow }: viser's mesh and its copy on the floor

/** @param {string} base @param {three.Mesh} shadow */
function removeContact(base, shadow) {
  shadow.removeFromParent();
  shadow.material.dispose(); // the geometry is viser's
  contacts.delete(base);
}

/** @type {NodeShader} */
export const contact = {
  suffix: "/contact_shadow",
  removeUnused() {
    for (const [base, { mesh, shadow }] of contacts) if (meshOf(base) !== mesh) removeContact(base, shadow);
  },
  update({ base, mesh }) {
    let known = contacts.get(base);
    if (known?.mesh !== mesh) {
      if (known) removeContact(base, known.shadow);
      const shadow = mesh.clone(false);
      shadow.material = new mesh.material.constructor();
      shadow.material.transparent = true;
      shadow.material.depthWrite = shadow.castShadow = shadow.receiveShadow = shadow.frustumCulled = false;
      shadow.raycast = () => {};
      mesh.parent?.add(shadow);
      known = { mesh, shadow };
      contacts.set(base, known);
    }
    const { shadow } = known;
    shadow.geometry = mesh.geometry;
    shadow.visible = Boolean(startedViewer().nodeRefFromName["/floor"]?.visible);
    replaceShader(shadow.material, "springtide-contact", (shader) => {
      shader.vertexShader = CONTACT_VERTEX;
      shader.fragmentShader = CONTACT_FRAGMENT;
    });
    return null; // the mesh itself keeps its shader
  },
};
