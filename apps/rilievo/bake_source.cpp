#include "apps/rilievo/bake_source.h"

#include <optional>
#include <utility>

#include "apps/rilievo/capture.h"
#include "apps/rilievo/frame_options.h"
#include "rilievo/capture/gl/opengl_source.h"
#include "rilievo/capture/ray_source.h"
#include "rilievo/gl/context.h"
#include "rilievo/render/rays/ray_scene.h"

namespace rilievo::app {

struct BakeSource::State {
  OpenedScene opened;
  std::unique_ptr<gl::Context> context;
  std::optional<SceneRenderer> renderer;
  std::optional<RayScene> rays;
  std::unique_ptr<CaptureSource> source;
};

BakeSource::BakeSource(std::unique_ptr<State> state) : state_(std::move(state)) {}
BakeSource::BakeSource(BakeSource&&) noexcept = default;
BakeSource& BakeSource::operator=(BakeSource&&) noexcept = default;
BakeSource::~BakeSource() = default;

Result<BakeSource> BakeSource::open(const std::string& scene, const FileLimits& limits) {
  auto state = std::make_unique<State>();
  if (is_capture(scene)) {
    Result<PhotographSource> source = open_photographs(scene, limits);
    if (!source) return source.error();
    state->source = std::make_unique<PhotographSource>(std::move(*source));
    return BakeSource(std::move(state));
  }
  Result<OpenedScene> opened = open_scene(scene, limits);
  if (!opened) return opened.error();
  state->opened = std::move(*opened);
  // Without OpenGL rays take the pictures.
  auto context = gl::Context::create();
  if (context) {
    state->context = std::move(*context);
    Result<SceneRenderer> made = SceneRenderer::create(state->opened.scene);
    if (!made) return made.error();
    state->source = std::make_unique<OpenGLSource>(state->renderer.emplace(std::move(*made)));
  } else {
    Result<RayScene> made = RayScene::create(state->opened.scene);
    if (!made) return made.error();
    state->source = std::make_unique<RaySource>(state->rays.emplace(std::move(*made)));
  }
  return BakeSource(std::move(state));
}

CaptureSource& BakeSource::source() { return *state_->source; }

Box BakeSource::eyes() const {
  const CameraPath* path = walk();
  return path ? eyes_of(*path, frame_count(*path)) : Box{};
}

const CameraPath* BakeSource::walk() const {
  return state_->opened.walk ? &*state_->opened.walk : nullptr;
}

SceneRenderer* BakeSource::renderer() { return state_->renderer ? &*state_->renderer : nullptr; }

}  // namespace rilievo::app
