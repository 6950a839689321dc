// A layered impostor in a frame, and what is seen of it. Internal to `layered_impostor/software`.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>

#include "rilievo/core/camera.h"
#include "rilievo/core/depth_image.h"
#include "rilievo/layered_impostor/slice_quads.h"

namespace rilievo {

inline constexpr float kSeesNothing = 0;  // 1 / eye_z where there is none

// A picture that is marched through. With t the frame's eye_z, the point of a pixel's ray is, as
// the picture's (u w, v w, w),
//
//   eye + t per_raster (x, y, 1)
struct MarchedView {
  std::size_t view = 0;
  float weight = 0, rest = 0;  // rest: of the views after it
  glm::dvec3 eye{0.0};
  glm::dmat3 per_raster{0.0};
};

// An impostor in a frame. Its rays are those of `camera`, in the world of the capture.
struct PlacedLayered {
  Camera camera;
  glm::dmat3 ray_from_raster{0.0};
  double scale = 1;
  std::uint32_t object = kNoObject;
  std::array<MarchedView, ServingViews::kMaxCount> views;
  int count = 0, weighted = 0, asked = 0;  // as ServingViews'
  double distance = 0;
  float nearest = 0;  // 1 / eye_z, which nothing exceeds
  double margin = 0;  // of distances beside those that neighbouring pixels show
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

struct SeenLayered {
  float inverse_z = kSeesNothing;
  glm::vec4 color{0.0f};  // premultiplied; alpha is coverage
  std::uint32_t object = kNoObject;
};

}  // namespace rilievo
