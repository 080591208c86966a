// Meshes drawn for a sea in addition to viser's own.

// A triangle that covers the view.
/** @param {Beside} sea */
export function makeDome(sea) {
  const geometry = new sea.geometry.constructor();
  const Attribute = sea.geometry.attributes.position.constructor;
  geometry.setAttribute("position", new Attribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
  const material = new sea.mesh.material.constructor();
  material.depthWrite = false;
  const dome = new sea.mesh.constructor(geometry, material);
  dome.frustumCulled = false;
  dome.renderOrder = 1e6;
  dome.raycast = () => {};
  sea.mesh.parent?.add(dome);
  return dome;
}

// A mesh for the polar grid, which has its geometry.
/** @param {Sea} sea */
export function makeGrid(sea) {
  const grid = makeDome(sea);
  grid.renderOrder = 0;
  grid.userData.springtideDerived = true;
  Object.assign(grid.material, { depthWrite: true, side: sea.mesh.material.side });
  return grid;
}
