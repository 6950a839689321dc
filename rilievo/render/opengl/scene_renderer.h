// Draws a Scene directly with OpenGL: as the source of rasterised pictures, and as the baseline
// that pictures are measured against.
//
// Instanced (one draw call for each mesh), with frustum and back-face culling, front to back.
// Metallic-roughness shading with the scene's lights, or the default sun, under the scene's sky.
// Positions reach the GPU relative to the eye, so that large worlds keep their precision. Needs a
// current OpenGL context.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/gl/object.h"
#include "rilievo/render/cross_fade.h"
#include "rilievo/render/placed_scene.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// The encoding of the colours that are written.
enum class OutputEncoding {
  linear,  // for pictures captured in floating point
  srgb,    // for frames: sRGB-encoded values into an ordinary 8-bit framebuffer
};

// A scene on the GPU, ready to be drawn.
class SceneRenderer {
 public:
  // Uploads the scene's meshes and textures and compiles the shaders. `scene` must outlive the
  // renderer.
  [[nodiscard]] static Result<SceneRenderer> create(const Scene& scene);
  SceneRenderer(SceneRenderer&&) noexcept;
  SceneRenderer& operator=(SceneRenderer&&) noexcept;
  ~SceneRenderer();

  // Places each object at `time` (seconds). Does nothing if the time has not changed.
  void set_time(double time);
  // The scene at the current time, and parts of it for short.
  [[nodiscard]] const PlacedScene& placed() const;
  [[nodiscard]] const Scene& scene() const { return placed().scene(); }
  [[nodiscard]] std::span<const glm::mat4> poses() const { return placed().poses(); }
  [[nodiscard]] const Box& object_bounds(std::uint32_t object) const {
    return placed().bounds()[object];
  }
  [[nodiscard]] bool has_blended_parts(std::uint32_t object) const {
    return placed().has_blended_parts(object);
  }
  [[nodiscard]] bool has_opaque_parts(std::uint32_t object) const {
    return placed().has_opaque_parts(object);
  }
  void cull(const Camera& camera, std::vector<std::uint32_t>& visible) const {
    placed().cull(camera, visible);
  }

  // Draws the opaque and alpha-masked parts of `objects` (indices into Scene::objects, any order)
  // with depth into the bound framebuffer. Does not cull: pass the result of cull().
  void draw_opaque(const Camera& camera, std::span<const std::uint32_t> objects,
                   OutputEncoding encoding);
  // Draws the same parts of objects that fade in or out. An object can have several ranges.
  void draw_cross_fades(const Camera& camera, std::span<const CrossFade> fading,
                        OutputEncoding encoding);
  // Draws the blended parts, back to front; call it after the opaque parts and the sky.
  void draw_blended(const Camera& camera, std::span<const std::uint32_t> objects,
                    OutputEncoding encoding);
  // Draws the identifiers (object index + 1) of opaque and masked parts into a ProbeTarget. Blended
  // parts have no single depth and are left out.
  void draw_objects(const Camera& camera, std::span<const std::uint32_t> objects);
  // Draws the identifiers of objects that fade, each within its ranges, as draw_cross_fades() does.
  void draw_fading_objects(const Camera& camera, std::span<const CrossFade> fading);
  // Draws the identifiers of the farthest surfaces along each ray, back faces included, into a
  // ProbeTarget that was cleared for them: the opposite of what the camera keeps.
  void draw_hindmost(const Camera& camera, std::span<const std::uint32_t> objects);
  // Depth peeling, first step: draws the identifiers of surfaces behind the given depths, back
  // faces included. `peeled_depth` is a texture of window_z with the framebuffer's size.
  void draw_objects_behind(const Camera& camera, std::span<const std::uint32_t> objects,
                           unsigned peeled_depth);
  // Second step: draws the linear colours of these surfaces over their own depths. The back of a
  // single-sided surface looks like its front. Smoother surfaces are shaded as if they were as
  // rough as `least_roughness`.
  void draw_at_depth(const Camera& camera, std::span<const std::uint32_t> objects,
                     float least_roughness = 0);
  // Draws a sky where nothing has been drawn yet: the scene's, or another.
  void draw_sky(const Sky& sky, const Camera& camera, OutputEncoding encoding);
  void draw_sky(const Camera& camera, OutputEncoding encoding);

  // The program called `name`, which lives as long as the renderer. The first call for a name makes
  // it. For passes over what is drawn here, so that no frame compiles again.
  [[nodiscard]] Result<GLuint> kept_program(std::string_view name,
                                            Result<gl::Program> (*make)(std::string_view name));

 private:
  struct State;
  explicit SceneRenderer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace rilievo
