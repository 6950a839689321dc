// A scene, and what its frames are compared by.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "rilievo/frame/frame_source.h"
#include "rilievo/gl/context_test_helpers.h"
#include "rilievo/render/opengl/frame_target.h"
#include "rilievo/render/opengl/scene_renderer.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {

inline constexpr int kWidth = 320, kHeight = 180;

class SceneTest : public gl::ContextTest {
 protected:
  void load(const char* spec) {
    auto scene = make_builtin(spec);
    ASSERT_TRUE(scene.ok()) << scene.error().message();
    load(std::move(*scene));
  }
  void load(BuiltinScene scene) {
    renderer.reset();
    builtin = std::move(scene);
    auto r = SceneRenderer::create(builtin.scene);
    ASSERT_TRUE(r.ok()) << r.error().message();
    renderer = std::make_unique<SceneRenderer>(std::move(*r));
    target = std::make_unique<FrameTarget>(std::move(*FrameTarget::create(kWidth, kHeight, 4)));
    probe = std::make_unique<ProbeTarget>(std::move(*ProbeTarget::create(kWidth, kHeight)));
  }

  Rgba8Image frame_of(FrameSource& source, const Camera& camera, double time = 0) {
    target->begin();
    EXPECT_TRUE(source.draw(camera, time).ok());
    target->resolve();
    return target->read();
  }
  // Along the scene's own path.
  Rgba8Image frame_of(FrameSource& source, int frame) {
    const double time = frame_time(builtin.path, frame);
    return frame_of(source, camera_at(builtin.path, time, kWidth, kHeight), time);
  }
  Image<std::uint32_t> objects_of(FrameSource& source) {
    probe->begin();
    EXPECT_TRUE(source.draw_objects().ok());
    return probe->read_objects();
  }

  BuiltinScene builtin;
  std::unique_ptr<SceneRenderer> renderer;
  std::unique_ptr<FrameTarget> target;
  std::unique_ptr<ProbeTarget> probe;
};

// Pixels whose 3 x 3 neighbourhood in `truth` is one object, and that show another in `seen`.
inline int wrong_inside(const Image<std::uint32_t>& truth, const Image<std::uint32_t>& seen) {
  int wrong = 0;
  for (int y = 1; y + 1 < truth.height(); ++y)
    for (int x = 1; x + 1 < truth.width(); ++x) {
      bool inside = true;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) inside &= truth(x + dx, y + dy) == truth(x, y);
      wrong += inside && seen(x, y) != truth(x, y);
    }
  return wrong;
}

}  // namespace rilievo
