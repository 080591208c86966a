// For the check of types alone: the parts of the page, of viser's client, of three and of uPlot that the scripts use.

interface Window {
  __springtide?: Springtide;
  __viserMutable?: viser.Mutable;
  __viserTestpoints?: { uplots?: Record<string, { chart: uplot.Chart }> };
}
declare var __springtide: Springtide | undefined;

// What core/springtide.js describes.
interface Springtide {
  failure?: string;
  isWhole?: boolean;
  areWhole?: () => boolean;
  page?: string;
  line?: Line;
  isRecording?: boolean;
  quality?: object;
  memory?: () => object;
  skiesDrawn?: number;
  awaitPicture?: () => void;
  showsWhole?: () => boolean;
  contexts?: number;
  beside?: boolean;
  channel?: { topicState: (topic: string) => any; say: (topic: string, value: unknown) => boolean };
}

interface Line {
  heard: number;
  beats: number;
  wait: number;
  isOpen: boolean;
  close: () => void;
  hurry: (time: number) => void;
}

// Selectors in the scripts find elements of HTML.
interface ParentNode {
  querySelector<K extends keyof HTMLElementTagNameMap>(selectors: K): HTMLElementTagNameMap[K] | null;
  querySelector<E extends Element = HTMLElement>(selectors: string): E | null;
  querySelectorAll<K extends keyof HTMLElementTagNameMap>(selectors: K): NodeListOf<HTMLElementTagNameMap[K]>;
  querySelectorAll<E extends Element = HTMLElement>(selectors: string): NodeListOf<E>;
}
interface Element {
  closest<K extends keyof HTMLElementTagNameMap>(selectors: K): HTMLElementTagNameMap[K] | null;
  closest<E extends Element = HTMLElement>(selectors: string): E | null;
}
interface HTMLCanvasElement {
  springtideRenderer?: three.Renderer;
}

interface PageEvents extends WindowEventMap, DocumentEventMap {
  webglcontextlost: Event;
  webglcontextrestored: Event;
}

interface Box {
  x: number;
  y: number;
  width: number;
  height: number;
}
interface Edges {
  left: number;
  right: number;
  top: number;
  bottom: number;
}

// A mesh that asks for a shader (scene/main.js): its name, itself, and the hidden child with the data.
interface ShadedNode {
  base: string;
  mesh: three.Mesh;
  data: three.Mesh;
}
interface ShadedContext extends ShadedNode {
  renderer: three.Renderer;
  scene: three.Scene;
  camera: three.Camera;
}
interface NodeShader {
  suffix: string;
  unpack?(node: ShadedNode): boolean; // brings the vertices up to date before the camera of the frame is placed
  update(context: ShadedContext): three.Material | null; // returns the material that has the shader
  removeUnused?(): void; // disposes of what removed nodes left
}

// Radiances of a sky by formula: at the horizon and overhead.
interface SkyColors {
  low: number[];
  high: number[];
}
// What else is drawn beside a mesh has its classes (sea/dome.js).
interface Beside {
  mesh: three.Mesh;
  geometry: three.Geometry;
}
// What sea/water.js has made for a node.
interface Sea extends Beside {
  uniforms: three.Uniforms;
  filled: string;
  hasOil: boolean;
  hasHulls: boolean;
  polar: three.Mesh | null;
  plain: three.Mesh | null;
  lit: LitSea | null;
  dome: three.Mesh | null;
  triangle: three.Geometry | null;
  isReady: boolean;
  isUnlit: boolean;
  widest: number; // greatest displacement [m] along the level
  highest: number; // and upwards
  cell: number; // of the simulated grid [m]
}
interface GriddedSea extends Sea {
  polar: three.Mesh;
}
// What sea/lit_sea.js has made for a sea.
interface LitSea {
  corners: three.Mesh;
  grid: three.Mesh;
  triangle: three.Mesh;
  light: three.Mesh;
  tiles: three.Geometry | null;
  vertices: three.Target | null;
  places: three.Target | null;
  counts: three.Target | null;
  lights: three.Target | null;
  size: string;
}
// The key of a shader's program, and the lines that make it this one.
interface Variant {
  key: string;
  defines: string;
}
interface Table {
  target: three.Target;
  dome: three.Mesh;
  key: string;
}

