// Draws a Scene with OpenGL, directly: the source of every rasterised picture, and the honest
// baseline that pictures are measured against.
//
// Instanced (one draw call a mesh), culled by frustum and by face, front to back.
// Metallic-roughness shading with the scene's lights, or the default sun, under the scene's sky.
// Positions reach the GPU relative to the eye, so that large worlds keep their precision. Needs a
// current OpenGL context.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/render/cross_fade.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

enum class OutputEncoding {
  linear,  // for captured pictures in float
  srgb,    // for frames: sRGB-encoded values into an ordinary 8-bit framebuffer
};

class SceneRenderer {
 public:
  // Uploads the scene's meshes and textures and compiles the shaders. `scene` must outlive it.
  [[nodiscard]] static Result<SceneRenderer> create(const Scene& scene);
  SceneRenderer(SceneRenderer&&) noexcept;
  SceneRenderer& operator=(SceneRenderer&&) noexcept;
  ~SceneRenderer();

  // Places every object at `time`; returns at once if the time has not changed.
  void set_time(double time);
  [[nodiscard]] std::span<const glm::mat4> poses() const;
  // World bounds of an object at the time set.
  [[nodiscard]] const Box& object_bounds(std::uint32_t object) const;
  // Does any material of the object blend? Such parts cannot be in a picture; see draw_blended.
  [[nodiscard]] bool has_blended_parts(std::uint32_t object) const;
  [[nodiscard]] bool has_opaque_parts(std::uint32_t object) const;

  // Appends the objects whose bounds touch the camera's frustum.
  void cull(const Camera& camera, std::vector<std::uint32_t>& visible) const;

  // Draws the opaque and alpha-masked parts of `objects` (indices into Scene::objects, any order)
  // into the bound framebuffer with depth. Culls nothing by frustum: pass what cull() gave.
  void draw_opaque(const Camera& camera, std::span<const std::uint32_t> objects,
                   OutputEncoding encoding);
  // The same of a part of the pixels of each object: what fades in or out. An object may have
  // several ranges.
  void draw_cross_fades(const Camera& camera, std::span<const CrossFade> fading,
                        OutputEncoding encoding);
  // Then the blended parts over it, back to front.
  void draw_blended(const Camera& camera, std::span<const std::uint32_t> objects,
                    OutputEncoding encoding);
  // Identifiers (object index + 1) of the opaque parts into a ProbeTarget; masked texels respected.
  // Blended parts have no single depth and are left out.
  void draw_objects(const Camera& camera, std::span<const std::uint32_t> objects);
  // The same of the surface at the other end of each line of sight, behind all others, back faces
  // included: into a ProbeTarget that begins the other way round.
  void draw_hindmost(const Camera& camera, std::span<const std::uint32_t> objects);
  // Depth peeling: identifiers of what lies behind these depths (a texture of window_z, as large as
  // the framebuffer), back faces included ...
  void draw_objects_behind(const Camera& camera, std::span<const std::uint32_t> objects,
                           unsigned peeled_depth);
  // ... and the colours, linear, of what was drawn there: over its own depths. The back of what is
  // single-sided looks as its front does.
  void draw_at_depth(const Camera& camera, std::span<const std::uint32_t> objects);
  // The sky where nothing has been drawn yet.
  void draw_sky(const Camera& camera, OutputEncoding encoding);

  [[nodiscard]] const Scene& scene() const;

 private:
  struct State;
  explicit SceneRenderer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace rilievo
