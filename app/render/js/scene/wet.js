// A wet surface, for "<name>" where there is a "<name>/wet": it mirrors the sky, where viser's materials are matt.

const WET_ROUGHNESS = 0.25;

/** @type {NodeShader} */
export const wet = {
  suffix: "/wet",
  update({ mesh }) {
    mesh.material.roughness = WET_ROUGHNESS;
    return null; // it keeps viser's shader
  },
};