declare namespace viser {
  interface Mutable {
    scene: three.Scene | null;
    camera: three.Camera | null;
    cameraControl: CameraControls | null;
    canvas: HTMLCanvasElement | null;
    nodeRefFromName: Record<string, three.Object3D | undefined>;
    requestRender(): void;
    sendMessage: ((message: object) => void) | null;
    sendCamera?: (() => void) | null;
    getRenderRequestState: string;
  }
  // After it has begun to draw.
  interface Started extends Mutable {
    scene: three.Scene;
    camera: three.Camera;
    canvas: HTMLCanvasElement;
  }
  interface InstancedMesh extends three.Mesh {
    instanceIndex?: { array: Uint32Array<ArrayBuffer>; buffer: WebGLBuffer; setBuffer?(buffer: WebGLBuffer): void };
    customDepthMaterial?: three.Material | null;
    customDistanceMaterial?: three.Material | null;
    patchMaterial?(renderer: three.Renderer, material: three.Material): void;
    unpatchMaterial(renderer: three.Renderer, material: three.Material): void;
  }
  interface CameraControls {
    distance: number;
    azimuthAngle: number;
    getTarget(into: three.Vector3): three.Vector3;
    getPosition(into: three.Vector3): three.Vector3;
    setLookAt(x: number, y: number, z: number, toX: number, toY: number, toZ: number, smooth: boolean): void;
    rotatePolarTo(angle: number, smooth: boolean): void;
    moveTo(x: number, y: number, z: number, smooth: boolean): void;
  }
}

declare namespace uplot {
  interface Chart {
    root: HTMLElement;
    over: HTMLElement;
    ctx: CanvasRenderingContext2D;
    bbox: { left: number; top: number; width: number; height: number };
    width: number;
    height: number;
    data: (number | null)[][];
    series: Series[];
    axes: Axis[];
    padding: Padding[];
    scales: { x: { min: number; max: number; auto(chart: Chart, reset: boolean): boolean } };
    redraw(): void;
    setScale(name: string, range: { min: number; max: number }): void;
    setSize(size: { width: number; height: number }): void;
    valToPos(value: number | null, scale: string): number;
  }
  type Size = (...given: unknown[]) => number;
  type Padding = number | Size;
  interface Axis {
    font: [css: string, onCanvas: number, onPage: number];
    size(chart: Chart, words: string[] | null, ...rest: unknown[]): number;
    space: Size;
    scale: string;
    filter(chart: Chart, splits: number[]): number[];
    values(chart: Chart, splits: number[], ...rest: unknown[]): string[];
  }
  interface Series {
    class?: string;
    label: string;
    show: boolean;
    width: number;
    _stroke: unknown;
    paths(chart: Chart, index: number, ...rest: unknown[]): unknown;
  }
}

declare namespace three {
  interface Vector3 {
    x: number;
    y: number;
    z: number;
    clone(): Vector3;
    copy(other: Vector3): this;
    set(x: number, y: number, z: number): this;
    fromArray(numbers: ArrayLike<number>, at?: number): this;
    toArray(): number[];
    toArray<A extends { [index: number]: number }>(into: A, at?: number): A;
    distanceTo(other: Vector3): number;
    project(camera: Camera): this;
    applyMatrix4(matrix: Matrix4): this;
    transformDirection(matrix: Matrix4): this;
    addScaledVector(other: Vector3, factor: number): this;
    setFromMatrixColumn(matrix: Matrix4, column: number): this;
    setFromMatrixPosition(matrix: Matrix4): this;
    min(other: Vector3): this;
    max(other: Vector3): this;
  }
  interface Matrix4 {
    elements: number[];
    clone(): Matrix4;
    copy(other: Matrix4): this;
    multiply(other: Matrix4): this;
    invert(): this;
    toArray(): number[];
  }
  interface Euler {
    copy(other: Euler): this;
    toArray(): unknown[];
  }
  interface Color {
    r: number;
    g: number;
    b: number;
    clone(): Color;
    fromArray(numbers: ArrayLike<number>): this;
    getStyle(): string;
    toArray(): number[];
  }
  interface Uniform<T = any> { // a shader's uniforms have values of many types
    value: T;
  }
  type Uniforms = Record<string, Uniform>;

