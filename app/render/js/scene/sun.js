// One light with one shadow for each sun. viser makes three of them, with shadows to different distances, and all three light
// every pixel: a frame of the rope takes nearly twice as long. The middle one, which reaches about 15 m around, is enough
// for a rope or a cloth.
//
// Of viser this file uses that the lights of one sun are children of the scene and share one colour object. If a new viser
// differs, its lights stay.

/** @param {three.Scene} scene */
export function drawOneLightOfEachSun(scene) {
  /** @type {Map<three.Color, three.Light[]>} */
  const suns = new Map(); // colour object -> its lights, the one with the nearest shadow first
  for (const light of /** @type {three.Light[]} */ (/** @type {three.Object3D[]} */ (scene.children))) {
    if (!light.isDirectionalLight || !light.castShadow || !light.visible) continue;
    suns.set(light.color, [...(suns.get(light.color) ?? []), light]);
  }
  for (const lights of suns.values()) {
    if (lights.length === 1) continue;
    const middle = lights[lights.length >> 1];
    middle.intensity = lights.reduce((sum, light) => sum + light.intensity, 0);
    for (const light of lights) light.visible = light === middle;
  }
}
