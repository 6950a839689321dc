// A walk as an object of a three.js scene.
//
//   const walk = new RilievoWalk("walk/");
//   scene.add(walk);
//   await walk.ready;
//   // every frame:
//   walk.update(camera, renderer);
//   renderer.render(scene, camera);
//
// Nodes are drawn into layers of their own and merged by one triangle that covers the frame and
// writes depth, so that the host's meshes intersect the walk. Stands in the world as it was
// captured: a walk that is moved or turned is not supported.

import * as THREE from "three";
import { Walk, type WalkError, type WalkOptions, type WalkStats } from "./core.js";
import { kMostDrawn } from "./gl/drawer.js";
import { mergeFunction } from "./gl/shaders.js";
import type { Manifest } from "./manifest.js";
import type { PictureSource } from "./source.js";

export { StaticSource, Walk, WalkError, parseManifest } from "./core.js";
export type { FileEntry, Manifest, PictureSource, View, WalkOptions, WalkStats } from "./core.js";

export interface RilievoWalkEvents extends THREE.Object3DEventMap {
  /** The manifest is there, and something to draw. */
  load: { manifest: Manifest };
  /** A node came, in one of its levels. */
  picture: { node: number; level: number };
  /** A frame drawn now would differ from the last one. */
  "needs-update": object;
  /** A file is missing or damaged; the walk goes on without it. */
  error: { error: WalkError };
}

const kVertex = /* glsl */ `
void main() {
  gl_Position = vec4(position.xy, 0.0, 1.0);
}
`;

// Each three.js names its depth modes by defines of its own.
function fragment(layers: number): string {
  return /* glsl */ `
precision highp float;
precision highp int;
${mergeFunction(layers)}
uniform mat4 projectionMatrix;  // three.js' own, turned round where depth is reversed
uniform float log_depth;  // 2 / log2(far + 1); 0: depth is not logarithmic
uniform int reversed_depth;  // 1: clip depth is from 0 to 1; 2: it is reversed, but from -1 to 1
uniform vec2 frame_corner;
void main() {
  vec3 color;
  float eye_z;
  if (!merge_nodes(ivec2(gl_FragCoord.xy - frame_corner), color, eye_z)) discard;
  // Stored colours are sRGB's; the frame's space and tone mapping are the host's.
  gl_FragColor = vec4(mix(pow(color * 0.9478672986 + 0.0521327014, vec3(2.4)),
                          color * 0.0773993808, vec3(lessThanEqual(color, vec3(0.04045)))), 1.0);
  #include <tonemapping_fragment>
  #include <colorspace_fragment>
  // Just before the farthest depth, so that a sky that is drawn later fills only the gaps.
  const float last = 1.0 - exp2(-23.0);
  vec2 clip = (projectionMatrix * vec4(0.0, 0.0, -eye_z, 1.0)).zw;
  if (log_depth > 0.0) gl_FragDepth = min(log2(1.0 + eye_z) * log_depth * 0.5, last);
  else if (reversed_depth == 1) gl_FragDepth = max(clip.x / clip.y, 1e-12);
  else if (reversed_depth == 2) gl_FragDepth = 0.5 * clip.x / clip.y + 0.5;
  else gl_FragDepth = min(0.5 * clip.x / clip.y + 0.5, last);
}
`;
}

function isReversed(renderer: THREE.WebGLRenderer): boolean {
  // Its name has changed.
  const { capabilities } = renderer as unknown as { capabilities: Record<string, unknown> };
  return Boolean(capabilities.reversedDepthBuffer || capabilities.reverseDepthBuffer);
}

// three.js 0.170 reverses depth, and leaves clip space from -1 to 1.
function reversedDepth(renderer: THREE.WebGLRenderer): number {
  const kClipDepthMode = 0x935d, kZeroToOne = 0x935f;
  if (!isReversed(renderer)) return 0;
  return renderer.getContext().getParameter(kClipDepthMode) === kZeroToOne ? 1 : 2;
}

// three.js forgets what it knows of the context, and with it that depth is reversed.
function resetState(renderer: THREE.WebGLRenderer): void {
  renderer.resetState();
  if (!isReversed(renderer)) return;
  const { depth } = renderer.state.buffers as unknown as {
    depth: { setReversed(on: boolean): void; setClear(depth: number): void };
  };
  depth.setReversed(true);
  depth.setClear(1);
}

// A texture that three.js binds and does not own.
class Layers extends THREE.Texture {
  readonly isDataArrayTexture = true;
}

