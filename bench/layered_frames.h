// Frames of one object, drawn directly and from its layered impostor, and how alike they are.
//
// Eyes stand all around the object, at 3 to 5 radii of the ball around it; the ball fills the
// frame, so that with frames as large as the pictures a pixel is about a texel. Both frames have
// the scene's sky and the same antialiasing. Needs a current OpenGL context.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "rilievo/compare/drawn_frame.h"
#include "rilievo/frame/frame_source.h"
#include "rilievo/frame/gl/opengl_target.h"
#include "rilievo/layered_impostor/gl/layered_drawer.h"
#include "rilievo/measure/stats.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo::bench {

// A camera at `eye` (offset from the box's centre, in radii of its ball) whose square frame the
// ball just fills.
[[nodiscard]] Camera camera_on(const Box& box, const glm::dvec3& eye, int size);

// Evenly over all directions, and over distances from `nearest` to `farthest` radii.
struct EyeOptions {
  int count = 500;
  int size = 256;
  double nearest = 3, farthest = 5;
  std::uint64_t seed = 1;
};
[[nodiscard]] std::vector<Camera> random_eyes(const Box& box, const EyeOptions& options);

// The impostor under the scene's sky. `renderer` and `drawer` must outlive it.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> impostor_source(SceneRenderer& renderer,
                                                                   LayeredDrawer& drawer,
                                                                   LayeredImpostor impostor,
                                                                   const LayeredOptions& options);

struct Quality {
  Summary psnr_db;         // over the frames, each with its sky
  Summary object_psnr_db;  // over the pixels whose centre shows the object in the true frame
  Summary ssim, flip;      // of every slow_every-th frame
  double uncovered = 0;    // of all frames' pixels of the object away from its outline
  double wrong = 0;        // of all frames' pixels away from the outline
  double frame_ms = 0;     // median
};
// `truths` are what `cameras` see.
[[nodiscard]] Result<Quality> measure_quality(OpenGLTarget& target, FrameSource& source,
                                              std::span<const Camera> cameras,
                                              std::span<const DrawnFrame> truths, int slow_every);

}  // namespace rilievo::bench
