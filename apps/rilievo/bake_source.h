// What takes the pictures of a bake? Of a scene OpenGL, or rays where there is none; a capture is
// its own source.
#pragma once

#include <memory>
#include <string>

#include "apps/rilievo/scene_file.h"
#include "rilievo/capture/capture_source.h"
#include "rilievo/core/bounds.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo::app {

// A source, and what it needs to live.
class BakeSource {
 public:
  // `scene` names a file or a built-in scene, or a capture of photographs.
  [[nodiscard]] static Result<BakeSource> open(const std::string& scene, const FileLimits& limits);
  BakeSource(BakeSource&&) noexcept;
  BakeSource& operator=(BakeSource&&) noexcept;
  ~BakeSource();

  [[nodiscard]] CaptureSource& source();
  // Where eyes will be, if a built-in scene is walked through; else empty.
  [[nodiscard]] Box eyes() const;
  // The walk of a built-in scene.
  [[nodiscard]] const CameraPath* walk() const;
  // Null without OpenGL, and for captures.
  [[nodiscard]] SceneRenderer* renderer();

 private:
  struct State;
  explicit BakeSource(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace rilievo::app
