// A walk in a headset, where the browser has WebXR: two eyes from the same pictures.

import type { Walk } from "./core.js";
import type { WalkControls } from "./controls.js";
import type { View } from "./gl/program.js";

export interface HeadsetHost {
  readonly gl: WebGL2RenderingContext;
  readonly controls: WalkControls;
  readonly walk: () => Walk | null;
  readonly sky: boolean;
  /** A session began, or ended. */
  changed(presenting: boolean): void;
  failed(error: unknown): void;
}

/** Adds a button that begins and ends a session. */
export function offerHeadset(parent: HTMLElement, host: HeadsetHost): void {
  const button = document.createElement("button");
  button.style.cssText =
    "position:absolute;right:1em;bottom:1em;padding:.6em 1em;border:0;border-radius:8px;" +
    "background:#20262ef0;color:#e8eaed;font:15px system-ui,sans-serif";
  let session: XRSession | null = null;
  const show = () => {
    button.textContent = session ? "Leave VR" : "Enter VR";
    host.changed(session !== null);
  };
  button.onclick = async () => {
    try {
      if (session) {
        await session.end();
        return;
      }
      button.disabled = true;
      session = await (navigator.xr as XRSystem).requestSession("immersive-vr");
      session.addEventListener("end", () => {
        session = null;
        show();
      });
      await present(session, host);
      show();
    } catch (error) {
      host.failed(error);
    } finally {
      button.disabled = false;
    }
  };
  button.textContent = "Enter VR";
  parent.append(button);
}

async function present(session: XRSession, host: HeadsetHost): Promise<void> {
  const { gl, controls } = host;
  await gl.makeXRCompatible();
  const layer = new XRWebGLLayer(session, gl);
  const start = host.walk()?.manifest?.start;
  await session.updateRenderState({
    baseLayer: layer, depthNear: start?.zNear ?? 0.1, depthFar: start?.zFar ?? 1000,
  });
  const space = await session.requestReferenceSpace("local");
  const standing = new Float64Array(16), worldFromEye = new Float64Array(16);
  const view: { -readonly [K in keyof View]: View[K] } = {
    worldFromEye, clipFromEye: worldFromEye, width: 1, height: 1,
  };
  let before = 0;
  const draw = (now: number, of: XRFrame) => {
    session.requestAnimationFrame(draw);
    const walk = host.walk(), pose = of.getViewerPose(space);
    controls.advance(before ? Math.min(0.1, (now - before) / 1000) : 0, session.inputSources);
    before = now;
    if (!walk || !pose) return;
    controls.standing(standing);
    gl.bindFramebuffer(gl.FRAMEBUFFER, layer.framebuffer);
    gl.clearColor(0.063, 0.078, 0.094, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    for (const eye of pose.views) {
      const viewport = layer.getViewport(eye);
      if (!viewport) continue;
      const m = eye.transform.matrix;
      for (let column = 0; column < 4; ++column)
        for (let row = 0; row < 4; ++row) {
          let sum = 0;
          for (let k = 0; k < 4; ++k) sum += standing[4 * k + row] * m[4 * column + k];
          worldFromEye[4 * column + row] = sum;
        }
      if (eye === pose.views[0]) walk.update(worldFromEye[12], worldFromEye[13], worldFromEye[14]);
      view.clipFromEye = eye.projectionMatrix;
      view.width = viewport.width;
      view.height = viewport.height;
      walk.draw(view, layer.framebuffer, host.sky, viewport.x, viewport.y);
    }
  };
  session.requestAnimationFrame(draw);
}