/** What a walk looks like in a scene. Options as for `Walk`. */
export class RilievoWalk extends THREE.Object3D<RilievoWalkEvents> {
  /** Something can be drawn. Rejected if the walk cannot be loaded. */
  readonly ready: Promise<void>;

  private walk: Walk | null = null;
  private renderer: THREE.WebGLRenderer | null = null;
  private readonly screen: THREE.Mesh<THREE.BufferGeometry, THREE.ShaderMaterial>;
  private readonly materials: THREE.ShaderMaterial[] = [];
  private readonly colors = new Layers();
  private readonly depths = new Layers();
  private readonly seen = Array.from({ length: kMostDrawn }, () => new THREE.Texture());
  private readonly viewport = new THREE.Vector4();
  private readonly view = {
    worldFromEye: new Float64Array(16), clipFromEye: new Float64Array(16), width: 0, height: 0,
    near: 0.1,
  };
  private readonly eye = new THREE.Vector3();
  private resolve: () => void = () => {};
  private reject: (error: unknown) => void = () => {};
  private readonly corner = new THREE.Vector2();
  private reversed = 0;

  constructor(
    private readonly source: string | URL | PictureSource,
    private readonly options: Omit<WalkOptions, "onNeedsDraw" | "onPicture" | "onError"> = {},
  ) {
    super();
    this.ready = new Promise<void>((resolve, reject) => {
      this.resolve = resolve;
      this.reject = reject;
    });
    this.ready.catch(() => {});
    const triangle = new THREE.BufferGeometry();
    triangle.setAttribute(
      "position", new THREE.BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
    this.screen = new THREE.Mesh(triangle, this.materialFor(1));
    this.screen.frustumCulled = false;
    this.screen.onBeforeRender = (renderer, _scene, camera) => this.prepare(renderer, camera);
    this.add(this.screen);
  }

  get manifest(): Manifest | null {
    return this.walk?.manifest ?? null;
  }

  get stats(): WalkStats | null {
    return this.walk?.stats ?? null;
  }

  /** Is all there that the camera of the last update() needs? */
  get settled(): boolean {
    return this.walk?.settled ?? false;
  }

  /** Loads what the camera needs next. Call it once a frame, before rendering. */
  update(camera: THREE.Camera, renderer: THREE.WebGLRenderer): void {
    const target = renderer.getRenderTarget();
    const face = renderer.getActiveCubeFace(), mip = renderer.getActiveMipmapLevel();
    this.viewportOf(renderer, camera);
    const fresh = this.renderer !== renderer;
    if (fresh) this.reversed = reversedDepth(renderer);
    renderer.resetState();
    if (fresh) this.start(renderer);
    camera.updateWorldMatrix(true, false);
    this.eye.setFromMatrixPosition(camera.matrixWorld);
    this.walk?.update(this.eye.x, this.eye.y, this.eye.z);
    // In WebXR each eye has a camera of its own, which render() tells of.
    if (!renderer.xr.isPresenting) this.drawLayers(renderer, camera);
    resetState(renderer);
    renderer.setRenderTarget(target, face, mip);
  }

  dispose(): void {
    const canvas = this.renderer?.domElement;
    canvas?.removeEventListener("webglcontextrestored", this.onRestored);
    this.walk?.dispose();
    this.walk = null;
    this.renderer = null;
    for (const material of this.materials) material?.dispose();
    this.screen.geometry.dispose();
    this.removeFromParent();
  }

  private readonly onRestored = () => {
    const gl = this.renderer?.getContext() as WebGL2RenderingContext;
    this.walk?.restore(gl);
  };

  // The context of another renderer has nothing of what is loaded.
  private start(renderer: THREE.WebGLRenderer): void {
    this.walk?.dispose();
    this.renderer = renderer;
    const gl = renderer.getContext() as WebGL2RenderingContext;
    const walk = new Walk(gl, this.source, {
      ...this.options,
      onNeedsDraw: () => this.dispatchEvent({ type: "needs-update" }),
      onPicture: (node, level) => this.dispatchEvent({ type: "picture", node, level }),
      onError: (error) => this.dispatchEvent({ type: "error", error }),
    });
    this.walk = walk;
    renderer.domElement.addEventListener("webglcontextrestored", this.onRestored);
    walk.ready.then(
      () => {
        this.resolve();
        if (walk.manifest) this.dispatchEvent({ type: "load", manifest: walk.manifest });
      },
      (error) => this.reject(error),
    );
  }

  private materialFor(layers: number): THREE.ShaderMaterial {
    return (this.materials[layers] ??= new THREE.ShaderMaterial({
      name: "RilievoWalk",
      vertexShader: kVertex,
      fragmentShader: fragment(layers),
      uniforms: {
        node_colors: { value: this.colors },
        node_depths: { value: this.depths },
        node_merge: { value: new THREE.Vector2() },
        node_nearness: { value: new Array<number>(layers).fill(1) },
        node_steps: { value: new Array<number>(layers).fill(1) },
        node_from_pixel: { value: Array.from({ length: layers }, () => new THREE.Matrix4()) },
        ...Object.fromEntries(
          this.seen.slice(0, layers).map((texture, i) => [`node_seen${i}`, { value: texture }])),
        log_depth: { value: 0 },
        reversed_depth: { value: 0 },
        frame_corner: { value: this.corner },
      },
      depthFunc: THREE.LessEqualDepth,
    }));
  }

  // For each camera that the scene is rendered with: of WebXR one an eye, from the same pictures.
  private prepare(renderer: THREE.WebGLRenderer, camera: THREE.Camera): void {
    if (!this.walk || this.isDrawn(renderer, camera)) return;
    const target = renderer.getRenderTarget();
    const face = renderer.getActiveCubeFace(), mip = renderer.getActiveMipmapLevel();
    renderer.resetState();
    this.drawLayers(renderer, camera);
    resetState(renderer);
    renderer.setRenderTarget(target, face, mip);
    renderer.state.viewport(this.viewport);
  }

  private viewportOf(renderer: THREE.WebGLRenderer, camera: THREE.Camera): void {
    const own = (camera as THREE.Camera & { viewport?: THREE.Vector4 }).viewport;
    const target = renderer.getRenderTarget();
    if (own) this.viewport.copy(own);
    else if (target) this.viewport.copy(target.viewport);
    else renderer.getCurrentViewport(this.viewport);
  }

  private isDrawn(renderer: THREE.WebGLRenderer, camera: THREE.Camera): boolean {
    const { view, viewport, corner } = this;
    this.viewportOf(renderer, camera);
    if (view.width !== viewport.z || view.height !== viewport.w) return false;
    if (corner.x !== viewport.x || corner.y !== viewport.y) return false;
    const world = camera.matrixWorld.elements, clip = camera.projectionMatrix.elements;
    for (let i = 0; i < 16; ++i)
      if (view.worldFromEye[i] !== world[i] || view.clipFromEye[i] !== clip[i]) return false;
    return true;
  }

  // Into layers as large as `viewport`.
  private drawLayers(renderer: THREE.WebGLRenderer, camera: THREE.Camera): void {
    const { walk, view, viewport } = this;
    if (!walk) return;
    view.width = viewport.z;
    view.height = viewport.w;
    view.worldFromEye.set(camera.matrixWorld.elements);
    view.clipFromEye.set(camera.projectionMatrix.elements);
    const { near, far } = camera as THREE.PerspectiveCamera;
    view.near = near;
    this.corner.set(viewport.x, viewport.y);
    const count = walk.drawLayers(view);
    // Nothing is there yet: the merge has no layers to read.
    this.screen.material.visible = count > 0;
    if (count === 0) return;
    const material = this.materialFor(count);
    this.screen.material = material;
    material.visible = true;
    const { drawer } = walk;
    const bind = (texture: THREE.Texture, name: WebGLTexture | null) => {
      (renderer.properties.get(texture) as { __webglTexture?: unknown }).__webglTexture = name;
    };
    bind(this.colors, drawer.colors);
    bind(this.depths, drawer.depths);
    const { uniforms } = material;
    uniforms.node_merge.value.fromArray(drawer.mergeUniform);
    for (let i = 0; i < count; ++i) {
      uniforms.node_nearness.value[i] = drawer.nearness[i];
      uniforms.node_steps.value[i] = drawer.steps[i];
      uniforms.node_from_pixel.value[i].fromArray(drawer.nodeFromPixel, 16 * i);
      bind(this.seen[i], drawer.seen[i]);
    }
    const { capabilities } = renderer as unknown as { capabilities: Record<string, unknown> };
    uniforms.log_depth.value = capabilities.logarithmicDepthBuffer ? 2 / Math.log2(far + 1) : 0;
    uniforms.reversed_depth.value = this.reversed;
  }
}
