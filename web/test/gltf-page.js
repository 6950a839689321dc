// A scene as plain glTF by three.js, for measures beside a walk of it.
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

/** Loads a scene and draws it from a key: milliseconds until that. */
window.openScene = async (url, key, width, height) => {
  const begin = performance.now();
  const renderer = new THREE.WebGLRenderer({ antialias: false, preserveDrawingBuffer: true });
  renderer.setPixelRatio(1);
  renderer.setSize(width, height, false);
  document.body.replaceChildren(renderer.domElement);
  const scene = new THREE.Scene();
  scene.background = new THREE.Color(0x87a5c8);
  const sun = new THREE.DirectionalLight(0xffffff, 2.5);
  sun.position.set(1, 2, 1.5);
  scene.add(sun, new THREE.HemisphereLight(0xcfe0ff, 0x4a453c, 1.2));
  const { scene: loaded } = await new GLTFLoader().loadAsync(url);
  scene.add(loaded);
  const camera = new THREE.PerspectiveCamera();
  const pixel = new Uint8Array(4);
  window.drawKey = ({ eye, target, up, vertical_fov, z_near, z_far }) => {
    camera.fov = THREE.MathUtils.radToDeg(vertical_fov);
    camera.aspect = width / height;
    camera.near = z_near;
    camera.far = z_far;
    camera.up.set(...up);
    camera.position.set(...eye);
    camera.lookAt(...target);
    camera.updateProjectionMatrix();
    renderer.render(scene, camera);
    // Wait for what was asked of the rasteriser, as a screen would.
    const gl = renderer.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
  };
  window.drawKey(key);
  window.sceneInfo = () => ({ ...renderer.info.render, ...renderer.info.memory });
  return performance.now() - begin;
};
