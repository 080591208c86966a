// The instances of a mesh after the graphics context was lost. viser's class for them makes a buffer of indices, and remembers
// programs of materials, by itself, so that three does not know that they are gone. Where a new viser has other names, nothing
// is done.

import { contextNumber } from "../shading/context.js";

let last = { renderer: null, context: 0 };

export function renewInstances(renderer, scene) {
  const now = { renderer, context: contextNumber() }, isRestored = last.renderer === renderer && last.context !== now.context;
  last = now;
  if (!isRestored) return;
  const gl = renderer.getContext();
  scene.traverse((mesh) => {
    const { instanceIndex } = mesh;
    if (!instanceIndex?.setBuffer || !mesh.patchMaterial) return;
    instanceIndex.setBuffer(gl.createBuffer());
    gl.bindBuffer(gl.ARRAY_BUFFER, instanceIndex.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, instanceIndex.array, gl.DYNAMIC_DRAW);
    for (const material of [mesh.material, mesh.customDepthMaterial, mesh.customDistanceMaterial].flat().filter(Boolean)) {
      mesh.patchMaterial(renderer, material);
      const remembered = renderer.properties.get(material);
      for (const name of Object.keys(remembered)) delete remembered[name];
      mesh.unpatchMaterial(renderer, material);
    }
  });
}
