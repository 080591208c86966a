import assert from "node:assert/strict";
import { test } from "node:test";
import { Life } from "./js/core/life.js";

/** @type {(changes: object[]) => void} */
let notify = () => {}; // of the page's observer

// A page with a renderer whose frames are drawn when the test says so.
function makePage() {
  /** @type {(() => void)[]} */
  const asked = []; // by requestAnimationFrame
  const nothing = { observe() {}, disconnect() {}, querySelectorAll: () => [], querySelector: () => null };
  const scene = { environment: {}, background: {}, environmentIntensity: 1, traverse() {} };
  const camera = { position: 0, quaternion: 0, projectionMatrix: 0 };
  Object.assign(globalThis, { Node: { ELEMENT_NODE: 1 } });
  const element = Object.assign(new EventTarget(), { style: {}, width: 4, height: 3, clientWidth: 4, clientHeight: 3 });
  const documentElement = { classList: { contains: () => false } };
  let looked = 0; // how often the page looked for a node
  const nodeRefFromName = new Proxy(/** @type {Record<string, object>} */ ({}), {
    get: (nodes, name) => ((looked += 1), Reflect.get(nodes, name)),
  });
  const SIGNALED = 1, picture = { scene: 1, sky: "park", nodes: /** @type {string[]} */ ([]) }; // topic of the lab
  const querySelectorAll = (/** @type {string} */ selector) =>
    selector === "[data-springtide-topic]" ? [{ dataset: { springtideTopic: "picture", value: JSON.stringify(picture) } }] : [];
  let drawn = 0; // fences up to this number are signalled
  let fences = 0;
  const gl = {
    SIGNALED,
    getContextAttributes: () => ({ preserveDrawingBuffer: true }),
    getSyncParameter: (/** @type {number} */ fence) => (fence <= drawn ? SIGNALED : 0),
    fenceSync: () => (fences += 1),
    isContextLost: () => false,
    deleteSync() {},
    flush() {},
  };
  const renderer = {
    domElement: element, shadowMap: {}, info: {}, getContext: () => gl, getRenderTarget: () => null, setSize() {},
    render: /** @type {(...all: object[]) => void} */ (() => {}),
  };
  Object.assign(globalThis, {
    MutationObserver: class {
      /** @param {(changes: object[]) => void} call */
      constructor(call) {
        notify = call;
      }
      observe() {}
      disconnect() {}
    },
    requestAnimationFrame: (/** @type {() => void} */ call) => void asked.push(call),
    setInterval: () => 0,
    location: new URL("http://127.0.0.1/"),
    document: Object.assign(new EventTarget(), { ...nothing, documentElement, visibilityState: "visible", querySelectorAll }),
    window: globalThis,
    addEventListener() {},
    devicePixelRatio: 1,
    __viserMutable: { scene, camera, nodeRefFromName, requestRender() {}, getRenderRequestState: "ready" },
  });
  return {
    renderer,
    // Ask for a frame of the scene: another one than the last, or the same.
    render(isOther = true) {
      if (isOther) camera.position += 1;
      renderer.render(scene, camera);
    },
    looks: () => looked,
    nodeRefFromName,
    // All frames that were begun are drawn; whether the page looks before it begins the next one.
    draw(looks = false) {
      drawn = fences;
      if (looks) for (const call of asked.splice(0)) call();
    },
    isDrawing: () => drawn < fences,
    scene,
    // The lab has another picture.
    tell(/** @type {Partial<typeof picture>} */ other) {
      Object.assign(picture, other);
      notify([{ type: "childList", target: { nodeType: 0 }, addedNodes: [], removedNodes: [] }]);
    },
  };
}

// The page with frames that name their sky first, and what shows the whole picture.
async function pacedPage() {
  const page = makePage(), life = new Life();
  const { paceFrames } = await import("./js/scene/frames.js");
  const { nameSky } = await import("./js/scene/photograph.js");
  const { springtide } = await import("./js/core/springtide.js");
  page.tell({});
  paceFrames(/** @type {any} */ (page.renderer), life);
  page.renderer.render = ((earlier) => (/** @type {any} */ scene, /** @type {any} */ camera) => {
    nameSky(scene); // as the first part of each frame does
    earlier(scene, camera);
  })(page.renderer.render);
  return { page, life, showsWhole: () => springtide.showsWhole?.(), awaitPicture: () => springtide.awaitPicture?.() };
}

test("the whole picture is shown from the end of its first frame on, also where the next one begins at once", async () => {
  const { page, life, showsWhole, awaitPicture } = await pacedPage();
  assert.equal(showsWhole(), false);
  Object.assign(page.scene, { environment: null }); // the sky is not there
  page.render();
  page.draw();
  assert.equal(showsWhole(), false);
  Object.assign(page.scene, { environment: {}, background: null }); // viser's own sky, which no lab has sent
  page.render();
  page.draw(true);
  assert.equal(showsWhole(), false);
  page.scene.background = page.scene.environment; // the settings of the lab's sky come before its photograph
  page.render();
  page.draw(true);
  assert.equal(showsWhole(), false);
  page.scene.environment = {};
  page.render();
  assert.equal(showsWhole(), false); // the first whole frame is being drawn
  for (let k = 0; k < 3; k++) {
    page.draw();
    page.render(); // before anything looks for the end of the last one
    assert.equal(page.isDrawing(), true);
    assert.equal(showsWhole(), true);
  }
  page.draw(true);
  assert.equal(showsWhole(), true);
  page.tell({ sky: "sunset" }); // another scene, whose photograph is not there
  awaitPicture();
  page.render();
  assert.equal(showsWhole(), false);
  page.draw(true);
  assert.equal(showsWhole(), false);
  page.scene.environment = {};
  page.render();
  page.draw(true);
  assert.equal(showsWhole(), true);
  page.tell({ nodes: ["/sea"] }); // which has no node here
  awaitPicture();
  page.render();
  page.draw(true);
  assert.equal(showsWhole(), false);
  life.end();
});

test("another scene awaits a frame that began after it and has its nodes, which are not looked for afterwards", async () => {
  const { page, life, showsWhole, awaitPicture } = await pacedPage();
  page.tell({ nodes: ["/sea"] });
  page.render(); // a frame of the scene before
  awaitPicture();
  page.draw(true);
  assert.equal(showsWhole(), false);
  page.render(false);
  page.draw(true);
  assert.equal(showsWhole(), false); // without its nodes
  page.nodeRefFromName["/sea"] = {};
  page.render();
  page.draw(true);
  assert.equal(showsWhole(), true);
  const looks = page.looks();
  page.render();
  page.draw(true);
  assert.equal(showsWhole(), true);
  assert.equal(page.looks(), looks);
  awaitPicture(); // the same scene again: the same frame is drawn once more
  assert.equal(showsWhole(), false);
  page.render(false);
  page.draw(true);
  assert.equal(showsWhole(), true);
  life.end();
});
