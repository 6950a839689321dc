// A host's own cube, half inside the wall at z = -3 of the tests' room.
import * as THREE from "three";
import { RilievoWalk } from "rilievo";

const kWidth = 320, kHeight = 180, kWall = -3, kSide = 0.9;

window.cubeInWall = async (mode) => {
  const renderer = new THREE.WebGLRenderer({
    antialias: false, preserveDrawingBuffer: true, logarithmicDepthBuffer: mode === "logarithmic",
    reverseDepthBuffer: mode === "reversed", reversedDepthBuffer: mode === "reversed",
  });
  renderer.setPixelRatio(1);
  renderer.setSize(kWidth, kHeight, false);
  if (mode === "tone mapped") renderer.toneMapping = THREE.ACESFilmicToneMapping;
  document.body.replaceChildren(renderer.domElement);
  const scene = new THREE.Scene();
  const camera = new THREE.PerspectiveCamera(40, kWidth / kHeight, 0.05, 50);
  camera.position.set(0.35, 1.55, 0.4);
  camera.lookAt(0.1, 1.6, kWall);
  const cube = new THREE.Mesh(new THREE.BoxGeometry(kSide, kSide, kSide),
                              new THREE.MeshBasicMaterial({ color: 0xff00ff, toneMapped: false }));
  cube.position.set(0.1, 1.6, kWall);
  cube.rotation.set(0.5, 0.8, 0.2);
  scene.add(cube);
  const walk = new RilievoWalk("/walk/walk.json");
  scene.add(walk);
  const target = mode === "in a target" ? new THREE.WebGLRenderTarget(kWidth, kHeight) : null;
  renderer.setRenderTarget(target);
  const frame = () => {
    walk.update(camera, renderer);
    renderer.render(scene, camera);
  };
  const end = performance.now() + 30000;
  do {
    frame();
    await new Promise((resolve) => setTimeout(resolve, 1));
  } while (!walk.settled && performance.now() < end);
  await walk.ready;
  frame();
  const pixels = new Uint8Array(4 * kWidth * kHeight);
  const gl = renderer.getContext();
  if (target) renderer.readRenderTargetPixels(target, 0, 0, kWidth, kHeight, pixels);
  else gl.readPixels(0, 0, kWidth, kHeight, gl.RGBA, gl.UNSIGNED_BYTE, pixels);

  // By rays: is the cube nearer than the wall?
  const toCube = cube.matrixWorld.clone().invert();
  const box = new THREE.Box3().setFromCenterAndSize(new THREE.Vector3(), new THREE.Vector3(kSide, kSide, kSide));
  const shows = (x, y) => {
    const to = new THREE.Vector3((2 * x) / kWidth - 1, (2 * y) / kHeight - 1, 0.5).unproject(camera);
    const ray = new THREE.Ray(camera.position.clone(), to.sub(camera.position).normalize());
    const wall = (kWall - ray.origin.z) / ray.direction.z;
    const hit = ray.clone().applyMatrix4(toCube).intersectBox(box, new THREE.Vector3());
    return hit !== null && hit.applyMatrix4(cube.matrixWorld).distanceTo(ray.origin) < wall;
  };
  // A reversed projection is turned round by the renderer; rays want it as it was.
  camera.updateProjectionMatrix();
  if (camera.reversedDepth) {
    const plain = new THREE.PerspectiveCamera(40, kWidth / kHeight, 0.05, 50);
    camera.projectionMatrix.copy(plain.projectionMatrix);
    camera.projectionMatrixInverse.copy(plain.projectionMatrixInverse);
  }
  let wrong = 0, ofCube = 0, ofWall = 0, skipped = 0;
  for (let y = 0; y < kHeight; ++y)
    for (let x = 0; x < kWidth; ++x) {
      const expected = shows(x + 0.5, y + 0.5);
      const near = [[0, 0], [1, 0], [0, 1], [1, 1]].every(([u, v]) => shows(x + u, y + v) === expected);
      if (!near) {
        ++skipped;
        continue;
      }
      const at = 4 * (y * kWidth + x);
      const drawn = pixels[at] > 250 && pixels[at + 1] < 5 && pixels[at + 2] > 250;
      if (drawn !== expected) ++wrong;
      if (drawn) ++ofCube;
      else if (pixels[at] + pixels[at + 1] + pixels[at + 2] > 60) ++ofWall;
    }
  const error = gl.getError();
  walk.dispose();
  renderer.dispose();
  if (error) throw new Error(`WebGL error ${error}`);
  return { wrong, cube: ofCube, wall: ofWall, skipped };
};

/** Pixels of which two eyes in one frame, as WebXR's, differ from the same eyes one by one. */
window.twoEyes = async () => {
  const renderer = new THREE.WebGLRenderer({ antialias: false, preserveDrawingBuffer: true });
  renderer.setPixelRatio(1);
  renderer.setSize(kWidth, kHeight, false);
  document.body.replaceChildren(renderer.domElement);
  const scene = new THREE.Scene();
  const walk = new RilievoWalk("/walk/walk.json");
  scene.add(walk);
  const half = kWidth / 2;
  const eyes = [-0.032, 0.032].map((aside, k) => {
    const eye = new THREE.PerspectiveCamera(50, half / kHeight, 0.05, 50);
    eye.position.set(0.35 + aside, 1.55, 0.4);
    eye.lookAt(0.1 + aside, 1.6, kWall);
    eye.updateMatrixWorld();
    eye.viewport = new THREE.Vector4(k * half, 0, half, kHeight);
    return eye;
  });
  const both = new THREE.ArrayCamera(eyes);
  both.position.set(0.35, 1.55, 0.4);
  both.updateMatrixWorld();
  const end = performance.now() + 30000;
  do {
    walk.update(eyes[0], renderer);
    renderer.render(scene, eyes[0]);
    await new Promise((resolve) => setTimeout(resolve, 1));
  } while (!walk.settled && performance.now() < end);
  const gl = renderer.getContext();
  const read = () => {
    const pixels = new Uint8Array(4 * kWidth * kHeight);
    gl.readPixels(0, 0, kWidth, kHeight, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    return pixels;
  };
  // As in a session: each eye has a camera of its own, which render() tells of.
  renderer.xr.isPresenting = true;
  walk.update(both, renderer);
  renderer.render(scene, both);
  renderer.xr.isPresenting = false;
  const together = read();
  renderer.autoClear = false;
  renderer.clear();
  for (const eye of eyes) {
    const { viewport } = eye;
    delete eye.viewport;
    renderer.setViewport(viewport);
    walk.update(eye, renderer);
    renderer.render(scene, eye);
  }
  const apart = read();
  let different = 0, eyesDiffer = 0, dark = 0;
  for (let y = 0; y < kHeight; ++y)
    for (let x = 0; x < kWidth; ++x) {
      const at = 4 * (y * kWidth + x), other = 4 * (y * kWidth + ((x + half) % kWidth));
      const same = (a, b, i, j) => [0, 1, 2].every((c) => a[i + c] === b[j + c]);
      if (!same(together, apart, at, at)) ++different;
      if (!same(together, together, at, other)) ++eyesDiffer;
      if (together[at] + together[at + 1] + together[at + 2] < 30) ++dark;
    }
  const error = gl.getError();
  walk.dispose();
  renderer.dispose();
  if (error) throw new Error(`WebGL error ${error}`);
  return { different, eyesDiffer, dark };
};