  interface Attribute {
    array: Float32Array;
    count: number;
    version: number;
    needsUpdate: boolean;
    data?: Attribute;
    springtide?: { packed: Float32Array; version: number; written: number };
    springtideWrites?: number;
    readonly constructor: new (numbers: Float32Array | Uint32Array, size: number) => Attribute;
    clone(): Attribute;
    getX(index: number): number;
    getY(index: number): number;
    getZ(index: number): number;
    getW(index: number): number;
    setX(index: number, x: number): void;
    setXY(index: number, x: number, y: number): void;
    setXYZW(index: number, x: number, y: number, z: number, w: number): void;
  }
  interface Geometry {
    attributes: Record<string, Attribute>;
    index: Attribute;
    boundingSphere: { center: Vector3; radius: number } | null;
    drawRange: { start: number; count: number };
    instanceCount: number;
    readonly constructor: new () => Geometry;
    setAttribute(name: string, attribute: Attribute): void;
    setIndex(index: Attribute): void;
    setDrawRange(start: number, count: number): void;
    computeVertexNormals(): void;
    computeBoundingSphere(): void;
    dispose(): void;
  }
  interface Shader {
    vertexShader: string;
    fragmentShader: string;
    uniforms: Uniforms;
  }
  interface Material extends Shader {
    userData: { springtide?: string };
    version: number;
    side: number;
    transparent: boolean;
    depthTest: boolean;
    depthWrite: boolean;
    toneMapped: boolean;
    fog: boolean;
    forceSinglePass: boolean;
    roughness: number;
    envMapRotation: Euler;
    isMeshStandardMaterial?: boolean;
    isMeshPhysicalMaterial?: boolean;
    needsUpdate: boolean;
    readonly constructor: new (how?: object) => Material;
    onBeforeCompile(shader: Shader): void;
    customProgramCacheKey(): string;
    clone(): Material;
    dispose(): void;
  }
  interface Object3D {
    name: string;
    parent: Object3D | null;
    children: Mesh[];
    visible: boolean;
    renderOrder: number;
    position: Vector3;
    quaternion: object;
    matrixWorld: Matrix4;
    layers: { mask: number };
    userData: {
      springtideDerived?: boolean;
      materials?: Map<string, Material>;
      fineness?: number;
      rain?: Uniforms;
      photograph?: Texture | null;
    };
    add(child: Object3D): void;
    removeFromParent(): void;
    getObjectByName(name: string): Object3D | undefined;
    getWorldPosition(into: Vector3): Vector3;
    worldToLocal(point: Vector3): Vector3;
    localToWorld(point: Vector3): Vector3;
    updateMatrixWorld(): void;
    lookAt(point: Vector3): void;
    traverse(call: (object: Mesh) => void): void;
    traverseVisible(call: (object: Mesh) => void): void;
  }
  interface Mesh extends Object3D {
    isMesh?: boolean;
    geometry: Geometry;
    material: Material;
    castShadow: boolean;
    receiveShadow: boolean;
    frustumCulled: boolean;
    readonly constructor: new (geometry: Geometry, material: Material) => Mesh;
    clone(recursive?: boolean): Mesh;
    raycast(raycaster: object, hits: Hit[]): void;
  }
  interface Hit {
    object: Mesh;
    point: Vector3;
    distance: number;
  }
  interface Light extends Object3D {
    isDirectionalLight?: boolean;
    castShadow: boolean;
    color: Color;
    intensity: number;
  }
  interface Scene extends Object3D {
    background: Texture | null;
    environment: Texture | null;
    environmentIntensity: number;
    environmentRotation: Euler;
    backgroundIntensity: number;
    backgroundBlurriness: number;
    backgroundRotation: Euler;
    overrideMaterial: Material | null;
    fog: { color: Color } | null;
    onBeforeRender(renderer: Renderer, scene: Scene, camera: Camera, target: unknown): void;
  }
  interface Camera extends Object3D {
    aspect: number;
    fov: number; // [degrees]
    updateProjectionMatrix(): void;
    view: View | null;
    projectionMatrix: Matrix4;
    projectionMatrixInverse: Matrix4;
    matrixWorldInverse: Matrix4;
    setViewOffset(fullWidth: number, fullHeight: number, x: number, y: number, width: number, height: number): void;
  }
  interface View {
    enabled: boolean;
    fullWidth: number;
    fullHeight: number;
    offsetX: number;
    offsetY: number;
    width: number;
    height: number;
  }
  interface Texture {
    uuid: string;
    version: number;
    image: { data?: Float32Array; width: number; height: number };
    type: number;
    format: number;
    mapping: number;
    renderTarget?: Target;
    isDataTexture?: boolean;
    source: { readonly constructor: new (image: object) => Texture["source"] };
    needsUpdate: boolean;
    clone(): Texture;
    dispose(): void;
    addEventListener(kind: "dispose", call: () => void): void;
  }
  interface Target {
    width: number;
    height: number;
    texture: Texture;
    textures: Texture[];
    readonly constructor: new (width: number, height: number, how: object) => Target;
    dispose(): void;
  }
  interface Program {
    id: number;
    program?: WebGLProgram;
    isReady?(): boolean;
    __springtide?: boolean;
  }
  interface Renderer {
    domElement: HTMLCanvasElement;
    capabilities: { maxTextureSize: number };
    extensions: { has(name: string): boolean };
    info: { memory: object; programs: Program[] | null };
    properties: { get(of: object): any }; // three keeps what it likes there
    shadowMap: { enabled: boolean };
    state: {
      buffers: { depth: { getReversed(): boolean } };
      activeTexture(unit: number): void;
      bindTexture(kind: number, texture: WebGLTexture): void;
      bindFramebuffer(kind: number, buffer: WebGLFramebuffer | null): void;
    };
    toneMapping: number;
    toneMappingExposure: number;
    outputColorSpace: string;
    readonly constructor: new (how: object) => Renderer;
    clear(): void;
    compile(object: Object3D, camera: Camera, scene: Object3D): void;
    getClearAlpha(): number;
    getContext(): WebGL2RenderingContext;
    getPixelRatio(): number;
    getRenderTarget(): Target | null;
    initRenderTarget(target: Target): void;
    readRenderTargetPixels(...asked: ReadTarget): void;
    readRenderTargetPixelsAsync(...asked: ReadTarget): Promise<unknown>;
    render(object: Object3D, camera: Camera): void;
    setClearAlpha(alpha: number): void;
    setPixelRatio(ratio: number): void;
    setRenderTarget(target: Target | null): void;
    setSize(width: number, height: number): void;
  }
  type ReadTarget = [target: Target, x: number, y: number, width: number, height: number, into: Float32Array];
}

// What the unit tests use of Node.
declare module "node:test" {
  interface Timers { enable(which: { apis: string[] }): void; tick(time: number): void }
  export function test(name: string, body: (context: { mock: { timers: Timers } }) => void): void;
}
declare module "node:assert/strict" {
  const assert: {
    equal(found: unknown, expected: unknown): void;
    deepEqual(found: unknown, expected: unknown): void;
    ok(found: unknown): void;
    rejects(found: Promise<unknown>, expected: RegExp): Promise<void>;
  };
  export default assert;
}
