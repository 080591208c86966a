// The cameras of the panes: all have the pose of the leading pane, seen from the middle of their scenes.

const SAME = 1e-4; // share of the distance within which two cameras are where they should be
const LIFTED = 0.5; // [m] by which a camera may be lifted over floor or waves

/** @typedef {import("./panes.js").Pane} Pane */

// Where the middle of a pane's scene is in three's world: [x, y, z], or null while nothing is drawn.
/** @param {Pane} pane */
function middleOf({ viewer, middle }) {
  const nodes = Object.entries(viewer?.nodeRefFromName ?? {});
  const root = nodes.find(([name, node]) => node && name.split("/").length === 2)?.[1]?.parent;
  if (!root || !viewer?.camera) return null;
  return root.localToWorld(viewer.camera.position.clone().set(middle[0], middle[1], 0)).toArray();
}

// Where a camera is from the middle of its scene: [x, y, z of position, x, y, z of target], in three's axes.
/** @param {Pane} pane */
function poseOf(pane) {
  const controls = pane.viewer?.cameraControl, middle = middleOf(pane);
  if (!controls || !middle || !pane.viewer?.camera) return null;
  const place = pane.viewer.camera.position.clone();
  const position = controls.getPosition(place).toArray(), target = controls.getTarget(place).toArray();
  return [...position, ...target].map((c, k) => c - middle[k % 3]);
}

// Give all cameras the pose of the leading one. Returns its camera, canvas and distance from the target [m]; null without one.
/** @param {Pane[]} panes @param {Pane} lead */
export function linkCameras(panes, lead) {
  const pose = poseOf(lead), from = lead.viewer?.camera, canvas = lead.viewer?.canvas;
  if (!pose || !from || !canvas) return null;
  const distance = Math.hypot(...[0, 1, 2].map((k) => pose[k] - pose[k + 3]));
  for (const pane of panes) {
    const own = pane === lead ? null : poseOf(pane), { viewer } = pane, middle = own && middleOf(pane);
    if (!own || !middle || !viewer?.camera || !viewer.cameraControl) continue;
    const before = pane.pose, isMoved = before !== null && pose.some((c, k) => Math.abs(c - before[k]) > SAME * distance);
    // A lab lifts its own camera, and may place it for the first time after this page has.
    const off = Math.max(...pose.map((c, k) => Math.abs(c - own[k]) / (k % 3 === 1 ? LIFTED : SAME * distance)));
    if (before === null || isMoved || off > 1) {
      const [x, y, z, toX, toY, toZ] = pose.map((c, k) => c + middle[k % 3]);
      viewer.cameraControl.setLookAt(x, y, z, toX, toY, toZ, false);
      pane.pose = pose;
      viewer.requestRender();
    }
    if (Math.abs(viewer.camera.fov - from.fov) > 1e-6) {
      viewer.camera.fov = from.fov;
      viewer.camera.updateProjectionMatrix();
      viewer.requestRender();
    }
  }
  return { camera: from, canvas, distance };
}
