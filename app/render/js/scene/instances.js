// Restores the instances of a mesh after a lost graphics context. viser's class for them makes its own buffer of indices and
// remembers programs of materials, whose loss three does not notice. If a new viser has other names, nothing is done.

import { contextNumber } from "../shading/context.js";

/** @type {{ renderer: three.Renderer | null, context: number }} */
let last = { renderer: null, context: 0 };

/** @param {three.Renderer} renderer @param {three.Scene} scene */
export function renewInstances(renderer, scene) {
  const now = { renderer, context: contextNumber() }, isRestored = last.renderer === renderer && last.context !== now.context;
  last = now;
  if (!isRestored) return;
  const gl = renderer.getContext();
  scene.traverse((object) => {
    const mesh = /** @type {viser.InstancedMesh} */ (object), { instanceIndex } = mesh;
    if (!instanceIndex?.setBuffer || !mesh.patchMaterial) return;
    instanceIndex.setBuffer(gl.createBuffer());
    gl.bindBuffer(gl.ARRAY_BUFFER, instanceIndex.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, instanceIndex.array, gl.DYNAMIC_DRAW);
    const materials = [mesh.material, mesh.customDepthMaterial, mesh.customDistanceMaterial].flat();
    for (const material of materials.filter((one) => !!one)) {
      mesh.patchMaterial(renderer, material);
      const remembered = renderer.properties.get(material);
      for (const name of Object.keys(remembered)) delete remembered[name];
      mesh.unpatchMaterial(renderer, material);
    }
  });
}
